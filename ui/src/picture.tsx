// SPDX-License-Identifier: Apache-2.0
// The picture of what runs: draws the layout that the subsystem gives, with states and values in it.
import { KeyboardEvent, memo, MouseEvent, useEffect, useRef } from "react";
import type { Picture, PictureBox, PictureLabel, PicturePort, State, TaskStatus } from "./protocol";
import { Arrow, step, toggled } from "./selection";
import { rate } from "./text";
import { besidePort, LiveValues } from "./values";

/** Room right of a port for its value, and places of texts around it: docs/formats/web.md, "The picture". */
const BELOW = 9, BELOW_NAME = 15, RIGHT = 4, STUB = 20;

interface ValueProps { port: PicturePort & { variable: string }; values: LiveValues }

/** The latest value of the variable at a port. Its text changes without React. */
const PortValue = memo(function PortValue({ port, values }: ValueProps) {
  const text = useRef<SVGTextElement>(null);
  const isOut = port.kind === "out-var";
  useEffect(() => values.watch(port.variable, (reading, age, isOld) => {
    const element = text.current;
    if (!element) return;
    const isAnothers = isOut && reading.producer !== "" && reading.producer !== port.task;
    const words = isAnothers ? "" : besidePort(reading, age);
    if (element.textContent !== words) element.textContent = words;
    element.classList.toggle("old", isOld);
    element.classList.toggle("invalid", !reading.valid);
  }), [values, port.variable, port.task, isOut]);
  return <text ref={text} className="value" data-value={port.variable} data-of={port.task}
               x={port.x + (isOut ? RIGHT : -STUB)} y={port.y + (isOut ? BELOW : BELOW_NAME)}
               textAnchor={isOut ? "start" : "end"} />;
});

const isLinked = (port: PicturePort): port is PicturePort & { variable: string } => port.variable !== null;

interface BoxProps {
  box: PictureBox; rateHz: number; state: State; isDead: boolean; isMissing: boolean; isChosen: boolean;
  isFirst: boolean; choose: (task: string, isAdding: boolean) => void;
  move: (event: KeyboardEvent, task: string) => void;
}

const TaskBox = memo(function TaskBox(
  { box, rateHz, state, isDead, isMissing, isChosen, isFirst, choose, move }: BoxProps) {
  const { x, y, width, height } = box;
  const words = `${box.task}, ${state}${isDead ? ", its rtpu has ended" : ""}, ${rate(rateHz)}`;
  const tag = isMissing ? `missed, ${state}` : state;
  return (
    <g className={`box state-${state}${isDead ? " dead" : ""}${isChosen ? " chosen" : ""}`} data-task={box.task}
       data-state={state} role="button" aria-label={words} aria-pressed={isChosen} tabIndex={isFirst ? 0 : -1}
       onClick={(event: MouseEvent) => choose(box.task, event.ctrlKey || event.shiftKey || event.metaKey)}
       onKeyDown={(event) => move(event, box.task)}>
      <rect className="frame" x={x} y={y} width={width} height={height} rx={12} />
      {state === "ERROR" && <rect className="hatch" x={x} y={y} width={width} height={height} rx={12} />}
      {state === "ON" && <rect className="bar" x={x + 3} y={y + 12} width={4} height={height - 24} rx={2} />}
      <rect className="tag" x={x + width - 8 - tag.length * 6.1} y={y - 8} width={tag.length * 6.1 + 4} height={14}
            rx={4} />
      <text className={isMissing ? "state missing" : "state"} x={x + width - 6} y={y + 3} textAnchor="end">{tag}</text>
    </g>
  );
});

/** Lines, dots and names: they change with the description alone. */
export const Drawing = memo(function Drawing({ picture, variable }: { picture: Picture; variable: string }) {
  const look = (name: string) => (name !== "" && name === variable ? "chosen" : undefined);
  const arrow = (at: string, wanted: string) => (at === wanted || at === "both" ? "url(#arrow)" : undefined);
  return (
    <g className="drawing">
      {picture.lines.map((l, i) => (
        <line key={i} x1={l.x1} y1={l.y1} x2={l.x2} y2={l.y2} data-variable={l.variable} className={look(l.variable)}
              markerStart={arrow(l.arrow, "start")} markerEnd={arrow(l.arrow, "end")} />))}
      {picture.dots.map((d, i) => <circle key={i} cx={d.x} cy={d.y} r={3} className={look(d.variable)} />)}
    </g>
  );
});

