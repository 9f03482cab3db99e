// SPDX-License-Identifier: Apache-2.0
// The page: one connection to chimera-web, one to the chosen subsystem, and what they show.
import { MouseEvent, useCallback, useEffect, useMemo, useRef, useState } from "react";
import { createRoot } from "react-dom/client";
import { Banner, Banners, benchBanner, machineBanners, MessageBox } from "./banners";
import { bench, door, key, useChoice } from "./bench";
import { Button, QuestionBox } from "./controls";
import { Finder, Help } from "./finder";
import { CpuBars, Header } from "./header";
import { Inspector } from "./inspector";
import { takeKey } from "./keys";
import { Machine, MachineState } from "./machine";
import { Operator } from "./operator";
import { Panels } from "./panels";
import { PictureView } from "./picture";
import type { BenchHello, MachineName } from "./protocol";
import { useStore } from "./store";
import { choose, showVariable, view, zoomBy } from "./view";

/** Tests and style sheets read the state of the page from its root element. */
function mark(names: Record<string, string | number>): void {
  for (const [name, value] of Object.entries(names)) {
    const { dataset } = document.documentElement;
    if (dataset[name] !== String(value)) dataset[name] = String(value);
  }
}

function markMachine(state: MachineState): void {
  const last = state.events[state.events.length - 1]?.number ?? 0;
  mark({
    machine: state.name, door: state.door, version: state.version, role: state.hello?.role ?? "",
    configuration: state.status?.configuration ?? "", events: last, gaps: state.gaps,
    flag: state.status?.flag.up ? "up" : "down", manager: state.hello?.manager.starts ?? 0,
  });
}

/** A picture that does not fit is scrolled rather than drawn with letters that are too small to read. */
const LEAST_FIT = 0.8;

/** Moves the scrolled place while the background is pulled. */
function pull(event: MouseEvent<HTMLDivElement>): void {
  const place = event.currentTarget;
  if (event.button !== 0 || (event.target as Element).closest("[data-task], .link")) return;
  let { clientX, clientY } = event;
  const move = (now: globalThis.MouseEvent) => {
    place.scrollBy(clientX - now.clientX, clientY - now.clientY);
    ({ clientX, clientY } = now);
  };
  const end = () => { window.removeEventListener("mousemove", move); window.removeEventListener("mouseup", end); };
  window.addEventListener("mousemove", move);
  window.addEventListener("mouseup", end);
}

/** Tasks whose rtpu has ended: their values are old. */
function deadTasks(state: MachineState): Set<string> {
  const ended = new Set((state.status?.rtpus ?? []).filter((rtpu) => !rtpu.alive).map((rtpu) => rtpu.name));
  return new Set((state.status?.tasks ?? []).filter((task) => ended.has(task.rtpu)).map((task) => task.task));
}

function MachinePage({ machine, isBenchOpen }: { machine: Machine; isBenchOpen: boolean }) {
  const state = useStore(machine.state);
  const { chosen, variable, panel, zoom } = useStore(view);
  const place = useRef<HTMLDivElement>(null);
  const picture = state.description?.picture;
  const deadNames = [...deadTasks(state)].join("\n");
  const dead = useMemo(() => new Set(deadNames.split("\n")), [deadNames]);
  const fit = useCallback(() => {
    if (!place.current || !picture) return;
    const { clientWidth, clientHeight } = place.current;
    const whole = Math.min((clientWidth - 4) / picture.width, (clientHeight - 4) / picture.height);
    view.set({ zoom: Math.max(LEAST_FIT, Math.min(1.5, whole)) });
  }, [picture]);
  useEffect(() => markMachine(state), [state]);
  useEffect(() => { if (state.version === 1) fit(); }, [state.version, fit]);
  useEffect(() => {
    const take = (event: KeyboardEvent) => takeKey(event, machine, fit);
    window.addEventListener("keydown", take);
    return () => window.removeEventListener("keydown", take);
  }, [machine, fit]);
  return (
    <>
      <Banners banners={machineBanners(state, isBenchOpen)} />
      <MessageBox machine={machine} state={state} />
      {state.status && <CpuBars status={state.status} previous={state.previous} />}
      <main className={isBenchOpen && state.door === "open" && !state.isSilent ? "" : "stale"}>
        <div className="zoom" role="toolbar" aria-label="Zoom of the picture">
          <Button label="Zoom in" title="key +" press={() => zoomBy(1.2)}>+</Button>
          <Button label="Zoom out" title="key -" press={() => zoomBy(1 / 1.2)}>−</Button>
          <Button label="Fit the picture" title="key 0" press={fit}>fit</Button>
        </div>
        <div ref={place} className="canvas" onMouseDown={pull}>
          {picture && state.status
            ? <PictureView picture={picture} tasks={state.status.tasks} before={state.previous?.tasks ?? []} dead={dead}
                           values={machine.values} zoom={zoom} chosen={chosen} variable={variable} choose={choose}
                           showVariable={showVariable} />
            : <p className="hint">{state.door === "gone" ? `${state.name} does not run.` : "Connecting…"}</p>}
          {picture && picture.boxes.length === 0 &&
            <p className="hint">Nothing is loaded: `chimera run FILE` loads tasks.</p>}
        </div>
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
    const take = (event: KeyboardEvent) => takeKey(event, null, () => undefined);
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

function HeaderOf({ machine, name }: { machine: Machine; name: string }) {
  const { machines, hello } = useStore(bench);
  const state = useStore(machine.state);
  return <Header machine={machine} state={state} machines={machines ?? []} bench={hello} name={name} />;
}

function FinderOf({ machine }: { machine: Machine | null }) {
  return <Finder state={machine?.state.get() ?? null} machines={bench.get().machines ?? []} />;
}

function Page() {
  const { door: benchDoor, sentence, hello, machines } = useStore(bench);
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
  const banner: Banner | null = benchBanner(benchDoor, sentence);
  return (
    <>
      {machine ? <HeaderOf machine={machine} name={name} />
        : <Header machine={null} state={null} machines={machines ?? []} bench={hello} name={name} />}
      <QuestionBox />
      {banner && <Banners banners={[banner]} />}
      {machine ? <MachinePage key={name} machine={machine} isBenchOpen={benchDoor === "open"} />
        : <NoMachine hello={hello} machines={machines} />}
      {isFinding && <FinderOf machine={machine} />}
      {isHelping && <Help />}
    </>
  );
}

window.addEventListener("hashchange", () => location.reload());  // a new link was put into this page
window.addEventListener("pagehide", () => door.close());
createRoot(document.getElementById("page")!).render(<Page />);
