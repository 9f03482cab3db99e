// SPDX-License-Identifier: Apache-2.0
// What a person types or pulls, as acts of docs/formats/edit.md. No function here knows the browser.
import type { EditAct, Outline, OutlinePort, OutlineTask, OutlineVariable, Port, TaskPort } from "./protocol";
import { membersAt, wordsAt } from "./text_places";

/** Gives the place a value; no words: takes the value out. */
export function valueActs(path: string, words: string, isWritten: boolean): EditAct[] {
  if (words !== "") return [{ act: "set", path, value: words }];
  return isWritten ? [{ act: "remove", path }] : [];
}

/** Number of an instance of a repeated port, `in[2]`; null: the port is not repeated. */
export const instanceOf = (port: string): number | null => {
  const number = /\[(\d+)\]$/.exec(port)?.[1];
  return number === undefined ? null : Number(number);
};

const SECTION: Partial<Record<Port["kind"], string>> = {
  "in-const": "constants", "out-var": "initial", resource: "resources" };

/** The place of the value of a port: of a constant, an initial value, a resource; "": it has none. */
export function valuePath(task: string, port: OutlinePort): string {
  const section = SECTION[port.kind];
  const instance = instanceOf(port.port);
  if (section === undefined || (section === "initial" && instance !== null)) return "";
  return `tasks/${task}/${section}/${port.declared}${instance === null ? "" : `/${instance}`}`;
}

/** A text as a description writes it: in quotes where it would be read as something else. */
export const quoted = (words: string): string =>
  words === "" || /^["']/.test(words) || (/^[A-Za-z0-9_./]/.test(words) && !/: |:$| #|[,[\]{}]/.test(words)) ? words
    : JSON.stringify(words);

/** Links a port to a variable; no name: to the variable of its own name. */
export const linkActs = (task: string, port: { port: string; declared: string }, variable: string): EditAct[] => [{
  act: "link", task, port: port.declared, variable: variable === "" ? port.declared : variable,
  instance: instanceOf(port.port) }];

const portOf = (outline: Outline, at: TaskPort): OutlinePort | undefined =>
  outline.tasks.find((task) => task.task === at.task)?.ports.find((port) => port.port === at.port);

/** The line that a person pulled from one port to another, or why it cannot be. */
export function pulledActs(outline: Outline, from: TaskPort, to: TaskPort): EditAct[] | string {
  const [first, second] = [portOf(outline, from), portOf(outline, to)];
  if (!first || !second || (from.task === to.task && from.port === to.port)) return [];
  const isConstant = (port: OutlinePort) => port.kind.endsWith("-const");
  const isOut = (port: OutlinePort) => port.kind.startsWith("out-");
  if (first.kind === "resource" || second.kind === "resource")
    return "a resource port names a file or device: type it at the task";
  if (isConstant(first) !== isConstant(second))
    return `${from.task}.${from.port} is of kind ${first.kind}, ${to.task}.${to.port} of kind ${second.kind}: ` +
      "only variables link to variables, and constants to constants";
  if (isOut(first) && isOut(second)) return "both ports are outputs: a variable has one producer";
  const isBackwards = isOut(second);
  const [given, taker, at] = isBackwards ? [second, first, from] : [first, second, to];
  return linkActs(at.task, taker, given.variable ?? given.declared);
}

const LIST: Record<Port["kind"], string> = { "in-var": "alias", "out-var": "alias", "out-const": "alias",
  "in-const": "constants", resource: "resources" };

/** One more instance of a repeated port, with its variable or value. */
export const instanceActs = (task: string, port: OutlineTask["repeated"][number], words: string): EditAct[] =>
  [{ act: "set", path: `tasks/${task}/${LIST[port.kind]}/${port.port}/${port.instances}`, value: words }];

export const removedInstance = (task: string, port: OutlinePort): EditAct[] =>
  [{ act: "remove", path: `tasks/${task}/${LIST[port.kind]}/${port.declared}/${instanceOf(port.port) ?? 0}` }];

/** The tasks of the text: the key `sequence` makes one more. */
export const ownTasks = ({ tasks, sequence }: Outline): OutlineTask[] =>
  tasks.filter((one) => !sequence || one.task !== "sequence");

/** Puts a task into a configuration, or takes it out. */
export function memberActs(text: string, outline: Outline, name: string, task: string, isMember: boolean): EditAct[] {
  const written = membersAt(text, `configurations/${name}`);
  const present = outline.configurations.find((one) => one.configuration === name)?.tasks ?? [];
  const members = written?.members ?? present.filter((one) => ownTasks(outline).some((own) => own.task === one));
  if (members.includes(task) === isMember) return [];
  const value = isMember ? [...members, task] : members.filter((one) => one !== task);
  return [{ act: "set", path: written?.path ?? `configurations/${name}`, value: `[${value.join(", ")}]` }];
}

/** Takes a task out, and its name out of configurations and standbys. Aliases stay. */
export function removedTask(text: string, outline: Outline, task: string): EditAct[] {
  const written = outline.configurations.filter((one) => wordsAt(text, `configurations/${one.configuration}`) !== null);
  return [
    ...written.flatMap((one) => memberActs(text, outline, one.configuration, task, false)),
    ...outline.tasks.filter((one) => one.standby_for === task && one.task !== task)
      .map((one): EditAct => ({ act: "remove", path: `tasks/${one.task}/standby_for` })),
    { act: "remove", path: `tasks/${task}` },
  ];
}

/** A key of an rtpu. The rtpu `main` need not stand in the text. */
export function rtpuActs(text: string, rtpu: string, key: string, words: string): EditAct[] {
  const isThere = wordsAt(text, `rtpus/${rtpu}`) !== null;
  if (isThere) return valueActs(`rtpus/${rtpu}/${key}`, words, wordsAt(text, `rtpus/${rtpu}/${key}`) !== null);
  return words === "" ? [] : [{ act: "set", path: `rtpus/${rtpu}`, value: `{${key}: ${words}}` }];
}

/** The place that gives a variable or constant its value where no task does. */
export const variablePath = ({ variable, constant }: OutlineVariable): string =>
  `${constant ? "constants" : "operator"}/${variable}`;

export const renameActs = (of: OutlineVariable, to: string): EditAct[] => [{
  act: "rename", to,
  path: of.origin === "operator" || of.origin === "constants" ? `${of.origin}/${of.variable}`
    : `variables/${of.variable}` }];

/** `wanted`, or with the first number behind it that no other name has. */
export function freeName(wanted: string, taken: string[]): string {
  if (!taken.includes(wanted)) return wanted;
  let number = 2;
  while (taken.includes(`${wanted}_${number}`)) ++number;
  return `${wanted}_${number}`;
}