/** Names of variables outside of the boxes lead to the variable; inside of a box every press chooses the task. */
const isLink = (label: PictureLabel) => label.variable !== null && (label.style === "soft" || label.style === "given");

export const Labels = memo(function Labels({ picture, variable, showVariable }:
  { picture: Picture; variable: string; showVariable: (variable: string) => void }) {
  return (
    <g className="labels">
      {picture.labels.filter((l) => l.style !== "title").map((l, i) => (
        <text key={i} x={l.x} y={l.y} textAnchor={l.anchor} data-label={l.variable ?? undefined}
              className={l.style + (isLink(l) ? " link" : "") + (l.variable === variable ? " chosen" : "")}
              onClick={isLink(l) ? () => showVariable(l.variable as string) : undefined}>{l.text}</text>))}
    </g>
  );
});

export const Definitions = () => (
  <defs>
    <marker id="arrow" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="7" markerHeight="7" orient="auto-start-reverse">
      <path d="M0,0 L8,4 L0,8 z" />
    </marker>
    <pattern id="hatching" width="8" height="8" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">
      <line x1="0" y1="0" x2="0" y2="8" />
    </pattern>
  </defs>
);

/** Boxes as buttons: presses, arrow keys, and which box Tab reaches. */
export function useBoxes(picture: Picture, chosen: string[], choose: (tasks: string[]) => void) {
  const root = useRef<SVGSVGElement>(null);
  const latest = useRef({ chosen, picture });
  latest.current = { chosen, picture };
  const pick = useRef((task: string, isAdding: boolean) => {
    choose(isAdding ? toggled(latest.current.chosen, task) : [task]);
  }).current;
  const move = useRef((event: KeyboardEvent, task: string) => {
    const isAdding = event.shiftKey || event.ctrlKey;
    if (event.key === " " || event.key === "Enter") pick(task, isAdding);
    else if (event.key.startsWith("Arrow")) {
      const next = step(latest.current.picture, task, event.key as Arrow);
      root.current?.querySelector<SVGGElement>(`[data-task="${CSS.escape(next)}"]`)?.focus();
      if (!isAdding) choose([next]);
    } else return;
    event.preventDefault();
  }).current;
  const focused = chosen.find((task) => picture.boxes.some((box) => box.task === task)) ?? picture.boxes[0]?.task;
  return { root, pick, move, focused };
}

interface Props {
  picture: Picture; tasks: TaskStatus[]; before: TaskStatus[]; dead: Set<string>; values: LiveValues; zoom: number;
  chosen: string[]; variable: string; choose: (tasks: string[]) => void; showVariable: (variable: string) => void;
}

export function PictureView(
  { picture, tasks, before, dead, values, zoom, chosen, variable, choose, showVariable }: Props) {
  const { root, pick, move, focused } = useBoxes(picture, chosen, choose);
  const status = new Map(tasks.map((task) => [task.task, task]));
  const earlier = new Map(before.map((task) => [task.task, task]));
  return (
    <svg ref={root} className="picture" viewBox={`0 0 ${picture.width} ${picture.height}`} width={picture.width * zoom}
         height={picture.height * zoom} role="group" aria-label={`Tasks of ${picture.title}`}>
      <Definitions />
      <Drawing picture={picture} variable={variable} />
      {picture.boxes.map((box) => {
        const task = status.get(box.task);
        return <TaskBox key={box.task} box={box} rateHz={task?.rate_hz ?? 0} state={task?.state ?? "NOT-CREATED"}
                        isDead={dead.has(box.task)} isChosen={chosen.includes(box.task)} isFirst={box.task === focused}
                        isMissing={(task?.missed ?? 0) > (earlier.get(box.task)?.missed ?? Infinity)}
                        choose={pick} move={move} />;
      })}
      <Labels picture={picture} variable={variable} showVariable={showVariable} />
      {picture.ports.filter(isLinked).filter((p) => p.kind === "out-var").map((p) => (
        <PortValue key={`${p.task} ${p.port}`} port={p} values={values} />))}
      {givenPorts(picture).map((p) => <PortValue key={`${p.task} ${p.port}`} port={p} values={values} />)}
    </svg>
  );
}

/** In-ports whose variable has no box: the operator's, whose value stands at the port. */
function givenPorts(picture: Picture): (PicturePort & { variable: string })[] {
  const given = new Set(picture.labels.filter((l) => l.style === "given").map((l) => l.variable));
  return picture.ports.filter(isLinked).filter((p) => p.kind === "in-var" && given.has(p.variable));
}
