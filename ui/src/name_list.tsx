// SPDX-License-Identifier: Apache-2.0
// A list of words that a person adds and takes away, and a button that saves a text as a file.
import { useState } from "react";
import { Button } from "./controls";

interface Props {
  id: string; label: string; names: string[]; most: number; change: (names: string[]) => void;
  /** A comma ends a name. */
  isList?: boolean;
  /** Of a datalist, or what the empty field shows. */
  list?: string; hint?: string;
  unitOf?: (name: string) => string;
}

export function NameList({ id, label, names, most, change, isList, list, hint, unitOf }: Props) {
  const [typed, type] = useState("");
  const add = () => {
    const words = typed.split(isList ? "," : "\n").map((word) => word.trim()).filter((word) => word !== "");
    if (words.length === 0 || names.length >= most) return;
    change([...new Set([...names, ...words])].slice(0, most));
    type("");
  };
  return (
    <div className="names">
      <label>{label}
        <input id={id} value={typed} list={list} placeholder={hint} onChange={(event) => type(event.target.value)}
               onKeyDown={(event) => {
                 if (event.key !== "Enter" || typed.trim() === "") return;  // an empty field sends the form
                 event.preventDefault();
                 add();
               }} onBlur={add} /></label>
      {names.map((name) => {
        const unit = unitOf?.(name) ?? "";
        return (
          <Button key={name} label={`Take ${name} away`} className="name" title="take it away"
                  press={() => change(names.filter((one) => one !== name))}>
            {name}{unit !== "" && unit !== "1" && <span className="unit"> {unit}</span>} ✕</Button>);
      })}
      {names.length >= most && <span className="hint">{most} at most</span>}
    </div>
  );
}

/** Saves the text where the browser keeps what it loads. */
export function SaveButton({ name, type, text }: { name: string; type: string; text: string }) {
  return <Button label={`Save ${name}`} press={() => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    window.setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  }} />;
}
