// SPDX-License-Identifier: Apache-2.0
// What a person can do to tasks: one row an act, for buttons, keys and questions alike.
import type { Machine } from "./machine";
import type { Role, TaskStatus } from "./protocol";

export interface Act {
  name: string;
  key: string;
  role: Role;
  help: string;
  /** Whether the act is of use for a task in its state. */
  fits: (task: TaskStatus) => boolean;
}

export const ACTS: Act[] = [
  { name: "on", key: "o", role: "operate", help: "begin to cycle", fits: (t) => t.state === "OFF" },
  { name: "off", key: "f", role: "operate", help: "stop cycling in its safe way", fits: (t) => t.state === "ON" },
  { name: "kill", key: "k", role: "operate", help: "remove the task; spawn creates it again",
    fits: (t) => t.state !== "NOT-CREATED" },
  { name: "clear", key: "c", role: "operate", help: "leave ERROR", fits: (t) => t.state === "ERROR" },
  { name: "reinit", key: "r", role: "operate", help: "read its constants again", fits: (t) => t.state === "ON" },
  { name: "spawn", key: "p", role: "operate", help: "create the task", fits: (t) => t.state === "NOT-CREATED" },
  { name: "ring", key: "b", role: "operate", help: "one event for a task that events release",
    fits: (t) => t.has_doorbell && t.state === "ON" },
];

/** A question in place of an act: what will happen, and the act itself. */
export interface Question {
  title: string;
  text: string;
  button: string;
  carryOut: () => void;
}

/** What is to be asked before the act; null: nothing. */
export function questionBefore(act: Act, tasks: TaskStatus[], carryOut: () => void): Question | null {
  const running = act.name === "kill" ? tasks.filter((task) => task.state === "ON").map((task) => task.task) : [];
  if (running.length === 0) return null;
  const them = running.join(", ");
  return {
    title: `Kill ${them}?`, button: `Kill ${tasks.map((task) => task.task).join(", ")}`, carryOut,
    text: `${them} ${running.length > 1 ? "are" : "is"} ON: ${running.length > 1 ? "they go" : "it goes"} OFF first; ` +
      "tasks that read the outputs then have no producer.",
  };
}

/** Carries the act out and says what it did; a refusal is said by the machine. */
export async function carryOut(machine: Machine, act: Act, tasks: string[]): Promise<void> {
  if (tasks.length === 0) return;
  if (act.name === "ring") {
    if (await machine.act("ring", { tasks })) machine.say(`Rang ${tasks.join(", ")}.`);
    return;
  }
  const answer = await machine.act("signal", { signal: act.name, tasks });
  if (!answer) return;
  const outcomes = answer.tasks as { task: string; before: string; after: string; already?: boolean }[];
  machine.say(outcomes.map((one) => one.already ? `${one.task} is ${one.after} already`
    : `${one.task}: ${one.before} → ${one.after}`).join(", ") + ".");
}
