// SPDX-License-Identifier: Apache-2.0
// The scheduling records of the last seconds, as rows of a timeline. No function here knows the browser.
import type { TapNote } from "./protocol";

export interface TapRecord { at: number; kind: string; task: string | null; a: number; b: number }
export interface TimelineRow {
  rtpu: string; task: string;
  /** Spans of pixels in which the task ran, and pixels of marks. */
  runs: [number, number][]; releases: number[]; preempts: number[]; misses: number[];
}
/** A job that ended late, or releases that never ran (`dropped`). `had`: shares of the processor, the greatest first:
 *  from the release of the job to its end, or from the release before the dropped ones to the next one. */
export interface Miss {
  at: number; rtpu: string; task: string; late: number; dropped: number; had: { task: string; ns: number }[];
}

const SECOND = 1e9, SECONDS = 10;
export const MOST_PER_SECOND = 20_000, MOST_MISSES = 20;

export class TapRecords {
  lost = 0;
  latest = 0;
  private all = new Map<string, TapRecord[]>();

  add(note: TapNote): void {
    this.lost += note.lost;
    const records = this.all.get(note.rtpu) ?? [];
    this.all.set(note.rtpu, records);
    for (const [at, kind, task, a, b] of note.records ?? []) {
      records.push({ at, kind, task, a, b });
      this.latest = Math.max(this.latest, at);
    }
  }

  /** Nanoseconds that are kept: one second of more than MOST_PER_SECOND records. Forgets the others. */
  keep(): number {
    const since = this.latest - SECOND;
    let recent = 0;
    for (const records of this.all.values())
      for (let i = records.length - 1; i >= 0 && records[i]!.at >= since; --i) ++recent;
    const span = recent > MOST_PER_SECOND ? SECOND : SECONDS * SECOND;
    for (const [rtpu, records] of this.all) {
      const first = records.findIndex((one) => one.at >= this.latest - span);
      if (first !== 0) this.all.set(rtpu, first < 0 ? [] : records.slice(first));
    }
    return span;
  }

  /** A row for each task, in pixels from 0 to `width`. */
  rows(span: number, width: number): TimelineRow[] {
    const from = this.latest - span;
    const place = (at: number) => Math.max(0, Math.min(width, Math.floor(((at - from) / span) * width)));
    const rows = new Map<string, TimelineRow>();
    const mark = (marks: number[], at: number) => { if (marks[marks.length - 1] !== place(at)) marks.push(place(at)); };
    for (const [rtpu, records] of this.all)
      for (const { at, kind, task, b } of records) {
        if (task === null) continue;
        const key = `${rtpu} ${task}`;
        const row = rows.get(key) ?? { rtpu, task, runs: [], releases: [], preempts: [], misses: [] };
        rows.set(key, row);
        if (kind === "release") mark(row.releases, at);
        else if (kind === "preempt") mark(row.preempts, at);
        else if (kind === "miss" || kind === "drop") mark(row.misses, at);
        else if (kind === "run") {
          const begin = place(at), end = Math.max(begin + 1, place(at + b)), last = row.runs[row.runs.length - 1];
          if (last && begin <= last[1]) last[1] = Math.max(last[1], end);
          else row.runs.push([begin, end]);
        }
      }
    return [...rows.values()].sort((x, y) => x.rtpu.localeCompare(y.rtpu) || x.task.localeCompare(y.task));
  }

  /** The last misses, newest first. `sharers`: the rtpus on the CPU of an rtpu, which have its processor too. */
  misses(sharers: (rtpu: string) => string[]): Miss[] {
    const found: { at: number; rtpu: string; index: number }[] = [];
    for (const [rtpu, records] of this.all)
      records.forEach(({ at, kind, task }, index) => {
        if ((kind === "miss" || kind === "drop") && task !== null) found.push({ at, rtpu, index });
      });
    return found.sort((x, y) => y.at - x.at).slice(0, MOST_MISSES)
      .map(({ rtpu, index }) => this.missOf(rtpu, index, sharers(rtpu)));
  }

  private missOf(rtpu: string, index: number, sharers: string[]): Miss {
    const records = this.all.get(rtpu)!, { at, a, b: late, kind } = records[index]!;
    const task = records[index]!.task!, isDrop = kind === "drop";
    const isRelease = (one: TapRecord) => one.kind === "release" && one.task === task;
    let from = at - late;
    for (let i = index; i >= 0; --i) {
      const one = records[i]!;
      if (!isRelease(one) || (isDrop ? one.at >= at : one.a !== a)) continue;
      from = one.at;
      break;
    }
    const next = isDrop ? records.find((one, i) => i > index && isRelease(one) && one.at > at) : undefined;
    const until = isDrop ? next?.at ?? this.latest : at;
    const had = new Map<string, number>();
    for (const other of new Set([rtpu, ...sharers]))
      for (const one of this.all.get(other) ?? []) {
        const ns = Math.min(until, one.at + one.b) - Math.max(from, one.at);
        if (one.kind !== "run" || one.task === null || ns <= 0) continue;
        const name = other === rtpu ? one.task : `${one.task} of ${other}`;
        had.set(name, (had.get(name) ?? 0) + ns);
      }
    return { at, rtpu, task, late, dropped: isDrop ? a : 0,
      had: [...had].map(([name, ns]) => ({ task: name, ns })).sort((x, y) => y.ns - x.ns) };
  }
}

/** Who had the processor: "busy 8ms, pid itself 1ms". */
export const blame = ({ task, had }: Miss, words: (ns: number) => string): string =>
  had.length === 0 ? "no task of this CPU ran: the processor was with other programs"
    : had.map((one) => `${one.task}${one.task === task ? " itself" : ""} ${words(one.ns)}`).join(", ");
