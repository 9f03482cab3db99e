// SPDX-License-Identifier: Apache-2.0
// Where the page is: the subsystem, the chosen tasks, the open panel. Kept by the browser, so that a new link, or the
// page loaded again, goes on where it was.
import type { Question } from "./acts";
import { Store } from "./store";

export type Panel = "events" | "steps" | "receipts" | "profile" | "why" | "scope" | "timeline";

export type Mode = "look" | "assemble";

export interface View {
  /** That a person chose; "": the page shows what runs, or else the draft. */
  mode: Mode | "";
  machine: string;
  /** Process of the chimera-web whose link was opened last: a page that is loaded again has the same one. */
  bench: number;
  chosen: string[];
  variable: string;
  panel: Panel;
  zoom: number;
  question: Question | null;
  isFinding: boolean;
  isHelping: boolean;
  areStepsOpen: boolean;
}

const KEPT: (keyof View)[] = ["mode", "machine", "bench", "chosen", "variable", "panel", "zoom"];
const NAME = "chimera";

function kept(): Partial<View> {
  try {
    return JSON.parse(localStorage.getItem(NAME) ?? "{}") as Partial<View>;
  } catch {
    return {};  // a browser that keeps nothing, or what another version kept
  }
}

export const view = new Store<View>({
  mode: "", machine: "", bench: 0,
  chosen: [], variable: "", panel: "events", zoom: 1, ...kept(), question: null, isFinding: false,
  isHelping: false, areStepsOpen: false,
});

view.subscribe(() => {
  const now = view.get();
  try {
    localStorage.setItem(NAME, JSON.stringify(Object.fromEntries(KEPT.map((key) => [key, now[key]]))));
  } catch {
    // a browser that keeps nothing
  }
});

export const choose = (chosen: string[]): void => view.set({ chosen, variable: "" });
export const showVariable = (variable: string): void => view.set({ variable, panel: "why" });
export const ask = (question: Question | null): void => view.set({ question });
export const zoomBy = (factor: number): void =>
  view.set({ zoom: Math.min(4, Math.max(0.2, view.get().zoom * factor)) });
