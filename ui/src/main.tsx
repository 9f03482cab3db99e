// SPDX-License-Identifier: Apache-2.0
// The page: one connection to chimera-web, one to the chosen subsystem, and what they show.
import { lazy, ReactNode, Suspense, useEffect, useMemo, useState } from "react";
import { createRoot } from "react-dom/client";
import { AssemblePage, markDraft } from "./assemble";
import { nameOfFile } from "./assembly_form";
import { Banner, Banners, benchBanner, machineBanners, MessageBox } from "./banners";
import { bench, door, key, modeOf, useChoice } from "./bench";
import { Canvas, useFit } from "./canvas";
import { QuestionBox } from "./controls";
import { draft } from "./draft";
import { Finder, Help, Names } from "./finder";
import { CpuBars, Header } from "./header";
import { Inspector } from "./inspector";
import { lookKeys, takeKey } from "./keys";
import { addedTask } from "./library_acts";
import { Lamps, runsFile, useRunningText, whyNot } from "./lamps";
import { meanAndLongest } from "./load";
import { Machine, MachineState } from "./machine";
import { mark } from "./marks";
import { Operator } from "./operator";
import { Panels } from "./panels";
import { PictureView } from "./picture";
import { followAddress, go, Place, place } from "./place";
import type { BenchHello, MachineName } from "./protocol";
import type { LibraryComponent } from "./search";
import { STEPS_PLACE, StepsPage } from "./sequence_view";
import { Store, useStore } from "./store";
import { choose, showVariable, view } from "./view";

function markMachine(state: MachineState): void {
  const last = state.events[state.events.length - 1]?.number ?? 0;
  mark({
    machine: state.name, door: state.door, version: state.version, role: state.hello?.role ?? "",
    configuration: state.status?.configuration ?? "", events: last, gaps: state.gaps,
    flag: state.status?.flag.up ? "up" : "down", manager: state.hello?.manager.starts ?? 0,
  });
}

/** Tasks whose rtpu has ended: their values are old. */
function deadTasks(state: MachineState): Set<string> {
  const ended = new Set((state.status?.rtpus ?? []).filter((rtpu) => !rtpu.alive).map((rtpu) => rtpu.name));
  return new Set((state.status?.tasks ?? []).filter((task) => ended.has(task.rtpu)).map((task) => task.task));
}

function MachinePage({ machine, state, isBenchOpen }:
  { machine: Machine; state: MachineState; isBenchOpen: boolean }) {
  const { chosen, variable, panel, zoom } = useStore(view);
  const picture = state.description?.picture;
  const deadNames = [...deadTasks(state)].join("\n");
  const dead = useMemo(() => new Set(deadNames.split("\n")), [deadNames]);
  const [place, fit] = useFit(picture);
  useEffect(() => { if (state.version === 1) fit(); }, [state.version, fit]);
  useEffect(() => {
    const take = (event: KeyboardEvent) => takeKey(event, machine, fit, lookKeys);
    window.addEventListener("keydown", take);
    return () => window.removeEventListener("keydown", take);
  }, [machine, fit]);
  return (
    <>
      <Banners banners={machineBanners(state, isBenchOpen)} />
      <MessageBox machine={machine} state={state} />
      {state.status && <CpuBars status={state.status} previous={state.previous} />}
      <main className={isBenchOpen && state.door === "open" && !state.isSilent ? "" : "stale"}>
        <Canvas place={place} fit={fit}>
          {picture && state.status
            ? <PictureView picture={picture} tasks={state.status.tasks} before={state.previous?.tasks ?? []} dead={dead}
                           values={machine.values} zoom={zoom} chosen={chosen} variable={variable} choose={choose}
                           showVariable={showVariable} />
            : <p className="hint">{state.door === "gone" ? `${state.name} does not run.` : "Connecting…"}</p>}
          {picture && picture.boxes.length === 0 &&
            <p className="hint">Nothing is loaded: `chimera run FILE` loads tasks.</p>}
        </Canvas>
        <aside aria-label="Details">
          <Operator machine={machine} state={state} />
          <Inspector machine={machine} state={state} chosen={chosen} />
        </aside>
      </main>
      <Panels machine={machine} state={state} panel={panel} chosen={chosen} variable={variable} />
    </>
  );
}

function NoMachine({ hello, machines }: { hello: BenchHello | null; machines: MachineName[] | null }) {
  useEffect(() => {
    const take = (event: KeyboardEvent) => takeKey(event, null, () => undefined, lookKeys);
    window.addEventListener("keydown", take);
    return () => window.removeEventListener("keydown", take);
  }, []);
  if (machines === null) return <main><p className="hint">Connecting…</p></main>;
  return (
    <main><div className="hint empty">
      <h1>Nothing runs{hello?.file ? ` ${hello.file}` : ""}</h1>
      <p>{hello?.file ? `Type \`chimera run ${hello.file}\`` : "Type `chimera run FILE`"} in a terminal; this page shows
        it as soon as it runs.</p>
      {machines.length > 0 && <p>Subsystems that run: choose one above.</p>}
    </div></main>
  );
}

const callBench = (method: string, parameters: object = {}) => door.call(method, parameters);
const NO_MACHINE = new Store<MachineState | null>(null);

/** Execution times of the tasks of a component in the subsystem that runs. */
function measuredHere(state: MachineState | null, component: string): string {
  const tasks = (state?.door === "open" && state.status?.tasks || []).filter(
    (task) => task.component === component && task.cycles > 0);
  return tasks.length === 0 ? "not measured here: nothing runs that uses it"
    : `measured here: ${tasks.map((task) => `${task.task} ${meanAndLongest(task)}`).join("; ")}`;
}

