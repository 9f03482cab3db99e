// SPDX-License-Identifier: Apache-2.0
// Curves of a table: an axis for each unit, two cursors, gaps hatched, and the curves of an earlier table pale behind.
import { useMemo, useState } from "react";
import { Table as Rows } from "./controls";
import { Channel, curvePath, followerOf, gapsOf, rangeOf, reduced, rowAt, Table, ticks, unitsOf } from "./table";
import { count, short } from "./text";

const WIDTH = 1000, STRIP = 150, LEFT = 64, RIGHT = 12, GAP = 32, LEGEND = 16;

/** Colour and dashes of the channel of that number: 32 can be told apart. A reference has the colour of what follows
 * it. */
function look(channels: Channel[], number: number): string {
  const followers = channels.map((one) => followerOf(channels, one.name)), follower = followers[number]!;
  const own = followers.slice(0, follower < 0 ? number : follower).filter((one) => one < 0).length;
  const round = Math.floor(own / 8), isPaired = followers.some((one) => one >= 0);
  return `curve colour${own % 8} dash${isPaired ? 2 * (round % 2) + Number(follower >= 0) : round % 4}`;
}

const LETTER = 7.3;  // width of one, in the font of the curves

/** The channels of a strip above it, as many as its width holds; the table below has all. */
function Legend({ table, own, top }:
  { table: Table; own: { channel: Channel; number: number }[]; top: number }) {
  let end = LEFT;
  return <>{own.map(({ channel: { name }, number }) => {
    const x = end;
    end += 30 + LETTER * name.length;
    return end < WIDTH - RIGHT && (
      <g key={number}>
        <line className={look(table.channels, number)} x1={x} x2={x + 18} y1={top - 7} y2={top - 7} />
        <text x={x + 21} y={top - 3}>{name}</text></g>);
  })}</>;
}

function Strip({ table, before, unit, top, x }:
  { table: Table; before: Table | null; unit: string; top: number; x: (at: number) => number }) {
  const own = table.channels.map((channel, number) => ({ channel, number })).filter((one) => one.channel.unit === unit);
  const old = (before?.channels ?? []).filter((channel) => own.some((one) => one.channel.name === channel.name));
  const [low, high] = useMemo(() => rangeOf([...own.map((one) => one.channel), ...old]), [table, before, unit]);
  const y = (value: number) => top + (STRIP * (high - value)) / (high - low);
  const end = table.time[table.time.length - 1] ?? 0;
  const gaps = useMemo(() => gapsOf(table), [table]);
  const breaks = useMemo(() => new Set(gaps.map((gap) => gap.to)), [gaps]);
  return (
    <g>
      <rect className="frame" x={LEFT} y={top} width={WIDTH - LEFT - RIGHT} height={STRIP} />
      <text x={4} y={top + 10}>{unit === "1" ? "" : unit}</text>
      <Legend table={table} own={own} top={top} />
      {ticks(low, high).map((value) => (
        <g key={value}>
          <line className="grid" x1={LEFT} x2={WIDTH - RIGHT} y1={y(value)} y2={y(value)} />
          <text x={LEFT - 4} y={y(value) + 4} textAnchor="end">{short(value)}</text>
        </g>))}
      {gaps.map((gap) => (
        <rect key={gap.to} className="lost-rows" x={x(gap.from)} y={top} height={STRIP} data-gap={gap.rows}
              width={Math.max(2, x(gap.to) - x(gap.from))} />))}
      {old.map((channel) => (
        <path key={channel.name} className="curve pale" data-before={channel.name}
              d={curvePath(reduced(before!, channel).filter((one) => one.at <= end), x, y, new Set())} />))}
      {own.map(({ channel, number }) => (
        <path key={channel.name} className={look(table.channels, number)} data-channel={channel.name}
              d={curvePath(reduced(table, channel), x, y, breaks)} />))}
    </g>
  );
}

const CURSORS = ["A", "B"] as const;

/** `label`: of the picture, for those who do not see it. */
export function Curves({ table, before, label }: { table: Table; before: Table | null; label: string }) {
  const [from, to] = [table.time[0] ?? 0, table.time[table.time.length - 1] ?? 1];
  const [chosen, choose] = useState<[number, number] | null>(null);
  const cursors = (chosen ?? [from, to]).map((at) => Math.min(to, Math.max(from, at))) as [number, number];
  const units = unitsOf(table.channels);
  const span = to - from || 1, height = units.length * (STRIP + GAP) + LEGEND + 12;
  const x = (at: number) => LEFT + ((WIDTH - LEFT - RIGHT) * (at - from)) / span;
  const move = (cursor: number, at: number) =>
    choose([cursor === 0 ? at : cursors[0], cursor === 1 ? at : cursors[1]]);
  const press = (event: { clientX: number; currentTarget: Element }) => {
    const box = event.currentTarget.getBoundingClientRect();
    const place = ((event.clientX - box.left) / box.width) * WIDTH;
    const at = from + (span * (place - LEFT)) / (WIDTH - LEFT - RIGHT);
    move(Math.abs(at - cursors[0]) <= Math.abs(at - cursors[1]) ? 0 : 1, at);
  };
  const pictures = useMemo(() => units.map((unit, i) => (
    <Strip key={unit} table={table} before={before} unit={unit} top={LEGEND + i * (STRIP + GAP)} x={x} />)),
    [table, before]);
  const rows = cursors.map((at) => rowAt(table, at));
  const gaps = gapsOf(table), lost = gaps.reduce((sum, gap) => sum + gap.rows, 0);
  return (
    <div className="curves">
      <svg viewBox={`0 0 ${WIDTH} ${height}`} role="img" aria-label={label} onClick={press}>
        <defs><pattern id="lost-rows" width="6" height="6" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">
          <line x1="0" y1="0" x2="0" y2="6" /></pattern></defs>
        {pictures}
        {ticks(from, to).map((at) => (
          <text key={at} x={x(at)} y={height - 4} textAnchor="middle">{short(at)} s</text>))}
        {CURSORS.map((name, i) => (
          <g key={name} className="cursor">
            <line x1={x(cursors[i]!)} x2={x(cursors[i]!)} y1={8} y2={height - 18} />
            <text x={x(cursors[i]!) + 3} y={height - 20}>{name}</text></g>))}
      </svg>
      {CURSORS.map((name, i) => (
        <label key={name} className="cursor-field">{name}
          <input type="range" min={from} max={to} step={span / 1000} value={cursors[i]} aria-label={`Cursor ${name}`}
                 aria-valuetext={`${short(cursors[i]!)} s`}
                 onChange={(event) => move(i, Number(event.target.value))} /></label>))}
      <Rows label="Values at the cursors" heading={["channel", "unit", "A", "B", "B − A"]} rows={[
        ["time", "s", short(cursors[0]), short(cursors[1]), short(cursors[1] - cursors[0])],
        ...table.channels.map(({ name, unit, values }, number) => {
          const [a, b] = rows.map((row) => values[row] ?? NaN) as [number, number];
          const said = (value: number) => (Number.isNaN(value) ? "none" : short(value));
          return [<><svg className="swatch" viewBox="0 0 30 8" aria-hidden="true">
            <line className={look(table.channels, number)} x1="0" y1="4" x2="30" y2="4" /></svg>{name}</>,
            unit === "1" ? "" : unit, said(a), said(b), said(b - a)];
        })]} />
      <p className="hint" data-lost={lost}>{count(table.time.length)} rows{gaps.length === 0 ? ", no gap"
        : `; ${gaps.length} gaps, ${count(lost)} rows lost (hatched)`}
        {before !== null && "; pale: the one before"}</p>
    </div>
  );
}
