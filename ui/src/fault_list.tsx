// SPDX-License-Identifier: Apache-2.0
// The faults of the draft, each with edits that remedy it; the load of each CPU, judged without a run.
import { useLayoutEffect, useRef } from "react";
import { Button } from "./controls";
import { draft } from "./draft";
import { cpuVerdicts } from "./faults";
import type { Analysis, EditAct, Fault, Offer } from "./protocol";

const MOST_SHOWN = 200;

/** Gives the focus to the first button of a fault, or to the fault. `number`: at least that of the fault. */
function focusFault(number: number): void {
  const all = [...document.querySelectorAll<HTMLElement>("li[data-fault]")]
    .filter((one) => one.getClientRects().length > 0);
  const next = all.find((one) => Number(one.dataset.fault) >= number) ?? all[0];
  (next?.querySelector<HTMLElement>(".acts button") ?? next?.querySelector<HTMLElement>(".link"))?.focus();
}

/** From a fault to its first button, from there to the next fault. */
export function focusNextFault(): void {
  const focused = document.activeElement, present = focused?.closest<HTMLElement>("li[data-fault]");
  const isBefore = focused?.matches(".link") && present?.querySelector(".acts button");
  focusFault(present ? Number(present.dataset.fault) + (isBefore ? 0 : 1) : 0);
}

/** A fault with edits that remedy it. */
export function FaultLine({ fault, number, offers, why, go, press }: {
  fault: Fault; number: number; offers: Offer[]; why: string; go: (fault: Fault) => void;
  press: (number: number, acts: EditAct[]) => void;
}) {
  return (
    <li data-fault={number} className={fault.severity}
        onClick={(event) => { if (!(event.target as Element).closest("button")) go(fault); }}>
      <span role="button" tabIndex={0} className="link" onKeyDown={(event) => {
        if (event.key !== " " && event.key !== "Enter") return;
        event.preventDefault();
        go(fault);
      }}>
        {fault.severity === "warning" && "warning: "}{fault.message}</span>
      <span className="soft"> {fault.line > 0 && `line ${fault.line}`} {fault.remedy}</span>
      <span className="acts">{offers.filter((offer) => offer.fault === number).map((offer) => (
        <Button key={offer.label} label={offer.label} forbidden={why}
                press={() => press(number, offer.acts)} />))}</span>
    </li>);
}

export function FaultList({ analysis, offers, why, go }:
  { analysis: Analysis; offers: Offer[]; why: string; go: (fault: Fault) => void }) {
  const { faults, errors, warnings } = analysis.report;
  const pressed = useRef<number | null>(null);
  useLayoutEffect(() => {  // the pressed button is gone: the next fault gets the focus, once it has its buttons
    if (pressed.current === null || offers.length === 0) return;
    if (document.activeElement === document.body) focusFault(pressed.current);
    pressed.current = null;
  }, [offers]);
  return (
    <section className="faults" aria-label="Faults">
      <h2>Faults {errors}{warnings > 0 && `, warnings ${warnings}`}</h2>
      {analysis.report.legal && <p className="hint">The draft is legal.</p>}
      <ol aria-label="Faults, in order of their place">
        {faults.slice(0, MOST_SHOWN).map((fault, number) => (
          <FaultLine key={number} fault={fault} number={number} offers={offers} why={why} go={go}
                     press={(at, acts) => { pressed.current = at; void draft.press(acts); }} />))}
      </ol>
      {faults.length > MOST_SHOWN && <p className="hint">{faults.length - MOST_SHOWN} more are not shown.</p>}
    </section>
  );
}

export function DraftCpus({ analysis, why }: { analysis: Analysis; why: string }) {
  const { schedule, outline } = analysis;
  if (!schedule) return outline && outline.tasks.length > 0
    ? <div className="cpus"><span className="hint">The load of each CPU is judged when the draft is legal.</span></div>
    : null;
  return (
    <div className="cpus" role="group" aria-label="Load of each CPU">
      {cpuVerdicts(schedule).map((cpu) => {
        const name = `cpu${cpu.cpu} in ${cpu.set}`;
        const words = `${name}: ${cpu.utilisation.toFixed(2)} of ${cpu.limit}; ${cpu.note}`;
        return (
          <div key={cpu.cpu} className={`cpu${cpu.fits ? "" : " over"}`} data-cpu={cpu.cpu}>
            <span>{name}</span>
            <svg viewBox="0 0 100 10" preserveAspectRatio="none" role="img" aria-label={words}>
              <rect className="trough" x="0" y="0" width="100" height="10" />
              <rect className="used" x="0" y="0" width={Math.min(100, 100 * cpu.utilisation)} height="10" />
              <rect className="capacity" x={Math.min(99, 100 * cpu.limit)} y="0" width="1" height="10" />
            </svg>
            <span className="figures-cpu">{cpu.utilisation.toFixed(2)} / {cpu.limit}</span>
            <span className="note">{cpu.note}</span>
            {cpu.remedies.filter((remedy) => remedy.label).map((remedy) => (
              <Button key={remedy.label} label={remedy.label} forbidden={why}
                      press={() => void draft.press(remedy.acts)} />))}
          </div>);
      })}
    </div>
  );
}
