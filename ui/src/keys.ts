// SPDX-License-Identifier: Apache-2.0
// Keys of the whole page.
import { ACTS } from "./acts";
import { raiseFlag } from "./header";
import { begin } from "./inspector";
import type { Machine } from "./machine";
import { choose, view, zoomBy } from "./view";

function isTypedInto(target: EventTarget | null): boolean {
  return target instanceof HTMLElement &&
    target.matches("input:not([type=checkbox]):not([type=range]), textarea, select");
}

/** The keys with Ctrl: true if the key was one of them. */
function withControl(event: KeyboardEvent, machine: Machine | null): boolean {
  if (event.key.toLowerCase() === "k") view.set({ isFinding: true });
  else if (event.key.toLowerCase() === "a" && machine && !isTypedInto(event.target))
    choose((machine.state.get().status?.tasks ?? []).map((task) => task.task));
  else return false;
  return true;
}

export function takeKey(event: KeyboardEvent, machine: Machine | null, fit: () => void): void {
  if (event.defaultPrevented || event.altKey || event.metaKey) return;
  if (event.ctrlKey) {
    if (withControl(event, machine)) event.preventDefault();
    return;
  }
  if (isTypedInto(event.target)) return;
  const { chosen, question } = view.get();
  if (event.key === "F" && event.shiftKey && machine) return raiseFlag(machine, true);
  if (question) return;
  const act = ACTS.find((one) => one.key === event.key);
  if (act && machine && chosen.length > 0) begin(machine, act, chosen);
  else if (event.key === "w") view.set({ panel: "why", variable: "" });
  else if (event.key === "/") view.set({ isFinding: true });
  else if (event.key === "?") view.set({ isHelping: true });
  else if (event.key === "Escape") view.set({ chosen: [], variable: "", isFinding: false, isHelping: false });
  else if (event.key === "+") zoomBy(1.2);
  else if (event.key === "-") zoomBy(1 / 1.2);
  else if (event.key === "0") fit();
  else return;
  event.preventDefault();
}
