// SPDX-License-Identifier: Apache-2.0
// The line that is always there: which subsystem, what is in force, and the FLAG.
import { ReactNode, useState } from "react";
import { Button, onEscape } from "./controls";
import { forbidden, Machine, MachineState } from "./machine";
import type { BenchHello, MachineName, Status } from "./protocol";
import { loads } from "./load";
import { go, place } from "./place";
import { useStore } from "./store";
import { SwitchMenu } from "./switch_menu";
import { ask, Mode, view } from "./view";

/** RUNNING, or the nearest trouble, in one or two words. */
export function stateWord(state: MachineState): string {
  const { door, status } = state;
  if (door === "gone") return "ENDED";
  if (door === "connecting" || (door === "open" && !status)) return "CONNECTING";
  if (door !== "open" || !status || state.isSilent) return "NO CONNECTION";
  if (status.ending) return "ENDING";
  if (status.tasks.some((task) => task.state === "ERROR")) return "IN ERROR";
  if (status.rtpus.some((rtpu) => !rtpu.alive)) return "RTPU ENDED";
  return status.tasks.some((task) => task.state === "ON") ? "RUNNING" : "IDLE";
}

export function raiseFlag(machine: Machine, isUp: boolean): void {
  if (forbidden(machine.state.get().hello?.role, "operate") === "") void machine.act("flag", { up: isUp });
}

export function Flag({ machine, state }: { machine: Machine; state: MachineState }) {
  const flag = state.status?.flag ?? { up: false, by: [] };
  const isOwn = flag.by.includes("operator");
  const why = forbidden(state.door === "open" ? state.hello?.role : undefined, "operate");
  return (
    <div className={`flag ${flag.up ? "up" : ""}`}>
      {flag.up && <span role="status" data-flag-by>FLAG up: {flag.by.join(", ")}</span>}
      {isOwn && <Button label="Lower the FLAG" forbidden={why} press={() => raiseFlag(machine, false)} />}
      <Button label="Raise the FLAG" className="raise" forbidden={why} isPressed={isOwn}
              title="illegal-configuration flag: every safe task goes to its safe state (key Shift-F)"
              press={() => raiseFlag(machine, true)}>FLAG</Button>
    </div>
  );
}

function MachineMenu({ machines, name }: { machines: MachineName[]; name: string }) {
  const known = machines.some((one) => one.name === name) || name === "" ? machines
    : [{ name, service: false }, ...machines];
  return (
    <select aria-label="Subsystem" value={name}
            onChange={(event) => view.set({ machine: event.target.value, chosen: [], variable: "" })}>
      {name === "" && <option value="">no subsystem runs</option>}
      {known.map((one) => <option key={one.name} value={one.name}>{one.name}{one.service ? " (service)" : ""}</option>)}
    </select>
  );
}

/** Acts on the whole subsystem that a person needs seldom. */
function MoreMenu({ machine, state }: { machine: Machine; state: MachineState }) {
  const [isOpen, open] = useState(false);
  const why = forbidden(state.hello?.role, "configure");
  const drill = async () => {
    const answer = await machine.act("drill", {});
    if (!answer) return;
    const tasks = (answer.tasks as { task: string; verdict: string }[]).map((one) => `${one.task} ${one.verdict}`);
    const after = Math.round(answer.flag_ns / 1e6);
    machine.say(`Drill: ${answer.safe ? "safe" : "NOT safe"} after ${after} ms: ${tasks.join(", ")}.`);
  };
  return (
    <div className="menu" onKeyDown={onEscape(() => open(false))}>
      <Button label="More acts" isPressed={isOpen} press={() => open(!isOpen)}>More ▾</Button>
      {isOpen && (
        <ul className="sheet" aria-label="More acts">
          <li><Button label="Drill" forbidden={why} press={() => { open(false); ask({
            title: `Drill ${state.name}?`, button: "Drill", carryOut: () => void drill(),
            text: "The FLAG goes up until every hardware task is safe, for 10 s at most: the machine stops. Then the " +
              "FLAG goes down, and tasks go on." }); }} />
            <span className="plan">raise the FLAG and see whether every hardware task is safe</span></li>
          <li><Button label="End the subsystem" forbidden={why} press={() => { open(false); ask({
            title: `End ${state.name}?`, button: `End ${state.name}`, carryOut: () => void machine.act("end", {}),
            text: "Every task goes OFF, then every process ends. `chimera run` starts it again." }); }} />
            <span className="plan">all tasks OFF, all processes end</span></li>
        </ul>
      )}
    </div>
  );
}

