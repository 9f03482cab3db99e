// SPDX-License-Identifier: Apache-2.0
// The picture of the draft: draws the layout of the analyst, with faults at boxes and ports. A line can be pulled from
// one port to another with the mouse; fields of the task do the same by the keyboard.
import { KeyboardEvent, memo, MouseEvent, useEffect, useRef, useState } from "react";
import { faultsAt } from "./faults";
import { Definitions, Drawing, Labels, useBoxes } from "./picture";
import type { Fault, Picture, PictureBox, PicturePort, TaskPort } from "./protocol";

interface BoxProps {
  box: PictureBox; fault: string; isChosen: boolean; isFirst: boolean; isAtCursor: boolean;
  choose: (task: string, isAdding: boolean) => void; move: (event: KeyboardEvent, task: string) => void;
}

const DraftBox = memo(function DraftBox(
  { box, fault, isChosen, isFirst, isAtCursor, choose, move }: BoxProps) {
  const { x, y, width, height } = box;
  const names = ["box", fault && "faulty", isChosen && "chosen", isAtCursor && "at-cursor"];
  return (
    <g className={names.filter(Boolean).join(" ")} data-task={box.task} role="button" aria-pressed={isChosen}
       aria-label={`${box.task}${fault && `, faulty: ${fault}`}`} tabIndex={isFirst ? 0 : -1}
       onClick={(event: MouseEvent) => choose(box.task, event.ctrlKey || event.shiftKey || event.metaKey)}
       onKeyDown={(event) => move(event, box.task)}>
      {fault !== "" && <title>{fault}</title>}
      <rect className="frame" x={x} y={y} width={width} height={height} rx={12} />
      {fault !== "" && <rect className="hatch" x={x} y={y} width={width} height={height} rx={12} />}
      {fault !== "" && <rect className="tag" x={x + width - 45} y={y - 8} width={41} height={14} rx={4} />}
      {fault !== "" && <text className="state missing" x={x + width - 6} y={y + 3} textAnchor="end">faulty</text>}
    </g>
  );
});

const DraftPort = memo(function DraftPort({ port, fault, isTarget, press }:
  { port: PicturePort; fault: string; isTarget: boolean; press: (event: MouseEvent, port: TaskPort) => void }) {
  const words = `${port.kind} ${port.port} of ${port.task}` +
    `${port.variable === null ? "" : `, linked to ${port.variable}`}${fault && `, faulty: ${fault}`}`;
  return (
    <g className={`port${fault ? " faulty" : ""}${isTarget ? " target" : ""}`} role="button" tabIndex={-1}
       data-port={`${port.task} ${port.port}`} aria-label={words} onMouseDown={(event) => press(event, port)}>
      <title>{words}</title>
      <circle className="reach" cx={port.x} cy={port.y} r={9} />
      <circle className="end" cx={port.x} cy={port.y} r={fault ? 5 : 3.5} />
      {fault !== "" && <path className="cross" d={`M${port.x - 3} ${port.y - 3}l6 6m0-6l-6 6`} />}
    </g>
  );
});

interface Pull { from: PicturePort; x: number; y: number; over: string }

interface Props {
  picture: Picture; faults: Fault[]; zoom: number; chosen: string[]; variable: string; cursorTask: string;
  choose: (tasks: string[]) => void; showVariable: (variable: string) => void;
  pressPort: (port: TaskPort) => void; link: (from: TaskPort, to: TaskPort) => void;
  /** Why nothing can be linked; "": it can. */
  why: string;
}

export const DraftPicture = memo(function DraftPicture(props: Props) {
  const { picture, faults, zoom, chosen, variable, cursorTask, choose, showVariable } = props;
  const { root, pick, move, focused } = useBoxes(picture, chosen, choose);
  const [pull, setPull] = useState<Pull | null>(null);
  const latest = useRef(props);
  latest.current = props;
  const release = useRef<() => void>(() => undefined);
  useEffect(() => () => release.current(), []);
  const press = useRef((event: MouseEvent, from: TaskPort) => {
    if (event.button !== 0 || !root.current) return;
    event.preventDefault();  // chooses no texts
    (document.activeElement as HTMLElement | null)?.blur?.();  // a field carries its act out
    const place = latest.current.picture.ports.find((p) => p.task === from.task && p.port === from.port);
    if (!place || latest.current.why !== "") return latest.current.pressPort(from);
    const over = (now: globalThis.MouseEvent) =>
      (document.elementFromPoint(now.clientX, now.clientY)?.closest("[data-port]") as HTMLElement | null)
        ?.dataset["port"] ?? "";
    const follow = (now: globalThis.MouseEvent) => {
      const at = root.current!.getBoundingClientRect();
      const scale = latest.current.picture.width / at.width;
      setPull({ from: place, x: (now.clientX - at.left) * scale, y: (now.clientY - at.top) * scale, over: over(now) });
    };
    const end = (now: globalThis.MouseEvent) => {
      release.current();
      const there = latest.current.picture.ports.find((p) => `${p.task} ${p.port}` === over(now));
      if (there && (there.task !== from.task || there.port !== from.port)) latest.current.link(from, there);
      else if (there) latest.current.pressPort(from);
    };
    const cancel = (key: globalThis.KeyboardEvent) => {
      if (key.key !== "Escape") return;
      key.preventDefault();
      release.current();
    };
    release.current = () => {
      setPull(null);
      window.removeEventListener("mousemove", follow);
      window.removeEventListener("mouseup", end);
      window.removeEventListener("keydown", cancel, true);
    };
    window.addEventListener("mousemove", follow);
    window.addEventListener("mouseup", end);
    window.addEventListener("keydown", cancel, true);
  }).current;
  return (
    <svg ref={root} className="picture draft" viewBox={`0 0 ${picture.width} ${picture.height}`}
         width={picture.width * zoom} height={picture.height * zoom} role="group"
         aria-label={`Tasks of the draft ${picture.title}`}>
      <Definitions />
      <Drawing picture={picture} variable={variable} />
      {picture.boxes.map((box) => (
        <DraftBox key={box.task} box={box} fault={faultsAt(faults, box.task)} isChosen={chosen.includes(box.task)}
                  isFirst={box.task === focused} isAtCursor={box.task === cursorTask}
                  choose={pick} move={move} />))}
      <Labels picture={picture} variable={variable} showVariable={showVariable} />
      {picture.ports.map((port) => (
        <DraftPort key={`${port.task} ${port.port}`} port={port} fault={faultsAt(faults, port.task, port.port)}
                   isTarget={pull !== null && pull.over === `${port.task} ${port.port}`} press={press} />))}
      {pull && <line className="pulled" x1={pull.from.x} y1={pull.from.y} x2={pull.x} y2={pull.y}
                     markerEnd={pull.from.kind.startsWith("out") ? "url(#arrow)" : undefined}
                     markerStart={pull.from.kind.startsWith("in") ? "url(#arrow)" : undefined} />}
    </svg>
  );
});
