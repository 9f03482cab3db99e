// SPDX-License-Identifier: Apache-2.0
// A step of a sequence as a tile: its name, a small picture of its configuration, how it ends. Both modes draw it.
import { memo, ReactNode } from "react";
import type { Picture, Step } from "./protocol";

export const nameOf = (step: Step): string => step.name ?? step.switch ?? "?";

/** How a step ends, and what else it says: "until q >= 0.8 rad", "within 3 s, else home", "waits for Go". */
export function wordsOf(step: Step): string[] {
  const words = [step.until !== null && `until ${step.until}`, step.for !== null && `for ${step.for}`,
    (step.within !== null || step.else !== null) && `within ${step.within ?? "10 s"}, else ${step.else ?? "stop"}`,
    step.until === null && step.for === null && "stays", step.confirm && "waits for Go", step.reentry && "reentry"];
  return words.filter((one): one is string => one !== false);
}

/** Tasks that arrive with the step, and those that leave; "": the same tasks. */
export function movedTasks(tasks: string[], before: string[]): string {
  const [arrive, leave] = [tasks.filter((one) => !before.includes(one)), before.filter((one) => !tasks.includes(one))];
  return [arrive.length > 0 && `arrives: ${arrive.join(", ")}`, leave.length > 0 && `leaves: ${leave.join(", ")}`]
    .filter(Boolean).join("; ");
}

/** The boxes of the picture: those of `tasks` are filled, with a bold edge if they are not in `before`. */
export const Thumbnail = memo(function Thumbnail({ picture, tasks, before }:
  { picture: Picture; tasks: string[]; before: string[] }) {
  return (
    <svg className="thumbnail" viewBox={`0 0 ${picture.width} ${picture.height}`} aria-hidden="true">
      {picture.boxes.map(({ task, x, y, width, height }) => (
        <rect key={task} x={x} y={y} width={width} height={height} rx={12}
              className={!tasks.includes(task) ? "" : before.includes(task) ? "on" : "on new"} />))}
    </svg>
  );
});

interface Props {
  number: number; name: string; words: string[]; thumbnail: ReactNode;
  /** An attribute that tests and keys find the tile by, and its value. */
  mark: [attribute: string, value: string];
  isPresent: boolean; children?: ReactNode;
}

export function StepTile({ number, name, words, thumbnail, mark, isPresent, children }: Props) {
  return (
    <li className="step" data-step={number} {...{ [mark[0]]: mark[1] }} aria-current={isPresent ? "step" : undefined}>
      <h3>{number}. {name}</h3>
      {thumbnail}
      {words.map((line) => <p key={line}>{line}</p>)}
      {children}
    </li>
  );
}
