// SPDX-License-Identifier: Apache-2.0
// The operator variables: a field each, with its unit; a slider for a number, a check box for true and false.
import { memo, useRef, useState } from "react";
import { bench } from "./bench";
import { Button } from "./controls";
import { draft } from "./draft";
import { runsFile, whyNot } from "./lamps";
import { forbidden, Machine, MachineState } from "./machine";
import type { Variable } from "./protocol";
import { useStore } from "./store";
import { scalar, sliderRange, withUnit } from "./text";
import { tuneActs } from "./tune";
import { useReading } from "./values";

/** A slider asks at most this often, in milliseconds; a connection may act 100 times a second. */
const SLIDER_MS = 120;

interface FieldProps { machine: Machine; variable: Variable; why: string }

function Slider({ machine, variable, why, shown }: FieldProps & { shown: { value: number; unit: string } }) {
  // The range of a variable without a declared one stays as it was at first: a slider must not flee from the hand.
  const [range] = useState(() => sliderRange(shown.value, variable.least, variable.most));
  // While a hand moves the slider it shows the wish, because the answer comes a little later.
  const [wish, setWish] = useState<number | null>(null);
  const waiting = useRef<number | null>(null);
  const timer = useRef(0);
  const next = async () => {
    const wanted = waiting.current;
    waiting.current = null;
    timer.current = 0;
    if (wanted === null) return setWish(null);
    timer.current = window.setTimeout(() => void next(), SLIDER_MS);
    await machine.ask("set", { values: { [variable.variable]: shown.unit ? `${wanted} ${shown.unit}` : wanted } });
  };
  const send = (value: number) => {
    setWish(value);
    waiting.current = value;
    if (timer.current === 0) void next();
  };
  const [low, high, step] = range;
  return <input type="range" min={Math.min(low, shown.value)} max={Math.max(high, shown.value)} step={step}
                value={wish ?? shown.value} disabled={why !== ""} title={why || undefined}
                aria-label={`${variable.variable}, slider`} aria-valuetext={`${shown.value} ${shown.unit}`}
                onChange={(event) => send(Number(Number(event.target.value).toPrecision(6)))} />;
}

const Field = memo(function Field({ machine, variable, why }: FieldProps) {
  const { reading } = useReading(machine.values, variable.variable);
  const [typed, type] = useState<string | null>(null);  // while the field has the focus its text stands still
  const present = reading?.text ?? "";
  const set = async (value: unknown) => {
    if (await machine.act("set", { values: { [variable.variable]: value } })) type(null);
  };
  const name = variable.variable;
  if (reading && typeof reading.value === "boolean") {
    return <label className="field">
      <input type="checkbox" checked={reading.value} disabled={why !== ""} title={why || undefined} aria-label={name}
             onChange={(event) => void set(event.target.checked)} /> {name}</label>;
  }
  const shown = typeof reading?.value === "number" ? scalar(present) : null;
  return (
    <div className="field">
      <label htmlFor={`set-${name}`}>{name}{" "}
        <span className="unit">{variable.type}{variable.shape} {variable.unit}</span></label>
      <input id={`set-${name}`} value={typed ?? present} readOnly={why !== ""} title={why || "Enter sets the value"}
             className={typed === null || typed === present ? "" : "edited"}
             onFocus={() => { if (reading) type(present); }}
             onBlur={() => { if (typed === present) type(null); }}
             onChange={(event) => type(event.target.value)}
             onKeyDown={(event) => {
               if (event.key === "Enter" && typed !== null) void set(withUnit(typed, present));
               if (event.key === "Escape") type(null);
             }} />
      {shown && Number.isFinite(shown.value) &&
        <Slider machine={machine} variable={variable} why={why} shown={shown} />}
    </div>
  );
});

/** Puts the present values into the draft of the FILE that runs. */
function TuneButton({ machine, state, variables }: { machine: Machine; state: MachineState; variables: Variable[] }) {
  const { hello, door } = useStore(bench);
  const { outline } = useStore(draft.state);
  if (!outline || !runsFile(state, hello?.file ?? null)) return null;
  const put = async () => {
    const present = new Map(variables.flatMap(({ variable }): [string, string][] => {
      const text = machine.values.reading(variable)?.text;
      return text === undefined ? [] : [[variable, text]];
    }));
    const acts = tuneActs(outline, present);
    const refusal = await draft.edit(acts);
    const names = acts.map((act) => act.path.slice("operator/".length)).join(", ");
    machine.say(refusal || (names === "" ? "The draft has these values already."
      : `The draft has the present values of ${names}.`));
  };
  return <Button label="Put into the draft" title="the present values, as edits of FILE" press={() => void put()}
                 forbidden={whyNot(hello, door === "open")} />;
}

export function Operator({ machine, state }: { machine: Machine; state: MachineState }) {
  const { variables: all = [], sequence } = state.description ?? {};
  const variables = all.filter((v) => !v.constant && (v.operator ?? (v.given && v.producers.length === 0)) &&
    !(sequence && v.variable === "sequence_go"));  // a slider would begin steps; Steps has buttons for it
  if (variables.length === 0) return null;
  const why = forbidden(state.hello?.role, "operate");
  return (
    <section className="panel" aria-label="Operator variables">
      <h2>Operator</h2>
      {why !== "" && <p className="hint">{why}</p>}
      <TuneButton machine={machine} state={state} variables={variables} />
      {variables.map((v) => <Field key={`${state.version} ${v.variable}`} machine={machine} variable={v} why={why} />)}
    </section>
  );
}
