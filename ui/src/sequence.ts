// SPDX-License-Identifier: Apache-2.0
// The state of a sequence that runs as words: docs/formats/sequence.md. No function here knows the browser.
import type { Reading, Sequence, Step } from "./protocol";

/** Values of `sequence_state`, in their order. */
export const STATES = ["paused", "switches", "runs", "waits for Go", "interrupted", "failed", "done", "begins"];
export const PAUSED = 0, SWITCHES = 1, RUNS = 2, INTERRUPTED = 4, FAILED = 5, DONE = 6;

/** Most time for a switch, in nanoseconds, if the step gives none. */
const SWITCH_NS = 10e9;
const TIMES: Record<string, number> = { ns: 1, us: 1e3, ms: 1e6, s: 1e9, min: 60e9, h: 3600e9 };

/** A time as a description writes it, "40 us", in nanoseconds. */
export function nanoseconds(text: string | null): number | null {
  const match = /^([\d.]+(?:[eE][-+]?\d+)?) ?(ns|us|ms|s|min|h)$/.exec(text ?? "");
  return match ? Number(match[1]) * TIMES[match[2]!]! : null;
}

/** How long the present step, or its switch, takes at most. */
export const limitOf = (step: Step, state: number): number | null =>
  state === RUNS ? nanoseconds(step.for ?? step.within) : state === SWITCHES ? nanoseconds(step.within) ?? SWITCH_NS
    : null;

export interface Condition { variable: string; element: number | null; level: string }

/** The parts of `until`, as chimera/description/condition_text.cc reads them. */
export function conditionOf(until: string | null): Condition | null {
  const match = /^\s*([^\s<>=![]+)\s*(?:\[\s*(\d+)\s*\])?\s*(?:[<>]=?|[=!]=)\s*(.+?)\s*$/.exec(until ?? "");
  return match ? { variable: match[1]!, element: match[2] === undefined ? null : Number(match[2]), level: match[3]! }
    : null;
}

/** What a page reads of a sequence, however large its variables are. */
export const variablesOf = (sequence: Sequence | null | undefined): string[] => (!sequence ? []
  : ["sequence_step", "sequence_state", "sequence_waited",
    ...sequence.steps.flatMap((step) => conditionOf(step.until)?.variable ?? [])]);

const PREFIXES: Record<string, number> = { n: 1e-9, u: 1e-6, m: 1e-3, c: 1e-2, k: 1e3, M: 1e6 };

/** What one `wanted` is in the unit `has`; 0: not known here. */
function factor(wanted: string, has: string): number {
  if (wanted === has) return 1;
  if (wanted.includes("deg") && wanted.replace("deg", "rad") === has) return Math.PI / 180;
  return wanted.slice(1) === has ? PREFIXES[wanted[0]!] ?? 0 : 0;
}

/** The present value of a condition, in the unit of the condition, with digits enough to tell it from the limit. */
export function valueOf({ element, level }: Condition, reading: Reading): string {
  const value = element === null ? reading.value : (reading.value as unknown[] | null)?.flat(9)[element];
  if (value === null || value === undefined) return "never published";
  if (typeof value !== "number") return String(value);
  const wanted = /[^\d.]\S*$/.exec(level)?.[0]?.trim() ?? "";
  const times = factor(wanted, reading.unit);
  const number = value / (times || 1), unit = times === 0 ? reading.unit : wanted;
  const size = Math.max(Math.abs(number), Math.abs(parseFloat(level)) || 0);
  const digits = size === 0 ? 0 : Math.max(0, Math.min(20, 4 - Math.floor(Math.log10(size))));
  return `${Number(number.toFixed(digits))}${unit === "1" || unit === "" ? "" : ` ${unit}`}`;
}

/** The steps with which a sequence may go on after an error. */
export function mayGoOn({ steps }: Sequence): string {
  const numbers = steps.filter((step) => step.reentry).map((step) => step.number);
  return numbers.length === 0 ? "no step allows reentry" : `may go on with step ${numbers.join(", ")}`;
}

/** The state in words. */
export const stateWords = (sequence: Sequence, state: number): string =>
  state === INTERRUPTED ? `interrupted: ${mayGoOn(sequence)}` : STATES[state] ?? "…";

/** The step that Go begins: at the end the first one. */
export const goStep = (number: number, state: number): number => (state === DONE ? 1 : Math.max(1, number));
