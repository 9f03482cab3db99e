// SPDX-License-Identifier: Apache-2.0
// The chosen tasks: their acts, figures and ports.
import { memo, useEffect, useRef } from "react";
import { Act, ACTS, carryOut, questionBefore } from "./acts";
import { Button } from "./controls";
import { forbidden, Machine, MachineState } from "./machine";
import type { DescribedTask, Port, TaskStatus } from "./protocol";
import { count, duration, rate } from "./text";
import { LiveValues } from "./values";
import { ask, showVariable } from "./view";

/** Carries an act out on the chosen tasks, after its question if it has one. */
export function begin(machine: Machine, act: Act, names: string[]): void {
  const state = machine.state.get();
  if (forbidden(state.hello?.role, act.role) !== "") return;
  const tasks = (state.status?.tasks ?? []).filter((task) => names.includes(task.task));
  const go = () => void carryOut(machine, act, names);
  const question = questionBefore(act, tasks, go);
  if (question) ask(question);
  else go();
}

function Acts({ machine, state, tasks }: { machine: Machine; state: MachineState; tasks: TaskStatus[] }) {
  const names = tasks.map((task) => task.task);
  return (
    <div className="acts" role="toolbar" aria-label={`Acts on ${names.join(", ")}`}>
      {ACTS.map((act) => {
        const are = `${names.join(", ")} ${names.length > 1 ? "are" : "is"}`;
        const useless = tasks.some(act.fits) ? "" : `of no use: ${are} ` +
          [...new Set(tasks.map((task) => task.state))].join(" and ");
        return (
          <Button key={act.name} label={`${act.name} ${names.join(", ")}`} title={`${act.help} (key ${act.key})`}
                  forbidden={forbidden(state.hello?.role, act.role) || useless}
                  press={() => begin(machine, act, names)}>{act.name}</Button>
        );
      })}
    </div>
  );
}

/** Value, unit and age of a variable, in the unit of the file; changes without React. */
export const LiveText = memo(function LiveText({ variable, values }: { variable: string; values: LiveValues }) {
  const text = useRef<HTMLSpanElement>(null);
  const age = useRef<HTMLSpanElement>(null);
  useEffect(() => values.watch(variable, (reading, ageNs, isOld) => {
    if (!text.current || !age.current) return;
    text.current.textContent = reading.value === null ? "never written" : reading.text;
    age.current.textContent = reading.producer === "operator" ? "operator" : duration(ageNs);
    text.current.parentElement?.classList.toggle("old", isOld);
    text.current.parentElement?.classList.toggle("invalid", !reading.valid);
  }), [variable, values]);
  return <span className="live"><span ref={text} data-live={variable} /> <span ref={age} className="age" /></span>;
});

function PortLine({ port, values }: { port: Port; values: LiveValues }) {
  const isVariable = port.variable !== "" && (port.kind === "in-var" || port.kind === "out-var");
  return (
    <li>
      <span title={`${port.type}${port.shape} ${port.unit}`}>{port.port}</span>
      {isVariable && <> <button type="button" className="link" aria-label={`Why ${port.variable}`}
                                onClick={() => showVariable(port.variable)}>{port.variable}</button></>}
      {!isVariable && port.variable !== "" && <span className="soft"> {port.variable}</span>}
      {isVariable ? <div><LiveText variable={port.variable} values={values} /></div>
        : <span className="soft"> {port.type}{port.shape} {port.unit === "1" ? "" : port.unit}</span>}
    </li>
  );
}

const KINDS: [Port["kind"], string][] = [["in-var", "Inputs"], ["out-var", "Outputs"], ["in-const", "Constants"],
  ["out-const", "Constants for others"], ["resource", "Resources"]];

function Ports({ task, ports, values }: { task: string; ports: Port[]; values: LiveValues }) {
  return <>{KINDS.map(([kind, words]) => {
    const found = ports.filter((port) => port.kind === kind);
    return found.length === 0 ? null : (
      <section key={kind}>
        <h4>{words}</h4>
        <ul className="ports" aria-label={`${words} of ${task}`}>
          {found.map((port) => <PortLine key={port.port} port={port} values={values} />)}</ul>
      </section>
    );
  })}</>;
}

function Figures({ task }: { task: TaskStatus }) {
  const load = task.on_ns > 0 ? (100 * task.busy_ns) / task.on_ns : 0;
  const figures: [string, string][] = [
    ["rate", rate(task.rate_hz)], ["rtpu", task.rtpu],
    ["budget", task.budget_ns > 0 ? duration(task.budget_ns) : "none"],
    ["cycle, mean", duration(task.execution_ns.mean)], ["cycle, longest", duration(task.execution_ns.max)],
    ["response, longest", duration(task.response_ns.max)], ["load", `${load.toFixed(1)} %`],
    ["cycles", count(task.cycles)], ["missed", count(task.missed)], ["over budget", count(task.overrun)],
    ["dropped", count(task.dropped)], ["stale inputs", count(task.stale)], ["faults", count(task.faults)],
  ];
  return <dl className="figures">{figures.map(([name, value]) => (
    <div key={name}><dt>{name}</dt><dd>{value}</dd></div>))}</dl>;
}

function OneTask({ described, task, values }:
  { described: DescribedTask | undefined; task: TaskStatus; values: LiveValues }) {
  return (
    <article aria-label={`Task ${task.task}`}>
      <h3>{task.task} <span className={`word state-${task.state}`}>{task.state}</span></h3>
      <p className="doc">{task.component}: {described?.doc}</p>
      {task.standby_for !== null && <p>standby for {task.standby_for}</p>}
      {task.fault !== null && <p className="fault" role="note">last fault: {task.fault}</p>}
      <Figures task={task} />
      <Ports task={task.task} ports={described?.ports ?? []} values={values} />
    </article>
  );
}

export function Inspector({ machine, state, chosen }: { machine: Machine; state: MachineState; chosen: string[] }) {
  const tasks = (state.status?.tasks ?? []).filter((task) => chosen.includes(task.task));
  return (
    <section className="panel" aria-label="Chosen tasks">
      <h2>{tasks.length === 0 ? "Tasks" : tasks.length === 1 ? "Task" : `${tasks.length} tasks`}</h2>
      {tasks.length === 0
        ? <p className="hint">Press a box to see its task; with Ctrl for several. Keys: press ? for all.</p>
        : <Acts machine={machine} state={state} tasks={tasks} />}
      {tasks.slice(0, 8).map((task) => (
        <OneTask key={task.task} task={task} values={machine.values}
                 described={state.description?.tasks.find((one) => one.task === task.task)} />))}
      {tasks.length > 8 && <p>{tasks.length - 8} more tasks are chosen.</p>}
    </section>
  );
}
