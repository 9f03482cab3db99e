// SPDX-License-Identifier: Apache-2.0
// The key `sequence` of a draft: acts on its steps, words for `until`, and how a step's configuration is reached.
// No function here knows the browser.
import { quoted, valueActs } from "./edits";
import type { EditAct, Modes, Outline, OutlineVariable, Sequence, Step, Transition } from "./protocol";
import { nameOf } from "./step_tile";
import { membersAt } from "./text_places";

export const MOST_STEPS = 16;

const KEYS = ["name", "switch", "until", "for", "within", "else", "confirm", "reentry"] as const;
export type StepKey = typeof KEYS[number];

/** What the text gives the key; null: nothing. */
function wordsIn(step: Step, key: StepKey): string | null {
  const value = step[key];
  return typeof value === "boolean" ? (value ? "true" : null) : value;
}

const act = (sequence: Sequence, i: number, key: StepKey, words: string | null): EditAct[] =>
  valueActs(`${sequence.path}/${i}/${key}`, quoted(words ?? ""), wordsIn(sequence.steps[i]!, key) !== null);

/** Gives a key of step `i` a value; no words: takes the key out. Each `else` follows a step that gets another name. */
export function keyActs(sequence: Sequence, i: number, key: StepKey, words: string): EditAct[] {
  const { steps } = sequence, step = steps[i]!;
  const [before, after] = [nameOf(step), nameOf({ ...step, [key]: words || null })];
  const isFollowed = before !== after && steps.filter((one) => nameOf(one) === before).length === 1;
  return [...act(sequence, i, key, words), ...steps.flatMap((one, k) => (
    isFollowed && one.else === before ? act(sequence, k, "else", after) : []))];
}

/** Lets two steps change places, key by key: what the steps share stays as it is written. */
export function swapActs(sequence: Sequence, i: number, k: number): EditAct[] {
  const put = (at: number, from: number) => KEYS.flatMap((key) => {
    const words = wordsIn(sequence.steps[from]!, key);
    return words === wordsIn(sequence.steps[at]!, key) ? [] : act(sequence, at, key, words);
  });
  const acts = [...put(i, k), ...put(k, i)];
  return [...acts.filter((one) => one.act === "set"), ...acts.filter((one) => one.act === "remove")];
}

/** One more step; `sequence` null: with the key. */
export function addedStep(sequence: Sequence | null, configuration: string): EditAct[] {
  const value = `{switch: ${configuration}}`, path = sequence?.path ?? "sequence", n = sequence?.steps.length ?? 0;
  return [{ act: "set", ...(n === 0 ? { path, value: `[${value}]` } : { path: `${path}/${n}`, value }) }];
}

/** Takes step `i` out, the last one with the key. */
export const removedStep = (sequence: Sequence, i: number): EditAct[] =>
  [{ act: "remove", path: sequence.steps.length === 1 ? "sequence" : `${sequence.path}/${i}` }];

const written = (step: Step): string => `{${KEYS.flatMap((key) => {
  const words = wordsIn(step, key);
  return words === null ? [] : [`${key}: ${quoted(words)}`];
}).join(", ")}}`;

/** The list alone becomes a map with `steps`, because only a map has `repeat`. */
export function repeatActs(text: string, sequence: Sequence, isOn: boolean): EditAct[] {
  if (!isOn) return [{ act: "remove", path: "sequence/repeat" }];
  if (sequence.path !== "sequence") return [{ act: "set", path: "sequence/repeat", value: "true" }];
  const steps = membersAt(text, "sequence")?.members ?? sequence.steps.map(written);
  return [{ act: "remove", path: "sequence" },
    { act: "set", path: "sequence", value: `{repeat: true, steps: [${steps.join(", ")}]}` }];
}

// ---- words for `until`

const RELATIONS = [">=", "<=", "==", "!=", ">", "<"];
const UNITS = ["rad deg mrad rev", "m mm cm um km", "s ms us min", "rad/s deg/s rev/s", "m/s mm/s km/h", "N mN kN",
  "N.m mN.m kN.m", "V mV", "A mA", "kg g", "W kW"].map((group) => group.split(" "));

