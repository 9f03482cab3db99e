// SPDX-License-Identifier: Apache-2.0
// The panel "Scope": records what is published around a trigger, as `chimera scope` does.
import { useEffect } from "react";
import { Button } from "./controls";
import { Curves } from "./curves";
import { sentenceOf } from "./draft";
import type { MachineState } from "./machine";
import { NameList, SaveButton } from "./name_list";
import type { TrialResult } from "./protocol";
import { Store, useStore } from "./store";
import { readTable, Table } from "./table";
import { duration } from "./text";
import { follow, halt, refusalOf } from "./trial";

type ScopeMode = "single" | "normal" | "auto";
const MOST_CHANNELS = 32;
const MODES: [ScopeMode, string][] = [["single", "one recording"], ["normal", "again after each trigger"],
  ["auto", "again; without a trigger after the wait"]];

interface ScopeState {
  channels: string[]; trigger: string; pre: string; length: string; wait: string; mode: ScopeMode;
  isOn: boolean; running: TrialResult | null; result: TrialResult | null; table: Table | null; message: string;
  recordings: number;
}

const scoped = new Store<ScopeState>({
  channels: [], trigger: "", pre: "", length: "1 s", wait: "60 s", mode: "single", isOn: false, running: null,
  result: null, table: null, message: "", recordings: 0,
});

function once(machine: string, isTriggered: boolean): Promise<TrialResult> {
  const { channels, trigger, pre, length, wait } = scoped.get();
  const words = isTriggered ? { trigger, wait, ...(pre.trim() === "" ? {} : { pre }) } : {};
  return follow("scope", { machine, channels, for: length, ...words }, (running) => {
    scoped.set({ running });
    if (!scoped.get().isOn && running.ended === null) void halt(running.number);
  });
}

const isWithoutTrigger = (result: TrialResult) => refusalOf(result).startsWith("no trigger");

/** Records until it is done, or until a person stops it. */
async function record(machine: string): Promise<void> {
  scoped.set({ isOn: true, message: "" });
  try {
    do {
      const isTriggered = scoped.get().trigger.trim() !== "";
      let result = await once(machine, isTriggered);
      if (scoped.get().mode === "auto" && scoped.get().isOn && result.csv === null && isWithoutTrigger(result))
        result = await once(machine, false);
      const table = result.csv === null ? null : readTable(result.csv);
      if (table) scoped.set({ result, table, message: "", recordings: scoped.get().recordings + 1 });
      else if (scoped.get().isOn && !(scoped.get().mode === "normal" && isWithoutTrigger(result)))
        scoped.set({ message: refusalOf(result), isOn: false });
    } while (scoped.get().isOn && scoped.get().mode !== "single");
  } catch (why) {
    scoped.set({ message: sentenceOf(why) });
  }
  scoped.set({ isOn: false, running: null });
}

function stop(): void {
  const { running } = scoped.get();
  scoped.set({ isOn: false });
  if (running) void halt(running.number);
}

function Words({ id, label, hint, value, change }:
  { id: string; label: string; hint: string; value: string; change: (words: string) => void }) {
  return <label>{label}
    <input id={id} value={value} placeholder={hint} onChange={(event) => change(event.target.value)} /></label>;
}

/** `why`: the reason why nothing can be recorded; "": it can. */
export function ScopePanel({ state, chosen, why }: { state: MachineState; chosen: string[]; why: string }) {
  const scope = useStore(scoped);
  const { table, result, mode } = scope;
  const variables = (state.description?.variables ?? []).filter((one) => !one.constant);
  const unitOf = (name: string) => variables.find((one) => one.variable === name.replace(/[[.].*/, ""))?.unit ?? "";
  useEffect(() => {  // at first the outputs of the chosen tasks
    if (scope.channels.length > 0) return;
    const outputs = variables.filter((one) => one.producers.some((end) => chosen.includes(end.task)));
    if (outputs.length > 0) scoped.set({ channels: outputs.slice(0, MOST_CHANNELS).map((one) => one.variable) });
  }, [chosen]);
  return (
    <div className="trial">
      <datalist id="channels">{variables.map((one) => (
        <option key={one.variable} value={one.variable}>{one.unit}{one.shape}</option>))}</datalist>
      <form className="add" onSubmit={(event) => {
        event.preventDefault();
        if (why === "" && !scope.isOn && scope.channels.length > 0) void record(state.name);
      }}>
        <NameList id="scope-channels" label="Channels" list="channels" hint="q or q[2]" names={scope.channels}
                  most={MOST_CHANNELS} unitOf={unitOf} change={(channels) => scoped.set({ channels })} />
        <Words id="scope-trigger" label="Trigger" hint="error > 2 mrad" value={scope.trigger}
               change={(trigger) => scoped.set({ trigger })} />
        <Words id="scope-pre" label="Before it" hint="50 ms" value={scope.pre} change={(pre) => scoped.set({ pre })} />
        <Words id="scope-for" label="Length" hint="1 s" value={scope.length}
               change={(length) => scoped.set({ length })} />
        <Words id="scope-wait" label="Wait" hint="60 s" value={scope.wait} change={(wait) => scoped.set({ wait })} />
        <label>Mode
          <select id="scope-mode" value={mode}
                  onChange={(event) => scoped.set({ mode: event.target.value as ScopeMode })}>
            {MODES.map(([name, words]) => <option key={name} value={name}>{name}: {words}</option>)}</select></label>
        <button type="submit" aria-label="Record" title={why || undefined}
                aria-disabled={why !== "" || scope.isOn || scope.channels.length === 0 || undefined}>Record</button>
      </form>
      <div className="acts">
        {scope.isOn && <Button label="Stop recording" press={stop} />}
        {result?.csv && <SaveButton name={`${state.name}.csv`} type="text/csv" text={result.csv} />}
        {result?.svg && <SaveButton name={`${state.name}.svg`} type="image/svg+xml" text={result.svg} />}
        <span role="status" aria-label="Recording" data-scope={scope.isOn ? "on" : "off"}
              data-recordings={scope.recordings}>
          {scope.isOn ? `recording for ${duration((scope.running?.ran_ms ?? 0) * 1e6)}` : ""}</span>
      </div>
      {scope.message !== "" && <p className="fault" role="alert" data-scope-message>{scope.message}</p>}
      {table && <Curves table={table} before={null} label={`Recording of ${state.name}`} />}
    </div>
  );
}