const FIRST_BOARD = 1024; // the number of the first board among the CPUs: chimera/description/cpu_text.h

export function CpuBars({ status, previous }: { status: Status; previous: Status | null }) {
  return (
    <div className="cpus" role="group" aria-label="Load of each CPU">
      {loads(status, previous).map((load) => {
        const measured = load.measured === null ? "" : load.measured.toFixed(2);
        const name = `${load.cpu < FIRST_BOARD ? `cpu${load.cpu}` : "board"} ${load.rtpus.join(", ")}`;
        const words = `${name}: measured ${measured || "not yet"}, budgets ${load.budgets.toFixed(2)} of ` +
          `${load.capacity}, ${load.missed} missed`;
        const note = load.ended.length > 0 ? `${load.ended.join(", ")} has ended`
          : load.late.length > 0 ? `missed just now: ${load.late.join(", ")}`
          : load.missed > 0 ? `${load.missed} missed` : "all keep their deadlines";
        return (
          <div key={load.cpu} className="cpu" role="img" aria-label={words} title={words} data-cpu={load.cpu}>
            <span>{name}</span>
            <svg viewBox="0 0 100 10" preserveAspectRatio="none" aria-hidden="true">
              <rect className="trough" x="0" y="0" width="100" height="10" />
              <rect className="used" x="0" y="0" width={Math.min(100, 100 * (load.measured ?? 0))} height="10" />
              <rect className="budgets" x={Math.min(99, 100 * load.budgets)} y="0" width="1" height="10" />
              <rect className="capacity" x={100 * load.capacity} y="0" width="1" height="10" />
            </svg>
            <span className="figures-cpu">{measured} / {load.budgets.toFixed(2)}</span>
            <span className="note">{note}</span>
          </div>
        );
      })}
    </div>
  );
}

const MODES: [Mode, string, string][] = [["look", "Look", "see and hold what runs"],
  ["assemble", "Assemble", "build what will run: "]];

function Modes({ mode, file }: { mode: Mode; file: string }) {
  return (
    <div className="modes" role="group" aria-label="Mode">
      {MODES.map(([name, words, title]) => (
        <button key={name} type="button" data-mode-button={name} aria-pressed={mode === name}
                title={name === "look" ? title : title + file}
                onClick={() => { view.set({ mode: name }); go({ doc: "", at: "" }); }}>
          {words}</button>))}
    </div>
  );
}

interface Props {
  machine: Machine | null; state: MachineState | null; machines: MachineName[]; bench: BenchHello | null; name: string;
  mode: Mode; children?: ReactNode;
}

export function Header({ machine, state, machines, bench, name, mode, children }: Props) {
  const role = mode === "look" ? state?.hello?.role : bench?.role;
  const isLooking = mode === "look";
  const isReading = useStore(place).doc !== "";
  return (
    <header>
      <MachineMenu machines={machines} name={name} />
      {bench !== null && bench.file !== null && <Modes mode={mode} file={bench.file} />}
      {state && <strong className="state-word" data-state-word>{stateWord(state)}</strong>}
      {state?.status && <span className="in-force" data-in-force>
        {state.status.configuration === "" ? "no named configuration" : state.status.configuration}</span>}
      {isLooking && machine && state && <SwitchMenu machine={machine} state={state} />}
      {isLooking && machine && state && <MoreMenu machine={machine} state={state} />}
      <Button label="Library" title="components and documents: key /" isPressed={isReading}
              press={() => go({ doc: isReading ? "" : "library", at: "" })}>Library</Button>
      <Button label="Find" press={() => view.set({ isFinding: true })} title="Ctrl-K">Find</Button>
      <Button label="Help" press={() => view.set({ isHelping: true })} title="key ?">?</Button>
      {role !== undefined && role !== "configure" &&
        <span className="role" title="Acts that need more are grey and say why">{bench?.user ?? "you"}: {role}</span>}
      {children}
      <span className="space" />
      {machine && state && <Flag machine={machine} state={state} />}
    </header>
  );
}
