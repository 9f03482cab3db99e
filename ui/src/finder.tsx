// SPDX-License-Identifier: Apache-2.0
// Anything by name (Ctrl-K), and the list of keys (?).
import { useEffect, useRef, useState } from "react";
import { ACTS } from "./acts";
import { onEscape, Table } from "./controls";
import type { MachineName } from "./protocol";
import { choose, showVariable, view } from "./view";

/** Of what runs, or of the draft. */
export interface Names { tasks: string[]; variables: string[] }

interface Found { kind: string; name: string; go: () => void }

/** What `words` may mean: a name that begins with them comes first. */
export function found(words: string, names: Names, machines: MachineName[]): Found[] {
  const all: Found[] = [
    ...names.tasks.map((name) => ({ kind: "task", name, go: () => choose([name]) })),
    ...names.variables.map((name) => ({ kind: "variable", name, go: () => showVariable(name) })),
    ...machines.map((m) => ({ kind: "subsystem", name: m.name, go: () => view.set({ machine: m.name, chosen: [] }) })),
  ];
  const wanted = words.toLowerCase();
  const rank = (one: Found) => (one.name.toLowerCase().startsWith(wanted) ? 0 : 1);
  return all.filter((one) => `${one.name} ${one.kind}`.toLowerCase().includes(wanted))
    .sort((a, b) => rank(a) - rank(b)).slice(0, 20);
}

export function Finder({ names, machines }: { names: Names; machines: MachineName[] }) {
  const [words, type] = useState("");
  const [at, setAt] = useState(0);
  const input = useRef<HTMLInputElement>(null);
  useEffect(() => input.current?.focus(), []);
  const list = found(words, names, machines);
  const close = () => view.set({ isFinding: false });
  const take = (one: Found | undefined) => { close(); one?.go(); };
  return (
    <div className="question finder" role="dialog" aria-label="Find">
      <input ref={input} value={words} role="combobox" aria-label="Name of a task, variable or subsystem"
             aria-expanded="true" aria-controls="found" aria-activedescendant={list[at] ? `found-${at}` : undefined}
             onChange={(event) => { type(event.target.value); setAt(0); }}
             onKeyDown={(event) => {
               if (event.key === "Escape") close();
               if (event.key === "Enter") take(list[at]);
               if (event.key === "ArrowDown") setAt(Math.min(at + 1, list.length - 1));
               if (event.key === "ArrowUp") setAt(Math.max(at - 1, 0));
             }} />
      <ul id="found" role="listbox" aria-label="Found">
        {list.map((one, i) => (
          <li key={one.kind + one.name} id={`found-${i}`} role="option" aria-selected={i === at}
              onClick={() => take(one)}>
            {one.name} <span className="soft">{one.kind}</span></li>))}
      </ul>
      {list.length === 0 && <p className="hint">Nothing has that name.</p>}
    </div>
  );
}

const KEYS: [string, string][] = [
  ["Tab, arrows", "reach the picture; go from box to box, left and right along the lines"],
  ["Enter, Space", "choose the box; with Shift or Ctrl several"], ["Ctrl-A in the picture", "choose all tasks"],
  ["Escape", "choose nothing; close a question"],
  ...ACTS.map((act): [string, string] => [act.key, `${act.name} the chosen tasks: ${act.help}`]),
  ["F2", "Assemble: rename the chosen task or variable"], ["n", "Assemble: add a task"],
  ["F8", "Assemble: to the next fault and its first remedy"],
  ["Delete", "Assemble: remove the chosen task"], ["Ctrl-Z, Ctrl-Y", "Assemble: undo an act, and do it again"],
  ["Ctrl-S", "Assemble: save the draft to FILE"], ["t", "Assemble: try the draft in virtual time"],
  ["s", "Assemble: the steps of the sequence"],
  ["s", "Look: the scope"], ["Enter, Escape in a field", "Assemble: carry the act out; restore"],
  ["w", "why: where the values of the chosen task come from"], ["Shift-F", "raise the FLAG, at once"],
  ["Ctrl-K", "find anything by name"], ["/", "the library: search by word, port, unit, paper"],
  ["+ - 0", "zoom of the picture; 0 fits it"], ["?", "this list"],
];

export function Help() {
  const button = useRef<HTMLButtonElement>(null);
  useEffect(() => button.current?.focus(), []);
  const close = () => view.set({ isHelping: false });
  return (
    <div className="question help" role="dialog" aria-label="Keys"
         onKeyDown={onEscape(close)}>
      <Table label="Keys" heading={["key", "what it does"]} rows={KEYS} />
      <p className="hint">A key acts on the chosen tasks while no field is being typed into.</p>
      <button ref={button} type="button" onClick={close}>Close</button>
    </div>
  );
}
