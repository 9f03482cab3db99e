// SPDX-License-Identifier: Apache-2.0
// The chosen tasks, and the ways of the arrow keys from box to box. No function here knows the browser.
import type { Picture } from "./protocol";

export type Arrow = "ArrowLeft" | "ArrowRight" | "ArrowUp" | "ArrowDown";

/** `tasks` with `task` added or taken away. */
export function toggled(tasks: string[], task: string): string[] {
  return tasks.includes(task) ? tasks.filter((one) => one !== task) : [...tasks, task];
}

/** The tasks that read an out-var of `task` (forward), or that produce one of its in-vars. */
export function neighbours(picture: Picture, task: string, isForward: boolean): string[] {
  const [here, there] = isForward ? ["out-var", "in-var"] : ["in-var", "out-var"];
  const variables = new Set(
    picture.ports.filter((p) => p.task === task && p.kind === here && p.variable !== null).map((p) => p.variable));
  const found = picture.ports.filter((p) => p.kind === there && p.task !== task && variables.has(p.variable));
  return [...new Set(found.map((p) => p.task))];
}

/** The box that an arrow key leads to: left and right along the lines, up and down to the nearest box there. */
export function step(picture: Picture, from: string, arrow: Arrow): string {
  const box = picture.boxes.find((b) => b.task === from);
  if (!box) return picture.boxes[0]?.task ?? from;
  const middle = (b: typeof box) => ({ x: b.x + b.width / 2, y: b.y + b.height / 2 });
  const here = middle(box);
  const isVertical = arrow === "ArrowUp" || arrow === "ArrowDown";
  const sign = arrow === "ArrowRight" || arrow === "ArrowDown" ? 1 : -1;
  const linked = isVertical ? [] : neighbours(picture, from, sign > 0);
  let best = from, least = Infinity;
  for (const other of picture.boxes) {
    if (other.task === from || (linked.length > 0 && !linked.includes(other.task))) continue;
    const there = middle(other);
    const along = sign * (isVertical ? there.y - here.y : there.x - here.x);
    const across = Math.abs(isVertical ? there.x - here.x : there.y - here.y);
    if (linked.length === 0 && along <= 0) continue;
    const far = Math.abs(along) + 2 * across;
    if (far < least) [best, least] = [other.task, far];
  }
  return best;
}
