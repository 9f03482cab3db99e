// SPDX-License-Identifier: Apache-2.0
// The panel "Timeline": releases, runs, preemptions and misses of the last seconds, from the tap of the machine.
import { useEffect, useRef, useState } from "react";
import { key } from "./bench";
import { Button, Table } from "./controls";
import { Door } from "./door";
import type { MachineState } from "./machine";
import { blame, Miss, MOST_PER_SECOND, TapRecords, TimelineRow } from "./tap";
import { count, duration } from "./text";

const DRAW_MS = 250, ROW = 18, NAMES = 130;

function draw(canvas: HTMLCanvasElement, rows: TimelineRow[], width: number): void {
  const scale = window.devicePixelRatio || 1, pen = canvas.getContext("2d"), style = getComputedStyle(canvas);
  canvas.width = (width + NAMES) * scale;
  canvas.height = Math.max(1, rows.length) * ROW * scale;
  canvas.style.height = `${Math.max(1, rows.length) * ROW}px`;
  if (!pen) return;
  const colour = (name: string) => style.getPropertyValue(name);
  pen.scale(scale, scale);
  pen.font = "11px \"DejaVu Sans Mono\", monospace";
  rows.forEach((row, i) => {
    const top = i * ROW, bottom = top + ROW - 3;
    pen.fillStyle = colour("--ink");
    pen.fillText(row.task, 2, bottom - 2, NAMES - 8);
    pen.fillStyle = colour("--rule");
    pen.fillRect(NAMES, bottom, width, 1);
    pen.fillStyle = colour("--on");
    for (const [from, to] of row.runs) pen.fillRect(NAMES + from, top + 4, to - from, ROW - 7);
    pen.fillStyle = colour("--soft");
    for (const at of row.releases) pen.fillRect(NAMES + at, bottom - 3, 1, 5);
    pen.fillStyle = colour("--ink");
    for (const at of row.preempts) pen.fillRect(NAMES + at, top + 1, 1, 5);
    pen.strokeStyle = colour("--error");
    pen.lineWidth = 2;
    for (const at of row.misses) {  // a cross: seen without colour
      pen.beginPath();
      pen.moveTo(NAMES + at - 4, top + 3);
      pen.lineTo(NAMES + at + 4, top + 11);
      pen.moveTo(NAMES + at - 4, top + 11);
      pen.lineTo(NAMES + at + 4, top + 3);
      pen.stroke();
    }
  });
}

interface Shown { span: number; tasks: number; misses: Miss[]; lost: number; latest: number }

export function Timeline({ name, state }: { name: string; state: MachineState }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [isPaused, pause] = useState(false);
  const [shown, show] = useState<Shown | null>(null);
  const records = useRef(new TapRecords());
  const cpus = useRef(new Map<string, number>());
  cpus.current = new Map((state.status?.rtpus ?? []).map((rtpu) => [rtpu.name, rtpu.cpu]));
  useEffect(() => {  // a connection of its own: the records must not delay states and values
    const door = new Door(`/machine/${encodeURIComponent(name)}`, key, {
      opened: (open) => void open.call("subscribe", { to: "tap", since: 0 }).catch(() => undefined),
      changed: () => undefined,
      note: (method, parameters) => { if (method === "tap") records.current.add(parameters); },
    });
    return () => door.close();
  }, [name]);
  useEffect(() => {
    if (isPaused) return;
    const sharers = (rtpu: string) =>
      [...cpus.current].filter(([, cpu]) => cpu === cpus.current.get(rtpu)).map(([other]) => other);
    const drawAll = () => {
      if (document.hidden || !canvas.current) return;
      const { current: all } = records;
      const span = all.keep(), width = Math.max(100, Math.floor(canvas.current.clientWidth) - NAMES);
      const rows = all.rows(span, width);
      draw(canvas.current, rows, width);
      show({ span, tasks: rows.length, misses: all.misses(sharers), lost: all.lost, latest: all.latest });
    };
    drawAll();
    const timer = window.setInterval(drawAll, DRAW_MS);
    return () => window.clearInterval(timer);
  }, [isPaused]);
  const isShort = shown !== null && shown.span === 1e9;
  return (
    <div className="timeline" data-timeline={isShort ? "1 s" : "10 s"}>
      <div className="acts">
        <Button label={isPaused ? "Go on" : "Pause"} isPressed={isPaused} press={() => pause(!isPaused)} />
        <span className="hint">{isShort
          ? `more than ${count(MOST_PER_SECOND)} records a second: the last second only` : "the last 10 s"}
          {shown && shown.lost > 0 && `; ${count(shown.lost)} records are lost`}; bars are runs, ticks below releases,
          ticks above preemptions, crosses missed deadlines and dropped releases</span>
      </div>
      <canvas ref={canvas} role="img" onClick={() => pause(!isPaused)}
              aria-label={`Timeline of ${shown?.tasks ?? 0} tasks; the misses stand in the table below`} />
      {shown && shown.misses.length > 0
        ? <Table label="Missed deadlines, newest first"
                 heading={["before the end", "task", "late", "who had the processor"]}
                 rows={shown.misses.map((miss) => [duration(shown.latest - miss.at), miss.task,
                   miss.dropped > 0 ? `${miss.dropped} dropped` : duration(miss.late), blame(miss, duration)])} />
        : <p className="hint">No deadline was missed.</p>}
    </div>
  );
}