/** The unit, then others of its dimension as far as the page knows some. */
export const unitsLike = (unit: string): string[] =>
  [unit, ...(UNITS.find((group) => group.includes(unit)) ?? []).filter((one) => one !== unit)];

/** A number as it is, a vector by its elements; a text, a structure, a matrix: none can be compared. */
function comparable({ variable, type, shape }: OutlineVariable): string[] {
  const lengths = [...shape.matchAll(/\d+/g)].map(Number);
  if (["string", "struct"].includes(type) || lengths.length > 1) return [];
  return shape === "" ? [variable] : Array.from({ length: lengths[0] ?? 1 }, (_, i) => `${variable}[${i}]`);
}

/** What may follow the typed words of `until`: a variable that the configuration produces, a relation, a value. */
export function untilWords(outline: Outline, configuration: string | null, typed: string): string[] {
  const tasks = outline.configurations.find((one) => one.configuration === configuration)?.tasks ?? [];
  const known = outline.variables.filter((one) => !one.constant && (one.origin === "operator" ||
    one.producers.some(({ task }) => task !== "sequence" && tasks.includes(task))));
  const [, name = "", relation, value = ""] = /^\s*([^\s<>=!]*)\s*(?:([<>=!]=?)\s*(.*))?$/.exec(typed) ?? [];
  const of = known.find((one) => comparable(one).includes(name));
  if (!of) return relation ? [] : known.flatMap(comparable).map((one) => `${one} `);
  const isTruth = of.type === "bool";
  if (!relation) return RELATIONS.slice(...(isTruth ? [2, 4] : [])).map((one) => `${name} ${one} `);
  const head = value === "" ? `${typed.trimEnd()} ` : typed.slice(0, -value.length);
  if (isTruth) return [`${head}true`, `${head}false`];
  const number = /^[-+]?[\d.]+(e[-+]?\d+)?/i.exec(value)?.[0] ?? "0";
  return unitsLike(of.unit).map((unit) => `${head}${number}${unit === "1" ? "" : ` ${unit}`}`);
}

// ---- edges

export interface Edge { look: "fast" | "slow" | "open" | "none"; word: string; why: string }

const slow = ({ constants, resources, initialised_anew: anew }: Transition): string => [
  ...constants.map((one) => `constant ${one.constant} comes from ${one.after} instead of ${one.before}`),
  ...resources.map((one) => `resource ${one.resource} goes from ${one.before} to ${one.after}`),
  anew.length > 0 && `initialised anew: ${anew.join(", ")}`].filter(Boolean).join("; ");

/** The switch from one configuration to another. `modes`: of this draft; null: not known. */
export function edgeOf(modes: Modes | null, from: string | null, to: string | null): Edge {
  if (from === to) return { look: "none", word: "no switch", why: "both steps have this configuration" };
  if (!modes) return { look: "none", word: "not judged", why: "switches are judged when the draft is legal" };
  const way = modes.transitions.find((one) => one.from === from && one.to === to);
  if (!way) return { look: "open", word: "refused", why: `no switch leads from ${from} to ${to}` };
  const isLate = way.cpus.some((one) => one.schedulable === "no");
  const deadlines = way.cpus.filter((one) => one.schedulable !== "yes").map(({ cpu, task, schedulable }) => (
    schedulable === "no" ? `${task} may miss its deadline on cpu${cpu}`
      : schedulable === "not-stated" ? `${task} has no budget: deadlines not judged`
      : `deadlines on cpu${cpu} were not decided`)).join("; ");
  if (way.way !== "slow" && isLate) return { look: "open", word: "not schedulable", why: deadlines };
  if (way.way === "fast") return { look: "fast", word: "fast", why: deadlines || "the tasks cycle on" };
  const why = [slow(way), deadlines].filter(Boolean).join("; ") || "tasks leave before others arrive, under the flag";
  return { look: "slow", why, word: way.way === "slow-unless-same" ? "slow unless the constants keep their values"
    : "slow" };
}
