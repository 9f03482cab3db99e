// SPDX-License-Identifier: Apache-2.0
// The steps of a draft that can be undone: each is the whole text before an act. No function here knows the browser.
export interface History {
  past: string[];
  future: string[];
}

export type Step = "act" | "undo" | "redo";

const MOST_STEPS = 200;

/** The steps after the text `before` became `after`. */
export function stepped(history: History, step: Step, before: string, after: string): History {
  const { past, future } = history;
  if (step === "undo") return { past: past.slice(0, -1), future: [before, ...future] };
  if (step === "redo") return { past: [...past, before], future: future.slice(1) };
  return before === after ? history : { past: [...past, before].slice(-MOST_STEPS), future: [] };
}
