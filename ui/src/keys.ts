// SPDX-License-Identifier: Apache-2.0
// Keys of the whole page.
import { ACTS } from "./acts";
import { draft } from "./draft";
import { removedTask } from "./edits";
import { focusNextFault } from "./fault_list";
import { raiseFlag } from "./header";
import { begin } from "./inspector";
import type { Machine } from "./machine";
import { go } from "./place";
import { openSteps } from "./steps_panel";
import { undoKey } from "./text_panel";
import { tryDraft } from "./trial";
import { choose, view, zoomBy } from "./view";

function isTypedInto(target: EventTarget | null): boolean {
  return target instanceof HTMLElement &&
    target.matches("input:not([type=checkbox]):not([type=range]), textarea, select");
}

type Keys = (event: KeyboardEvent, machine: Machine | null) => boolean;

/** Keys of the mode Look: acts on the chosen tasks. */
export const lookKeys: Keys = (event, machine) => {
  const { chosen } = view.get();
  if (event.ctrlKey) {
    if (event.key.toLowerCase() !== "a" || !machine || isTypedInto(event.target)) return false;
    choose((machine.state.get().status?.tasks ?? []).map((task) => task.task));
    return true;
  }
  const act = ACTS.find((one) => one.key === event.key);
  if (act && machine && chosen.length > 0) begin(machine, act, chosen);
  else if (event.key === "w") view.set({ panel: "why", variable: "" });
  else if (event.key === "s") view.set({ panel: "scope" });
  else return false;
  return true;
};

/** Keys of the mode Assemble: acts on the draft. */
export const assembleKeys: Keys = (event) => {
  const step = undoKey(event);
  if (event.ctrlKey) {
    const isTyping = isTypedInto(event.target) && (event.target as Element).matches(".edited, form input");
    if (step && !isTyping) void draft.undo(step);
    else if (event.key.toLowerCase() === "s") save();
    else return false;
    return true;
  }
  const { outline, draft: now } = draft.state.get();
  const [task] = view.get().chosen;
  if (event.key === "F2") document.querySelector<HTMLInputElement>("aside input[data-rename]")?.select();
  else if (event.key === "n") addTask();
  else if (event.key === "F8") focusNextFault();
  else if (event.key === "t") void tryDraft();
  else if (event.key === "s") openSteps();
  else if (event.key === "Delete" && outline?.tasks.some((one) => one.task === task))
    void draft.press(removedTask(now?.analysis.text ?? "", outline, task!));
  else return false;
  return true;
};

/** What is typed in a field belongs to what is saved. */
function save(): void {
  const field = document.activeElement as HTMLElement | null;
  field?.blur();
  draft.write();
  field?.focus();
}

export function addTask(): void {
  choose([]);
  window.setTimeout(() => document.getElementById("add-task-component")?.focus(), 0);  // when its form is there
}

export function takeKey(event: KeyboardEvent, machine: Machine | null, fit: () => void, ofMode: Keys): void {
  if (event.defaultPrevented || event.altKey || event.metaKey) return;
  const { question } = view.get();
  if (event.ctrlKey) {
    if (event.key.toLowerCase() === "k") view.set({ isFinding: true });
    else if (question || !ofMode(event, machine)) return;
    return event.preventDefault();
  }
  if (isTypedInto(event.target)) return;
  if (event.key === "F" && event.shiftKey && machine) return raiseFlag(machine, true);
  if (question) return;
  if (event.key === "/") go({ doc: "library", at: "" });
  else if (event.key === "?") view.set({ isHelping: true });
  else if (event.key === "Escape") view.set({ chosen: [], variable: "", isFinding: false, isHelping: false });
  else if (event.key === "+") zoomBy(1.2);
  else if (event.key === "-") zoomBy(1 / 1.2);
  else if (event.key === "0") fit();
  else if (!ofMode(event, machine)) return;
  event.preventDefault();
}
