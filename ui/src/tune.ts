// SPDX-License-Identifier: Apache-2.0
// Present values of operator variables as edits of the draft. No function here knows the browser.
import { quoted } from "./edits";
import type { Outline } from "./protocol";

interface SetAct { act: "set"; path: string; value: string }

/** "[100 90] N.m/rad" as a description writes it: "[100 N.m/rad, 90 N.m/rad]". */
export function writtenValue(text: string): string {
  const list = /^\[(.*)\](?: (\S.*))?$/.exec(text);
  if (!list) return quoted(text);
  const unit = list[2] === undefined ? "" : ` ${list[2]}`;
  return `[${list[1]!.split(/[\s,]+/).map((number) => number + unit).join(", ")}]`;
}

/** An act for each operator variable of the draft whose text is another one. */
export function tuneActs(outline: Outline, present: Map<string, string>): SetAct[] {
  return outline.variables.flatMap(({ variable, origin, value }): SetAct[] => {
    const text = origin === "operator" ? present.get(variable) : undefined;
    const written = text === undefined ? value : writtenValue(text);
    return written === value || written === null ? [] : [{ act: "set", path: `operator/${variable}`, value: written }];
  });
}
