// SPDX-License-Identifier: Apache-2.0
// The panels below the picture: events, steps, receipts, profile, why.
import { memo, useEffect, useMemo, useState } from "react";
import { bench } from "./bench";
import { Button, Table } from "./controls";
import { whyNot } from "./lamps";
import type { Machine, MachineState } from "./machine";
import type { Event, Receipt, TaskProfile, WhyLink } from "./protocol";
import { ScopePanel } from "./scope";
import { StepsPanel } from "./sequence_view";
import { useStore } from "./store";
import { receiptText } from "./switch_menu";
import { clock, count, duration, short } from "./text";
import { Timeline } from "./timeline";
import { choose, Panel, showVariable, view } from "./view";

/** Events drawn at once; the filter looks at all that are kept. */
const SHOWN_EVENTS = 200;

const EventLine = memo(function EventLine({ event }: { event: Event }) {
  const where = event.task ?? event.rtpu ?? "";
  return (
    <li data-event={event.number} className={`kind-${event.kind}`}>
      <span className="number">{event.number}</span> <time>{clock(event.wall_ns)}</time>{" "}
      <span className="kind">{event.kind}</span>{" "}
      {event.task !== undefined
        ? <button type="button" className="link" onClick={() => choose([event.task as string])}>{where}</button>
        : where}{" "}
      {event.text}{event.by !== undefined && <span className="by"> by {event.by}</span>}
    </li>
  );
});

function Events({ state, chosen }: { state: MachineState; chosen: string[] }) {
  const [words, filter] = useState("");
  const found = useMemo(() => {
    const wanted = words.toLowerCase();
    const concerns = (event: Event) => chosen.length === 0 || event.task === undefined || chosen.includes(event.task);
    const says = ({ kind, task, rtpu, text }: Event) =>
      `${kind} ${task ?? ""} ${rtpu ?? ""} ${text}`.toLowerCase().includes(wanted);
    return state.events.filter((event) => concerns(event) && (wanted === "" || says(event)));
  }, [state.events, words, chosen]);
  return (
    <>
      <label>Filter <input value={words} onChange={(event) => filter(event.target.value)}
                           aria-label="Filter of events" /></label>
      <span className="hint"> {found.length} of {state.events.length}
        {chosen.length > 0 && `, of ${chosen.join(", ")}`}
        {state.gaps > 0 && `; ${state.gaps} events are lost`}</span>
      <ol className="events" aria-label="Events, newest first">
        {found.slice(-SHOWN_EVENTS).reverse().map((event) => <EventLine key={event.number} event={event} />)}
      </ol>
    </>
  );
}

/** Asks again every `ms` and whenever `now` changes, while the panel is open. */
function useAnswer<T>(machine: Machine, method: string, parameters: string, ms: number, now: unknown): T | null {
  const [answer, set] = useState<T | null>(null);
  const door = machine.state.get().door;
  useEffect(() => {
    if (door !== "open") return;
    let isOpen = true;
    const ask = async () => {
      const latest = await machine.ask(method, JSON.parse(parameters) as object);
      if (isOpen && latest) set(latest as T);
    };
    void ask();
    const timer = ms > 0 ? window.setInterval(() => { if (!document.hidden) void ask(); }, ms) : 0;
    return () => { isOpen = false; window.clearInterval(timer); };
  }, [machine, method, parameters, ms, now, door]);
  return answer;
}

function ReceiptDetails({ receipt }: { receipt: Receipt }) {
  const took = receipt.took_ns ?? {};
  return (
    <details>
      <summary>{receipt.number}. {receiptText(receipt)} {receipt.wall_ns ? clock(receipt.wall_ns) : ""}</summary>
      <p>{Object.entries(took).filter(([, ns]) => ns !== null)
        .map(([part, ns]) => `${part} ${duration(ns)}`).join(", ")}
        {receipt.slow_why ? `; slow: ${receipt.slow_why}` : ""}</p>
      <Table label="Tasks" heading={["task", "move", "lost", "longest delay"]}
             rows={(receipt.tasks ?? []).map((task) => [
        task.task, task.move, count(task.lost), task.delay_ns === null ? "" : duration(task.delay_ns)])} />
      {(receipt.variables ?? []).length > 0 &&
        <Table label="Variables" heading={["variable", "from", "to", "step", "limit"]}
               rows={(receipt.variables ?? []).map((v) => [v.variable, v.from ?? "", v.to ?? "",
                 v.step === null ? "" : `${short(v.step)} ${v.unit}${v.beyond ? " beyond the limit" : ""}`,
                 v.limit === null ? "" : `${short(v.limit)} ${v.unit}`])} />}
    </details>
  );
}

function Receipts({ machine, state }: { machine: Machine; state: MachineState }) {
  const switches = state.events.filter((event) => event.kind === "switch" || event.kind === "takeover").length;
  const answer = useAnswer<{ receipts: Receipt[]; fault: string | null }>(
    machine, "receipts", '{"last": 50}', 0, switches);
  const receipts = answer?.receipts ?? [];
  return (
    <>
      {answer?.fault && <p className="fault">Receipts are not filed: {answer.fault}</p>}
      {receipts.length === 0 && <p className="hint">No switch was asked for yet.</p>}
      {[...receipts].reverse().map((one, i) =>
        <ReceiptDetails key={`${one.wall_ns} ${one.number} ${i}`} receipt={one} />)}
    </>
  );
}

