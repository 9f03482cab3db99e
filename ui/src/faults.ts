// SPDX-License-Identifier: Apache-2.0
// Where the faults of a draft belong: boxes, ports, CPUs. No function here knows the browser.
import type { Fault, Outline, Schedule, ScheduledCpu } from "./protocol";

/** The port that a fault names; a fault at all instances of a repeated port belongs to each: `in` to `in[0]`. */
const isAt = (fault: Fault, port: string) =>
  fault.port !== "" && (fault.port === port || port.startsWith(`${fault.port}[`));

/** The messages of errors at a box (no port), or at one of its ports; "": none. */
export function faultsAt(faults: Fault[], task: string, port?: string): string {
  const isHere = (fault: Fault) => fault.task === task && (port === undefined || isAt(fault, port));
  return faults.filter((fault) => fault.severity === "error" && isHere(fault))
    .map((fault) => fault.message).join("\n");
}

/** The step that a fault belongs to, from 1; 0: the sequence as a whole; null: neither. */
export function stepOf({ path, rule }: Fault): number | null {
  const number = /^sequence\/(?:steps\/)?(\d+)/.exec(path)?.[1];
  if (number !== undefined) return Number(number) + 1;
  return /^sequence(\/|$)/.test(path) || rule.startsWith("sequence-") ? 0 : null;
}

/** The box that a fault leads to; "": it leads to the text alone. */
export function boxOf(fault: Fault, outline: Outline | null): string {
  const tasks = (outline?.tasks ?? []).map((task) => task.task);
  const named = stepOf(fault) !== null ? "sequence" : fault.task !== "" ? fault.task
    : /^tasks\/([^/]+)/.exec(fault.path)?.[1] ?? "";
  return tasks.includes(named) ? named : "";
}

export interface CpuVerdict extends ScheduledCpu { set: string; note: string }

/** Each CPU in its worst set: one that does not fit, else the one with the highest load. */
export function cpuVerdicts(schedule: Schedule): CpuVerdict[] {
  const worst = new Map<number, { set: string; cpu: ScheduledCpu }>();
  for (const set of schedule.sets)
    for (const cpu of set.cpus) {
      const known = worst.get(cpu.cpu)?.cpu;
      if (!known || (known.fits && !cpu.fits) || (known.fits === cpu.fits && cpu.utilisation > known.utilisation))
        worst.set(cpu.cpu, { set: set.name, cpu });
    }
  return [...worst.values()].sort((a, b) => a.cpu.cpu - b.cpu.cpu)
    .map(({ set, cpu }) => ({ ...cpu, set, note: noteOf(cpu) }));
}

function noteOf(cpu: ScheduledCpu): string {
  const of = (guarantee: string) =>
    cpu.tasks.filter((task) => task.guarantee === guarantee).map((task) => task.task).join(", ");
  const parts: string[] = [];
  if (of("no") !== "") parts.push(`may miss deadlines: ${of("no")}`);
  if (!cpu.fits && cpu.give_way.length > 0) parts.push(`the rest fits without ${cpu.give_way.join(", ")}`);
  if (of("not-decided") !== "") parts.push(`not decided: ${of("not-decided")}`);
  if (of("not-stated") !== "") parts.push(`without a budget: ${of("not-stated")}`);
  if (of("yes") !== "" || parts.length === 0)
    parts.unshift(of("yes") !== "" && parts.length > 0 ? `keep their deadlines: ${of("yes")}`
      : cpu.fits ? "all keep their deadlines" : "does not fit");
  return parts.join("; ");
}
