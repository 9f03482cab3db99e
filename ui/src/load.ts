// SPDX-License-Identifier: Apache-2.0
// The load of each rtpu, from two answers of `status`. No function here knows the browser.
import type { Status, TaskStatus } from "./protocol";

/** The greatest sum of budgets that a configuration may have on one CPU: docs/formats/run.md. */
export const CAPACITY = 0.93;

export interface RtpuLoad {
  rtpu: string;
  cpu: number;
  isAlive: boolean;
  /** Execution time over elapsed time, between the two answers; null: not known yet. */
  measured: number | null;
  /** Sum of budget over period of the tasks that are ON. */
  budgets: number;
  missed: number;
  /** Tasks that missed a deadline between the two answers. */
  late: string[];
}

function budget(task: TaskStatus): number {
  if (task.server) return task.server.period_ns > 0 ? task.server.capacity_ns / task.server.period_ns : 0;
  return task.period_ns > 0 ? task.budget_ns / task.period_ns : 0;
}

export function loads(status: Status, before: Status | null): RtpuLoad[] {
  const earlier = new Map((before?.tasks ?? []).map((task) => [task.task, task]));
  const elapsed = before && before.origin_ns === status.origin_ns ? status.now_ns - before.now_ns : 0;
  return status.rtpus.map((rtpu) => {
    const tasks = status.tasks.filter((task) => task.rtpu === rtpu.name);
    let busy = 0;
    const late: string[] = [];
    for (const task of tasks) {
      const old = earlier.get(task.task);
      if (!old || old.incarnation !== task.incarnation) continue;
      busy += Math.max(0, task.busy_ns - old.busy_ns);
      if (task.missed > old.missed) late.push(task.task);
    }
    return {
      rtpu: rtpu.name, cpu: rtpu.cpu, isAlive: rtpu.alive, measured: elapsed > 0 ? busy / elapsed : null,
      budgets: tasks.filter((task) => task.state === "ON").reduce((sum, task) => sum + budget(task), 0),
      missed: tasks.reduce((sum, task) => sum + task.missed, 0), late,
    };
  });
}
