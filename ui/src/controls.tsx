// SPDX-License-Identifier: Apache-2.0
// Buttons that say why they are not allowed, and the question before an act.
import { ReactNode, useEffect, useRef } from "react";
import { ask, view } from "./view";
import { useStore } from "./store";

interface ButtonProps {
  label: string;
  /** Why it is not allowed; "": it is. A button that is not allowed can be reached and read, not pressed. */
  forbidden?: string;
  title?: string;
  className?: string;
  isPressed?: boolean;
  press: () => void;
  children?: ReactNode;
}

export function Button({ label, forbidden = "", title = "", className = "", isPressed, press, children }: ButtonProps) {
  return (
    <button type="button" className={className} aria-label={label} aria-pressed={isPressed}
            aria-disabled={forbidden !== "" || undefined} title={forbidden || title || undefined}
            onClick={() => { if (forbidden === "") press(); }}>
      {children ?? label}
    </button>
  );
}

/** A handler of keys: Escape closes what is open, and does nothing else. */
export const onEscape = (close: () => void) => (event: { key: string; preventDefault: () => void }): void => {
  if (event.key !== "Escape") return;
  event.preventDefault();
  close();
};

/** Asks once, in place. Escape and Cancel leave everything as it is. */
export function QuestionBox() {
  const { question } = useStore(view);
  const button = useRef<HTMLButtonElement>(null);
  const before = useRef<Element | null>(null);
  useEffect(() => {
    if (!question) return;
    before.current = document.activeElement;
    button.current?.focus();
    return () => (before.current as HTMLElement | null)?.focus?.();
  }, [question]);
  if (!question) return null;
  return (
    <div className="question" role="alertdialog" aria-label={question.title} aria-describedby="question-text"
         onKeyDown={onEscape(() => ask(null))}>
      <strong>{question.title}</strong>
      <p id="question-text">{question.text}</p>
      <button ref={button} type="button" onClick={() => ask(null)}>Cancel</button>
      <button type="button" className="danger" onClick={() => { ask(null); question.carryOut(); }}>
        {question.button}
      </button>
    </div>
  );
}

/** A table with a heading; cells are texts or elements. */
export function Table({ label, heading, rows }: { label: string; heading: string[]; rows: ReactNode[][] }) {
  return (
    <table aria-label={label}>
      <thead><tr>{heading.map((cell) => <th key={cell} scope="col">{cell}</th>)}</tr></thead>
      <tbody>{rows.map((row, i) => <tr key={i}>{row.map((cell, k) => <td key={k}>{cell}</td>)}</tr>)}</tbody>
    </table>
  );
}
