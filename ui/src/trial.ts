// SPDX-License-Identifier: Apache-2.0
// Trials of the bench (docs/formats/web.md, "Trials"): one is started, asked after, halted; and the try of the draft.
import { door } from "./bench";
import { Refusal } from "./door";
import { draft, sentenceOf } from "./draft";
import { againstRefusal } from "./lesson_values";
import { offered } from "./offered_values";
import type { Offer, RunAnswer, TrialResult } from "./protocol";
import { Store } from "./store";
import { readTable, REFERENCE, Table } from "./table";
import { ask } from "./view";

const ASK_MS = 200;

/** The words of a command that refused. */
export function refusalOf({ output, error }: TrialResult): string {
  if (typeof output === "string") return output.trim() || (error ?? "").trim();
  const { error: refused, faults } = (output ?? {}) as RunAnswer;
  const fault = faults?.find((one) => one.severity === "error");
  return refused?.message ?? (fault ? `line ${fault.line}: ${fault.message}` : (error ?? "").trim());
}

/** Starts a trial and asks until it has ended; `told` gets each answer. */
export async function follow(method: "try" | "scope", parameters: object,
                             told: (result: TrialResult) => void): Promise<TrialResult> {
  const { number } = await door.call(method, parameters);
  for (;;) {
    const result: TrialResult = await door.call("result", { number });
    told(result);
    if (result.ended !== null) return result;
    await new Promise((resolve) => window.setTimeout(resolve, ASK_MS));
  }
}

export const halt = (number: number): Promise<unknown> => door.call("halt", { number }).catch(() => undefined);

export interface TryState {
  isOpen: boolean;
  duration: string;
  /** Chosen by a person; none: the page chooses. */
  watch: string[];
  at: string[];
  expect: string[];
  /** The trial under way; null: none. */
  running: TrialResult | null;
  isBusy: boolean;
  result: TrialResult | null;
  /** Version of the draft that `result` tried. */
  version: number;
  table: Table | null;
  before: Table | null;
  message: string;
  /** Values for what `message` names. */
  offers: Offer[];
}

export const MOST_WATCHED = 32, FIRST_WATCHED = 6;

export const tried = new Store<TryState>({
  isOpen: false, duration: "2 s", watch: [], at: [], expect: [], running: null, isBusy: false, result: null, version: 0,
  table: null, before: null, message: "", offers: [],
});

/** While a person chooses none: a pair as q and q_ref, else what tasks produce, numbers first. */
export function firstWatched(): string[] {
  const produced = (draft.state.get().outline?.variables ?? [])
    .filter((one) => !one.constant && one.producers.length > 0);
  const followed = produced.find(({ variable }) => produced.some((one) => one.variable === variable + REFERENCE));
  if (followed) return [followed.variable, followed.variable + REFERENCE];
  const rank = ({ type, shape }: { type: string; shape: string }) => (type === "bool" ? 2 : shape === "" ? 0 : 1);
  return produced.sort((a, b) => rank(a) - rank(b)).slice(0, FIRST_WATCHED).map((one) => one.variable);
}

function take(result: TrialResult): void {
  const { table, result: last } = tried.get(), { outline } = draft.state.get();
  const latest = result.csv === null ? null : readTable(result.csv);
  const words = latest || (result.ended as { code?: number } | null)?.code === 0 ? "" : refusalOf(result);
  const where = (result.output as RunAnswer | null)?.error?.where ?? "";
  const isTask = words !== "" && (outline?.tasks ?? []).some((one) => one.task === where);
  tried.set({ running: null, isBusy: false, result, table: latest, before: last ? table : null,
    message: isTask ? `${where}: ${words}` : words, offers: [] });
  if (isTask)
    void againstRefusal(outline, where, words, (port) => offered(port).catch(() => []))
      .then((offers) => { if (tried.get().result === result) tried.set({ offers }); });
}

/** Opens the panel and tries the draft. */
export async function tryDraft(devices = false): Promise<void> {
  if (tried.get().isBusy) return;
  const version = draft.state.get().draft?.version;
  const known = new Set(draft.state.get().outline?.variables.map((one) => one.variable));
  const { duration, at, expect, watch: wanted } = tried.get();
  const strange = wanted.filter((name) => !known.has(name));
  const watch = wanted.length > 0 ? wanted : firstWatched();
  const message = strange.length > 0 ? `the draft has no variable ${strange.join(", ")}: take it away`
    : watch.length === 0 ? "no task of the draft produces a variable" : "";
  tried.set({ isOpen: true, offers: [], message });
  if (message !== "" || version === undefined) return;
  tried.set({ isBusy: true, version });
  try {
    take(await follow("try", { version, duration, watch, at, expect, devices }, (running) => tried.set({ running })));
  } catch (why) {
    tried.set({ isBusy: false, running: null });
    const resources = why instanceof Refusal ? why.error.data?.resources : undefined;
    if (!resources) return tried.set({ message: sentenceOf(why) });
    ask({ title: "Open these in a try?", button: "Open and try", carryOut: () => void tryDraft(true),
      text: "Virtual time opens what resources name, devices too: " +
        resources.map((one) => `${one.task}.${one.port} ${one.text}`).join(", ") + "." });
  }
}