/** Loaded when it is opened: the first picture does not wait for it. */
const LibraryPage = lazy(() => import("./library").then(({ LibraryPage: page }) => ({ default: page }),
  () => ({ default: () => <p className="fault">The library could not be loaded: reload the page.</p> })));

/** The library and its documents, beside the canvas of the draft if there is one. */
function Reading({ at, machine, state, canvas, why, isOpen }: {
  at: Place; machine: Machine | null; state: MachineState | null; canvas: ReactNode; why: string; isOpen: boolean;
}) {
  const isAssembling = Boolean(canvas);
  useEffect(() => {
    const take = (event: KeyboardEvent) => takeKey(event, machine, () => undefined, () => false);
    if (!isAssembling || at.doc !== "library") window.addEventListener("keydown", take);
    return () => window.removeEventListener("keydown", take);
  }, [machine, isAssembling, at.doc]);
  const add = async (component: LibraryComponent, port?: string) => {
    await draft.settled();
    const { outline, draft: now } = draft.state.get();
    if (why !== "" || !now) return;
    const [name, acts] = addedTask(outline, outline?.subsystem || nameOfFile(now.file), component, port);
    await draft.press(acts);
    choose([name]);
    go({ doc: "library", at: "" });
  };
  if (!isOpen) return <main><p className="hint">Connecting…</p></main>;
  return (
    <Suspense fallback={<main><p className="hint">Loading…</p></main>}>
      <LibraryPage call={callBench} place={at} go={go} close={() => go({ doc: "", at: "" })}
                   measured={(component) => measuredHere(state, component)}
                   {...(isAssembling ? { add, canvas } : {})} />
    </Suspense>);
}

function Modes({ machine, name }: { machine: Machine | null; name: string }) {
  const { door: benchDoor, sentence, hello, machines } = useStore(bench);
  const state = useStore<MachineState | null>(machine?.state ?? NO_MACHINE);
  const mode = modeOf(useStore(view), hello);
  const drafted = useStore(draft.state);
  const isBenchOpen = benchDoor === "open";
  const at = useStore(place);
  const isLarge = at.doc === STEPS_PLACE;
  const assembly = hello && <AssemblePage machine={machine} machineState={state} bench={hello} isOpen={isBenchOpen} />;
  const banner: Banner | null = benchBanner(benchDoor, sentence);
  useRunningText(machine, runsFile(state, hello?.file ?? null), state?.version ?? 0);
  useEffect(() => { if (state) markMachine(state); }, [state]);
  useEffect(() => mark({ mode, place: at.doc }), [mode, at.doc]);
  useEffect(() => { if (drafted.past.length > 0) view.set({ mode }); }, [drafted.past.length > 0]);  // at work
  useEffect(() => markDraft(drafted), [drafted]);
  return (
    <>
      {!isLarge &&
        <Header machine={machine} state={state} machines={machines ?? []} bench={hello} name={name} mode={mode}>
          {mode === "assemble" && <Lamps state={drafted} machine={machine} machineState={state} bench={hello}
                                         why={whyNot(hello, isBenchOpen)} />}
        </Header>}
      <QuestionBox />
      {banner && <Banners banners={[banner]} />}
      {isLarge ? <StepsPage machine={machine} state={state} />
        : at.doc !== ""
        ? <Reading at={at} machine={machine} state={state} why={whyNot(hello, isBenchOpen)} isOpen={isBenchOpen}
                   canvas={mode === "assemble" && assembly} />
        : mode === "assemble" ? assembly
        : machine && state ? <MachinePage key={name} machine={machine} state={state} isBenchOpen={isBenchOpen} />
        : <NoMachine hello={hello} machines={machines} />}
    </>
  );
}

/** The names that Ctrl-K finds: of the draft in the mode Assemble, else of what runs. */
function names(machine: Machine | null): Names {
  const { description } = machine?.state.get() ?? { description: null };
  const { outline } = draft.state.get();
  const all: { tasks: { task: string }[]; variables: { variable: string; constant: boolean }[] } =
    (modeOf(view.get(), bench.get().hello) === "assemble" && outline) || description || { tasks: [], variables: [] };
  return { tasks: all.tasks.map((one) => one.task),
    variables: all.variables.filter((one) => !one.constant).map((one) => one.variable) };
}

function Page() {
  const { door: benchDoor, machines } = useStore(bench);
  const { machine: name, isFinding, isHelping } = useStore(view);
  const [machine, setMachine] = useState<Machine | null>(null);
  useChoice();
  useEffect(() => {
    if (name === "") return setMachine(null);
    const made = new Machine(name, key);
    setMachine(made);
    return () => made.close();
  }, [name]);
  useEffect(() => machine?.retry(), [machine, machines]);
  useEffect(() => mark({ bench: benchDoor, machines: (machines ?? []).length }), [benchDoor, machines]);
  useEffect(() => { document.title = name === "" ? "Chimera" : `${name} - Chimera`; }, [name]);
  return (
    <>
      <Modes machine={machine} name={name} />
      {isFinding && <Finder names={names(machine)} machines={machines ?? []} />}
      {isHelping && <Help />}
    </>
  );
}

window.addEventListener("hashchange", () => {  // a new link was put into this page
  if (location.hash.slice(1).split("&")[0] !== key) location.reload();
});
followAddress();
window.addEventListener("pagehide", () => door.close());
createRoot(document.getElementById("page")!).render(<Page />);
