// SPDX-License-Identifier: Apache-2.0
// The load of each CPU, from two answers of `status`. No function here knows the browser.
import type { CpuStatus, Status, TaskStatus } from "./protocol";
import { duration } from "./text";

export interface CpuLoad extends CpuStatus {
  rtpus: string[];
  /** Those of its rtpus that have ended. */
  ended: string[];
  /** Execution time over elapsed time, between the two answers; null: not known yet. */
  measured: number | null;
  missed: number;
  /** Tasks that missed a deadline between the two answers. */
  late: string[];
}

export function loads(status: Status, before: Status | null): CpuLoad[] {
  const earlier = new Map((before?.tasks ?? []).map((task) => [task.task, task]));
  const elapsed = before && before.origin_ns === status.origin_ns ? status.now_ns - before.now_ns : 0;
  return status.cpus.map((cpu) => {
    const rtpus = status.rtpus.filter((rtpu) => rtpu.cpu === cpu.cpu);
    const names = rtpus.map((rtpu) => rtpu.name);
    const tasks = status.tasks.filter((task) => names.includes(task.rtpu));
    let busy = 0;
    const late: string[] = [];
    for (const task of tasks) {
      const old = earlier.get(task.task);
      if (!old || old.incarnation !== task.incarnation) continue;
      busy += Math.max(0, task.busy_ns - old.busy_ns);
      if (task.missed > old.missed) late.push(task.task);
    }
    return {
      ...cpu, rtpus: names, ended: rtpus.filter((rtpu) => !rtpu.alive).map((rtpu) => rtpu.name),
      measured: elapsed > 0 ? busy / elapsed : null, missed: tasks.reduce((sum, task) => sum + task.missed, 0), late,
    };
  });
}

/** Execution time of a task, as measured. */
export const meanAndLongest = ({ execution_ns: { mean, max } }: TaskStatus): string =>
  `${duration(mean)}, longest ${duration(max)}`;