function Profile({ machine }: { machine: Machine }) {
  const answer = useAnswer<{ tasks: TaskProfile[] }>(machine, "profile", "{}", 2000, 0);
  const time = (spread: { count: number; mean: number; max: number } | undefined, key: "mean" | "max") =>
    !spread || spread.count === 0 ? "" : duration(spread[key]);
  return <Table label="Profile" heading={["task", "state", "rtpu", "cycles", "mean", "longest", "response", "missed",
    "over budget", "dropped", "stale", "rejected", "faults"]} rows={(answer?.tasks ?? []).map((task) => [
    <button type="button" className="link" onClick={() => choose([task.task])}>{task.task}</button>,
    task.state, task.rtpu,
    count(task.cycles), time(task.execution_ns["cycle"], "mean"), time(task.execution_ns["cycle"], "max"),
    time(task.response_ns, "max"), count(task.missed), count(task.overrun), count(task.dropped), count(task.stale),
    count(task.rejected), count(task.faults)])} />;
}

/** The variables that a person may ask about: of the chosen tasks, outputs first. */
function questionsOf(state: MachineState, chosen: string[]): string[] {
  const ports = (state.description?.tasks ?? [])
    .filter((task) => chosen.includes(task.task)).flatMap((task) => task.ports);
  const of = (kind: string) => ports
    .filter((port) => port.kind === kind && port.variable !== "").map((p) => p.variable);
  return [...new Set([...of("out-var"), ...of("in-var")])];
}

function WhyRow({ link }: { link: WhyLink }) {
  return (
    <li style={{ marginInlineStart: `${link.depth * 1.5}em` }} className={link.verdict === "ok" ? "" : "culprit"}
        data-verdict={link.verdict}>
      <button type="button" className="link" onClick={() => showVariable(link.variable)}>{link.variable}</button>
      {" from "}
      {link.producer
        ? <button type="button" className="link" onClick={() => choose([link.producer as string])}>
            {link.producer}</button>
        : "no task"}
      {link.state ? ` (${link.state}, ${link.rtpu ?? ""})` : ""}: <strong>{link.verdict}</strong>
      {link.age_ns !== null ? `, ${duration(link.age_ns)} old` : ""} <span className="soft">{link.value}</span>
      {link.timing !== "" && <div className="soft">{link.timing}</div>}
      {link.late !== "" && <div className="soft">a period late: {link.late}</div>}
    </li>
  );
}

function Why({ machine, state, chosen, variable }:
  { machine: Machine; state: MachineState; chosen: string[]; variable: string }) {
  const offered = questionsOf(state, chosen);
  const asked = variable !== "" ? variable : offered[0] ?? "";
  const isKnown = (state.description?.variables ?? []).some((v) => v.variable === asked && !v.constant);
  const answer = useAnswer<{ verdict: string; chain: WhyLink[] }>(
    machine, isKnown ? "why" : "hello", isKnown ? JSON.stringify({ variable: asked }) : "{}", 1000, asked);
  return (
    <>
      <div className="acts" role="toolbar" aria-label="Variables">
        {offered.map((name) => <Button key={name} label={`Why ${name}`} isPressed={name === asked}
                                       press={() => showVariable(name)}>{name}</Button>)}
      </div>
      {!isKnown && <p className="hint">Choose a variable in the picture, or a task.</p>}
      {isKnown && answer?.chain && (
        <>
          <p data-why={asked}>{answer.verdict}</p>
          <ol className="why" aria-label={`Where ${asked} comes from`}>
            {answer.chain.map((link, i) => <WhyRow key={i} link={link} />)}</ol>
        </>
      )}
    </>
  );
}

const NAMES: [Panel, string][] = [
  ["events", "Events"], ["steps", "Steps"], ["receipts", "Receipts"], ["profile", "Profile"], ["why", "Why"],
  ["scope", "Scope"], ["timeline", "Timeline"]];

export function Panels({ machine, state, panel: wanted, chosen, variable }:
  { machine: Machine; state: MachineState; panel: Panel; chosen: string[]; variable: string }) {
  const { hello, door } = useStore(bench);
  const sequence = state.description?.sequence;
  const names = NAMES.filter(([name]) => name !== "steps" || sequence);
  const panel = names.some(([name]) => name === wanted) ? wanted : "events";
  const turn = (event: { key: string }) => {
    const sign = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (sign === 0) return;
    const at = names.findIndex(([name]) => name === panel);
    const next = names[(at + sign + names.length) % names.length]![0];
    view.set({ panel: next });
    document.getElementById(`tab-${next}`)?.focus();
  };
  return (
    <section className={["scope", "timeline", "steps"].includes(panel) ? "panels tall" : "panels"} aria-label="Panels">
      <div role="tablist" aria-label="Panels" onKeyDown={turn}>
        {names.map(([name, words]) => (
          <button key={name} id={`tab-${name}`} type="button" role="tab" aria-selected={panel === name}
                  aria-controls="panel" tabIndex={panel === name ? 0 : -1}
                  onClick={() => view.set({ panel: name })}>{words}</button>))}
      </div>
      <div id="panel" className="panel-body" role="tabpanel" aria-labelledby={`tab-${panel}`} tabIndex={0}>
        {panel === "events" && <Events state={state} chosen={chosen} />}
        {panel === "steps" && sequence && <StepsPanel machine={machine} state={state} sequence={sequence} />}
        {panel === "receipts" && <Receipts machine={machine} state={state} />}
        {panel === "profile" && <Profile machine={machine} />}
        {panel === "why" && <Why machine={machine} state={state} chosen={chosen} variable={variable} />}
        {panel === "scope" && <ScopePanel state={state} chosen={chosen} why={whyNot(hello, door === "open")} />}
        {panel === "timeline" && <Timeline key={state.name} name={state.name} state={state} />}
      </div>
    </section>
  );
}
