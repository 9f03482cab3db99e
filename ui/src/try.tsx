// SPDX-License-Identifier: Apache-2.0
// The panel "Try": the draft in virtual time, with its curves and its verdict.
import { useEffect, useRef, useState } from "react";
import { Button, Table } from "./controls";
import { Curves } from "./curves";
import { draft } from "./draft";
import { NameList, SaveButton } from "./name_list";
import type { RunAnswer } from "./protocol";
import { useStore } from "./store";
import { receiptText } from "./switch_menu";
import { apartOf } from "./table";
import { duration, short } from "./text";
import { firstWatched, halt, MOST_WATCHED, tried, tryDraft } from "./trial";

/** Clean or not, and what was counted. */
function Verdict({ answer, isSaved }: { answer: RunAnswer; isSaved: boolean }) {
  const { verdict, expectations = [], receipts = [], tasks = [] } = answer;
  if (!verdict) return null;
  const isClean = verdict.clean && verdict.failures.length === 0 && expectations.every((one) => one.holds);
  return (
    <div className="verdict" role="status" aria-label="Verdict" data-verdict-of-try={isClean ? "clean" : "not clean"}>
      <strong className={isClean ? "" : "fault"}>{isClean ? "clean" : "not clean"}</strong>{" "}
      in {duration(answer.ran_ns ?? 0)}: {verdict.missed} deadlines missed, {verdict.dropped} releases dropped,{" "}
      {verdict.faults} faults{!isSaved && ". Not saved yet: Ctrl-S"}
      <ul>
        {[...verdict.failures, ...verdict.remarks].map((words) => <li key={words}>{words}</li>)}
        {expectations.map((one) => (
          <li key={one.text} className={one.holds ? "" : "fault"}>
            {one.holds ? "holds" : "FAILS"}: {one.text} ({one.said})</li>))}
        {receipts.map((one, i) => <li key={i}>{receiptText(one)}</li>)}
      </ul>
      {tasks.some((task) => task.missed > 0) &&
        <Table label="Missed deadlines" heading={["task", "missed", "cycles"]}
               rows={tasks.filter((one) => one.missed > 0).map((one) => [one.task, one.missed, one.cycles])} />}
    </div>
  );
}

/** `why`: the reason why nothing can be tried; "": it can. */
export function TryPanel({ why }: { why: string }) {
  const state = useStore(tried);
  const { draft: now, outline } = useStore(draft.state);
  const [length, type] = useState(state.duration);
  const unitOf = (name: string) => outline?.variables.find((one) => one.variable === name)?.unit ?? "";
  const [first] = outline?.variables.filter((one) => one.variable === firstWatched()[0]) ?? [];
  const expectation = !first ? "" : `max |${first.variable}${first.shape === "" ? "" : "[0]"}| <= 1 ${
    first.unit === "1" ? "" : first.unit}`.trim();
  const answer = (state.result?.output ?? {}) as RunAnswer;
  const acts = useRef<HTMLDivElement>(null);
  const focus = () => acts.current?.querySelector("button")?.focus();
  useEffect(focus, []);
  const isOld = state.result !== null && now !== null && state.version !== now.version;
  return (
    <section className="panels trial" aria-label="Try">
      <div className="acts" ref={acts}>
        <Button label="Try the draft" title="in virtual time (key t)" press={() => void tryDraft()}
                forbidden={why || (state.isBusy ? "a try is under way" : "")} />
        {state.isBusy && state.running && <Button label="Halt" press={() => void halt(state.running!.number)} />}
        {state.result?.csv && <SaveButton name="try.csv" type="text/csv" text={state.result.csv} />}
        <Button label="Close" press={() => tried.set({ isOpen: false })} />
        <span role="status" aria-label="Progress" data-try={state.isBusy ? "running" : state.result ? "ended" : "none"}>
          {state.isBusy ? `under way for ${duration((state.running?.ran_ms ?? 0) * 1e6)}`
            : isOld ? "the draft has changed since" : ""}</span>
      </div>
      {state.result?.why && <p className="fault" data-try-why>The try was ended: {state.result.why}.</p>}
      {state.message !== "" && <p className="fault" role="alert" data-try-message>{state.message}</p>}
      {state.offers.length > 0 && <p className="acts">{state.offers.map((offer) => (
        <Button key={offer.label} label={offer.label} title="sets it and tries again" forbidden={why}
                press={() => { focus(); void draft.press(offer.acts).then(() => tryDraft()); }} />))}</p>}
      <form className="add" onSubmit={(event) => { event.preventDefault(); void tryDraft(); }}>
        <label>Run for
          <input id="try-duration" value={length} placeholder="2 s"
                 onChange={(event) => { type(event.target.value); tried.set({ duration: event.target.value }); }} />
        </label>
        <NameList id="try-watch" label="Variables" isList list="known" names={state.watch} most={MOST_WATCHED}
                  unitOf={unitOf} hint={firstWatched().join(", ")} change={(watch) => tried.set({ watch })} />
        <NameList id="try-at" label="Timed acts" hint="1 s: set kp 100 N.m/rad" names={state.at} most={MOST_WATCHED}
                  change={(at) => tried.set({ at })} />
        <NameList id="try-expect" label="Expectations" hint={expectation} names={state.expect}
                  most={MOST_WATCHED} change={(expect) => tried.set({ expect })} />
        <button type="submit" hidden />
      </form>
      {!state.isBusy && <Verdict answer={answer} isSaved={!now?.touched} />}
      {state.table && apartOf(state.table).map(({ name, reference, unit, most, channel, at }) => (
        <p key={name} className="hint" data-follows={name}>{name} and {reference}: at most {short(most)}{" "}
          {unit === "1" ? "" : unit} apart ({channel} at {short(at)} s)</p>))}
      {state.table && <Curves table={state.table} before={state.before} label="Curves of the try" />}
    </section>
  );
}
