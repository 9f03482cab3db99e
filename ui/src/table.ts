// SPDX-License-Identifier: Apache-2.0
// The table of `chimera run --csv` and `chimera scope --csv`, reduced to what a picture can show. No function here
// knows the browser.

export interface Channel { name: string; unit: string; values: Float64Array }
/** `lost[i]`: rows that are missing just before row i. */
export interface Table { time: Float64Array; channels: Channel[]; lost: Float64Array }

/** Least and greatest value of a part of the time; NaN: nothing was written then. */
export interface Column { at: number; least: number; greatest: number }

export const MOST_COLUMNS = 1000;

/** "q[0](rad)" is q[0] in rad; without a unit it is a number. */
function channelOf(heading: string, rows: number): Channel {
  const at = heading.indexOf("(");
  return { name: at < 0 ? heading : heading.slice(0, at), unit: at < 0 ? "1" : heading.slice(at + 1, -1),
    values: new Float64Array(rows) };
}

/** Null: the text is no such table. */
export function readTable(text: string): Table | null {
  const lines = text.split("\n").filter((line) => line !== "");
  const headings = lines.shift()?.split(",") ?? [];
  if (headings.shift() !== "t(s)") return null;
  const table: Table = { time: new Float64Array(lines.length), lost: new Float64Array(lines.length),
    channels: headings.map((heading) => channelOf(heading, lines.length)) };
  lines.forEach((line, row) => line.split(",").forEach((word, i) => {
    const value = word === "" ? NaN : Number(word);
    if (i === 0) table.time[row] = value;
    else if (table.channels[i - 1]) table.channels[i - 1]!.values[row] = value;
  }));
  const last = table.channels[table.channels.length - 1];
  if (last?.name === "lost" && last.unit === "1" && headings[headings.length - 1] === "lost")
    table.lost = table.channels.pop()!.values;
  return table;
}

/** Every value, or, of more rows than `most`, least and greatest of each part of the time. */
export function reduced({ time }: Table, { values }: Channel, most = MOST_COLUMNS): Column[] {
  const n = time.length;
  if (n <= most) return Array.from(values, (value, i) => ({ at: time[i]!, least: value, greatest: value }));
  const from = time[0]!, width = (time[n - 1]! - from) / most;
  const columns: Column[] = [];
  for (let i = 0; i < n; ++i) {
    const place = Math.min(most - 1, Math.floor((time[i]! - from) / width));
    const value = values[i]!, last = columns[columns.length - 1];
    const at = from + place * width;
    if (!last || last.at !== at) columns.push({ at, least: value, greatest: value });
    else {
      last.least = last.least <= value ? last.least : Number.isNaN(value) ? last.least : value;
      last.greatest = last.greatest >= value ? last.greatest : Number.isNaN(value) ? last.greatest : value;
    }
  }
  return columns;
}

/** A variable q follows the variable q_ref. */
export const REFERENCE = "_ref";

/** The number of the channel that the channel `name` is the reference of: of q[0] for q_ref[0]; below 0: of none. */
export const followerOf = (channels: Channel[], name: string): number => {
  const [variable = "", element = ""] = name.split(/(?=\[)/);
  return !variable.endsWith(REFERENCE) ? -1
    : channels.findIndex((one) => one.name === variable.slice(0, -REFERENCE.length) + element);
};

/** How far each variable and its reference are apart at most, in which channel and when. */
export function apartOf({ time, channels }: Table):
  { name: string; reference: string; unit: string; most: number; channel: string; at: number }[] {
  const all = new Map<string, ReturnType<typeof apartOf>[number]>();
  for (const to of channels) {
    const from = channels[followerOf(channels, to.name)];
    if (!from || from.unit !== to.unit) continue;
    const [name = ""] = from.name.split("[");
    const one = all.get(name) ?? { name, reference: name + REFERENCE, unit: to.unit, most: -1, channel: "", at: 0 };
    time.forEach((at, row) => {
      const apart = Math.abs(from.values[row]! - to.values[row]!);
      if (apart > one.most) Object.assign(one, { most: apart, channel: from.name, at });
    });
    if (one.most >= 0) all.set(name, one);
  }
  return [...all.values()];
}

/** The spans in which rows are missing. */
export function gapsOf({ time, lost }: Table): { from: number; to: number; rows: number }[] {
  const gaps: { from: number; to: number; rows: number }[] = [];
  lost.forEach((rows, i) => { if (rows > 0) gaps.push({ from: time[Math.max(0, i - 1)]!, to: time[i]!, rows }); });
  return gaps;
}

/** The row that holds at a time: the last one that is not later. */
export function rowAt({ time }: Table, at: number): number {
  let low = 0, high = time.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (time[middle]! <= at) low = middle + 1;
    else high = middle;
  }
  return Math.max(0, low - 1);
}

/** Channels with the same unit share an axis; in the order of their first one. */
export function unitsOf(channels: Channel[]): string[] {
  return [...new Set(channels.map((channel) => channel.unit))];
}

/** Least and greatest of all channels of a unit, a little apart if they are the same. */
export function rangeOf(channels: Channel[]): [number, number] {
  let least = Infinity, greatest = -Infinity;
  for (const { values } of channels)
    for (const value of values) {
      if (!Number.isFinite(value)) continue;
      least = Math.min(least, value);
      greatest = Math.max(greatest, value);
    }
  if (least > greatest) return [0, 1];
  const margin = (greatest - least) * 0.05 || Math.abs(least) * 0.1 || 1;
  return [least - margin, greatest + margin];
}

/** At most about six round numbers from `low` to `high`. */
export function ticks(low: number, high: number): number[] {
  const rough = (high - low) / 5, size = 10 ** Math.floor(Math.log10(rough));
  const step = size * ([1, 2, 5].find((n) => n * size >= rough) ?? 10);
  if (!Number.isFinite(step) || step <= 0) return [];
  const all: number[] = [];
  for (let n = Math.ceil(low / step); n * step <= high; ++n) all.push(Number((n * step).toPrecision(12)));
  return all;
}

/** A line that holds each value until the next one; it breaks where nothing was written, and at the times `breaks`. */
export function curvePath(columns: Column[], x: (at: number) => number, y: (value: number) => number,
                          breaks: Set<number>): string {
  let path = "", isOpen = false;
  for (const { at, least, greatest } of columns) {
    if (!Number.isFinite(least) || !Number.isFinite(greatest)) {
      isOpen = false;
      continue;
    }
    const place = x(at).toFixed(1);
    path += isOpen && !breaks.has(at) ? `H${place}V${y(least).toFixed(1)}` : `M${place} ${y(least).toFixed(1)}h0`;
    if (greatest !== least) path += `V${y(greatest).toFixed(1)}`;
    isOpen = true;
  }
  return path;
}
