// SPDX-License-Identifier: Apache-2.0
// The text of the draft. What is typed is sent a moment after the last key; what another act made replaces it.
import { useEffect, useLayoutEffect, useRef, useState } from "react";
import { Button } from "./controls";
import { draft } from "./draft";
import { indexAt, lineAt, movedCursor } from "./text_places";

const SEND_MS = 300;
const LINES_ABOVE = 3;

/** The step that a key with Ctrl means. */
export function undoKey(event: { key: string; ctrlKey: boolean; shiftKey: boolean }): "undo" | "redo" | null {
  const key = event.key.toLowerCase();
  if (!event.ctrlKey || (key !== "z" && key !== "y")) return null;
  return key === "y" || event.shiftKey ? "redo" : "undo";
}

/** A place to show; another object shows the same place again. */
export interface TextPlace { line: number; column: number; isFocused: boolean }

const version = (): number => draft.state.get().draft?.version ?? 0;

export function TextPanel({ text, why, place, atLine }:
  { text: string; why: string; place: TextPlace | null; atLine: (line: number) => void }) {
  const [typed, type] = useState<string | null>(null);
  const [refusal, setRefusal] = useState("");
  const [first] = useState(text);
  const area = useRef<HTMLTextAreaElement>(null);
  const timer = useRef(0);
  const wanted = useRef<string | null>(null);  // typed, and not known to be the text of the draft
  const base = useRef(0);  // version under it
  const sent = useRef<string | null>(null);
  const isRefused = useRef(false);
  const shown = useRef(text);
  const now = typed ?? text;
  const refuse = (sentence: string) => {
    isRefused.current = sentence !== "";
    setRefusal(sentence);
  };
  /** After a refusal only a person sends again. */
  const send = async (isAsked: boolean) => {
    const mine = wanted.current;
    window.clearTimeout(timer.current);
    if (mine === null || mine === sent.current || (isRefused.current && !isAsked)) return;
    sent.current = mine;
    const sentence = await draft.replace(mine, isAsked ? version() : base.current);
    sent.current = null;
    base.current = version();
    refuse(sentence);
    if (wanted.current !== mine || sentence !== "") return;  // more was typed, or the typed words stay
    wanted.current = null;
    type(null);
  };
  const drop = () => { wanted.current = null; type(null); refuse(""); };
  useEffect(() => () => void send(false), []);  // the page goes to Look: what was typed is not lost
  useLayoutEffect(() => {  // a new value moves the cursor to the end
    const field = area.current;
    if (field && shown.current !== now && wanted.current === null) {
      const [start, end] = [field.selectionStart, field.selectionEnd].map((at) => movedCursor(shown.current, now, at));
      const top = field.scrollTop;
      field.value = now;
      field.setSelectionRange(start!, end!);
      field.scrollTop = top;
    }
    shown.current = now;
  }, [now]);
  useEffect(() => {
    const field = area.current;
    if (!field || !place) return;
    const index = indexAt(field.value, place.line, place.column);
    field.setSelectionRange(index, index);
    const height = parseFloat(getComputedStyle(field).lineHeight);
    field.scrollTop = Math.max(0, (place.line - 1 - LINES_ABOVE) * height);
    if (place.isFocused) field.focus();
    atLine(place.line);
  }, [place]);
  return (
    <section className="text" aria-label="Text">
      <h2><label htmlFor="draft-text">Text</label></h2>
      {refusal !== "" && (
        <p className="fault" role="alert">{refusal}{" "}
          <Button label="Send my text" press={() => void send(true)} />{" "}
          <Button label="Take the text of the draft" press={drop} /></p>)}
      <textarea id="draft-text" ref={area} defaultValue={first} readOnly={why !== ""} title={why || undefined}
                spellCheck={false} autoComplete="off" wrap="off"
                onSelect={(event) => atLine(lineAt(event.currentTarget.value, event.currentTarget.selectionStart))}
                onBlur={() => void send(false)}
                onKeyDown={(event) => {
                  const step = undoKey(event);
                  if (step === null) return;
                  event.preventDefault();
                  void send(false).then(() => draft.undo(step));
                }}
                onChange={(event) => {
                  if (wanted.current === null) base.current = version();
                  wanted.current = shown.current = event.target.value;
                  type(event.target.value);
                  window.clearTimeout(timer.current);
                  timer.current = window.setTimeout(() => void send(false), SEND_MS);
                }} />
    </section>
  );
}
