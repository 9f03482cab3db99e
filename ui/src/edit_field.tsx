// SPDX-License-Identifier: Apache-2.0
// Fields of the draft. Enter, or leaving the field, carries one act out; Escape restores. A refused act shows its
// sentence at the field, and the typed words stay.
import { useEffect, useRef, useState } from "react";
import { onEscape } from "./controls";
import { showVariable } from "./view";

interface Props {
  label: string;
  /** What a screen reader says: the label and what it belongs to. */
  name: string;
  present: string;
  /** The attribute that tests and `focusField` find it by. */
  mark: [attribute: "field" | "link" | "rename", value: string];
  /** Why it cannot be changed; "": it can. */
  why: string;
  commit: (words: string) => Promise<string>;
  placeholder?: string;
  note?: string;
  title?: string;
  list?: string;
  /** In place of `list`: words that may follow the typed ones. */
  complete?: (typed: string) => string[];
}

const idOf = (mark: Props["mark"]) => mark.join("-").replace(/\s/g, "~");

export function EditField(
  { label, name, present, mark, why, commit, placeholder, note = "", title = "", list, complete }: Props) {
  const [typed, type] = useState<string | null>(null);
  const [refusal, refuse] = useState("");
  const sent = useRef<string | null>(null);
  const restore = () => { type(null); refuse(""); sent.current = null; };
  const send = async (isAgain: boolean) => {
    if (typed === null || (!isAgain && sent.current === typed)) return;
    if (typed.trim() === present) return restore();
    sent.current = typed;
    const sentence = await commit(typed.trim());
    refuse(sentence);
    if (sentence === "") type((now) => (now === sent.current ? null : now));
    if (sentence === "") sent.current = null;
  };
  const id = idOf(mark);
  return (
    <div className="field line">
      <label htmlFor={id}>{label}{note !== "" && <span className="unit"> {note}</span>}</label>
      <input id={id} {...{ [`data-${mark[0]}`]: mark[1] }} value={typed ?? present} placeholder={placeholder}
             aria-label={name} title={why || title || "Enter sets it"} readOnly={why !== ""}
             list={complete ? `${id}-words` : list}
             spellCheck={false} autoComplete="off"
             aria-invalid={refusal !== "" || undefined} aria-describedby={refusal !== "" ? `${id}-why` : undefined}
             className={typed === null || typed === present ? "" : "edited"}
             onChange={(event) => { if (why === "") type(event.target.value); }}
             onBlur={() => void send(false)}
             onKeyDown={(event) => {
               if (event.key === "Enter") void send(true);
               onEscape(restore)(event);
             }} />
      {complete && <datalist id={`${id}-words`}>{complete(typed ?? present).map((one) => (
        <option key={one} value={one} />))}</datalist>}
      {refusal !== "" && <p id={`${id}-why`} className="fault" role="alert">{refusal}</p>}
    </div>
  );
}

/** A value out of a few. */
export function EditChoice({ label, name, present, mark, why, commit, options }:
  Omit<Props, "placeholder" | "note" | "title" | "list" | "complete"> & { options: [value: string, words: string][] }) {
  const [refusal, refuse] = useState("");
  const id = idOf(mark);
  const known = options.some(([value]) => value === present) ? options : [[present, present] as const, ...options];
  return (
    <div className="field line">
      <label htmlFor={id}>{label}</label>
      <select id={id} {...{ [`data-${mark[0]}`]: mark[1] }} value={present} aria-label={name} disabled={why !== ""}
              title={why || undefined}
              onChange={(event) => void commit(event.target.value).then(refuse)}>
        {known.map(([value, words]) => <option key={value} value={value}>{words}</option>)}
      </select>
      {refusal !== "" && <p className="fault" role="alert">{refusal}</p>}
    </div>
  );
}

/** Words for one act, and a button: the fields are empty again after it. */
export function AddForm({ label, fields, why, commit }: {
  label: string; why: string; fields: { id: string; label: string; list?: string; isOptional?: boolean }[];
  commit: (words: string[]) => Promise<string>;
}) {
  const [words, type] = useState<string[]>(fields.map(() => ""));
  const [refusal, refuse] = useState("");
  const first = useRef<HTMLInputElement>(null);
  const isMounted = useRef(true);
  useEffect(() => () => { isMounted.current = false; }, []);
  const send = async () => {
    if (why !== "") return;
    const missing = fields.find((field, i) => !field.isOptional && words[i]!.trim() === "");
    if (missing) return refuse(`${missing.label} is missing`);
    const sentence = await commit(words.map((one) => one.trim()));
    if (!isMounted.current) return;
    refuse(sentence);
    if (sentence !== "") return;
    type(fields.map(() => ""));
    first.current?.focus();
  };
  return (
    <form className="add" aria-label={label} onSubmit={(event) => { event.preventDefault(); void send(); }}>
      {fields.map((field, i) => (
        <label key={field.id}>{field.label}
          <input id={field.id} ref={i === 0 ? first : undefined} value={words[i]} list={field.list} spellCheck={false}
                 autoComplete="off" readOnly={why !== ""} title={why || undefined}
                 onChange={(event) => type(words.map((one, k) => (k === i ? event.target.value : one)))}
                 onKeyDown={onEscape(() => { type(fields.map(() => "")); refuse(""); })} />
        </label>))}
      <button type="submit" aria-label={label} aria-disabled={why !== "" || undefined} title={why || undefined}>
        {label}</button>
      {refusal !== "" && <p className="fault" role="alert">{refusal}</p>}
    </form>
  );
}

/** Leads to a variable: its name, producers and readers. */
export const MoreOf = ({ variable }: { variable: string }) => (
  <button type="button" className="link" aria-label={`Variable ${variable}`} title={`variable ${variable}`}
          onClick={() => showVariable(variable)}>more</button>);

/** Gives the focus to a field by its mark. */
export function focusField(attribute: string, value: string): void {
  const field = document.querySelector<HTMLInputElement>(`[data-${attribute}="${CSS.escape(value)}"]`);
  field?.focus();
  field?.select?.();
}
