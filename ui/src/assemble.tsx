// SPDX-License-Identifier: Apache-2.0
// The mode Assemble: the draft of FILE as a picture, as fields and as text.
import { memo, useEffect, useMemo, useState } from "react";
import { AddTask, AssemblyForm, VariableForm } from "./assembly_form";
import { MessageBox } from "./banners";
import { Canvas, useFit } from "./canvas";
import { draft, DraftState, lamps } from "./draft";
import { DraftPicture } from "./draft_picture";
import { pulledActs } from "./edits";
import { focusField } from "./edit_field";
import { DraftCpus, FaultList } from "./fault_list";
import { boxOf, stepOf } from "./faults";
import { assembleKeys, takeKey } from "./keys";
import { DraftBanners, runsFile, whyNot } from "./lamps";
import { meanAndLongest } from "./load";
import { Machine, MachineState } from "./machine";
import { mark } from "./marks";
import type { BenchHello, Fault, LibraryComponent, Outline, TaskPort } from "./protocol";
import { chooseBox, goToStep, SequenceForm, StepsPanel } from "./steps_panel";
import { useStore } from "./store";
import { TaskForm } from "./task_form";
import { taskAt } from "./text_places";
import { TextPanel, TextPlace } from "./text_panel";
import { tried } from "./trial";
import { TryPanel } from "./try";
import { choose, showVariable, view } from "./view";

export function markDraft(state: DraftState): void {
  if (!state.draft) return;
  const { analysis, version, touched, outside } = state.draft;
  const lamp = lamps(state);
  mark({
    draft: version, touched: touched ? "yes" : "no", outside: outside ? "yes" : "no", undo: state.past.length,
    verdict: !analysis.outline ? "unreadable" : analysis.report.legal ? "legal" : "faulty",
    lampFile: lamp.file, lampMachine: lamp.machine,
  });
}

/** Names for fields: variables and constants with unit and producer, components, reactions. */
const Lists = memo(function Lists({ outline, library }: { outline: Outline | null; library: LibraryComponent[] }) {
  const known = (isConstant: boolean) => (outline?.variables ?? []).filter((one) => one.constant === isConstant)
    .map((one) => (
      <option key={one.variable} value={one.variable}>{one.unit === "1" ? "" : `${one.unit}, `}{
        one.producers.length > 0 ? `from ${one.producers.map((end) => end.task).join(", ")}`
          : one.origin ?? "no producer"}</option>));
  const plain = (words: string[]) => words.map((one) => <option key={one} value={one} />);
  const switches = (outline?.configurations ?? []).map((one) => `{switch: ${one.configuration}}`);
  return (
    <>
      <datalist id="known">{known(false)}</datalist>
      <datalist id="constants-known">{known(true)}</datalist>
      <datalist id="components">{library.map((one) => <option key={one.name} value={one.name}>{one.doc}</option>)}
      </datalist>
      <datalist id="reactions">{plain(["continue", "hold", "skip", "abort", "demote", "error", "flag", "stop",
        ...switches])}</datalist>
      <datalist id="fault-reactions">{plain(["error", "flag", "stop", ...switches])}</datalist>
    </>
  );
});

function Empty({ state, why }: { state: DraftState; why: string }) {
  const { file, exists, analysis } = state.draft!;
  if (standingStill(state, "") !== "")
    return <p className="hint">{`The text is no YAML: ${analysis.report.faults[0]?.message ?? ""}. Mend the text.`}</p>;
  return (
    <div className="hint empty">
      <h1>{exists ? `${file} has no task` : `Nothing runs ${file}, and it does not exist yet`}</h1>
      <p>Type the name of a component, press Enter, and add the next; Library finds names by word, port, unit or paper.
        Ports of one name are linked. Buttons at the faults below fill in the rest. Try runs the draft without a file,
        Save writes it.</p>
      <AddTask outline={state.outline} file={file} why={why} />
    </div>
  );
}

/** Reason why the fields of the outline stand still; "": they can be changed. */
function standingStill(state: DraftState, why: string): string {
  const { outline, text } = state.draft!.analysis;
  return why || (outline || text.trim() === "" ? "" : "the text is no YAML: mend the text first");
}

function pressPort({ task, port }: TaskPort): void {
  choose([task]);
  window.setTimeout(() => focusField("link", `${task} ${port}`), 0);  // when the fields of the task are there
}

function link(from: TaskPort, to: TaskPort): void {
  const { outline } = draft.state.get();
  const acts = outline ? pulledActs(outline, from, to) : [];
  if (typeof acts === "string") draft.say(acts, true);
  else void draft.press(acts);
}

interface Props { machine: Machine | null; machineState: MachineState | null; bench: BenchHello; isOpen: boolean }

export function AssemblePage({ machine, machineState, bench, isOpen }: Props) {
  const state = useStore(draft.state);
  const { chosen, variable, zoom, areStepsOpen: wantsSteps } = useStore(view);
  const { isOpen: isTrying } = useStore(tried);
  const [place, setPlace] = useState<TextPlace | null>(null);
  const [line, setLine] = useState(0);
  const { draft: now, picture, outline } = state;
  const [canvas, fit] = useFit(picture);
  const areStepsOpen = wantsSteps && !isTrying && outline !== null;
  const hasPicture = picture !== null && picture.boxes.length > 0;
  // Other acts leave the zoom as it is.
  useEffect(() => { if (hasPicture) fit(); }, [picture?.boxes.length, isTrying, areStepsOpen]);
  useEffect(() => {
    const take = (event: KeyboardEvent) => takeKey(event, machine, fit, assembleKeys);
    window.addEventListener("keydown", take);
    return () => window.removeEventListener("keydown", take);
  }, [machine, fit]);
  const text = now?.analysis.text ?? "";
  const task = outline?.tasks.find((one) => one.task === chosen[0]);
  useEffect(() => {
    if (task && task.line > 0) setPlace({ line: task.line, column: 1, isFocused: false });
  }, [task?.task]);
  const cursorTask = useMemo(() => taskAt(text, outline?.tasks ?? [], line), [text, outline, line]);
  if (!now) return <main><p className="hint">{state.message?.text ?? "Connecting…"}</p></main>;
  const { analysis } = now;
  const why = whyNot(bench, isOpen);
  const still = standingStill(state, why);
  const of = outline?.variables.find((one) => one.variable === variable);
  const go = (fault: Fault) => {
    const box = boxOf(fault, outline), step = stepOf(fault);
    if (step !== null) goToStep(fault, step);
    if (box !== "") choose([box]);
    document.querySelector(`g.box[data-task="${CSS.escape(box)}"]`)
      ?.scrollIntoView({ block: "nearest", inline: "nearest" });
    const there = { line: Math.max(1, fault.line), column: fault.column, isFocused: true };
    window.setTimeout(() => setPlace(there), 0);  // after the line of the box
  };
  const status = runsFile(machineState, bench.file)
    ? machineState?.status?.tasks.find((one) => one.task === task?.task && one.cycles > 0) : undefined;
  const measured = status ? `measured ${meanAndLongest(status)}` : "";
  return (
    <>
      <DraftBanners state={state} why={why} />
      {machine && machineState?.message && <MessageBox machine={machine} state={machineState} />}
      <DraftCpus analysis={analysis} why={still} />
      <Lists outline={outline} library={state.library} />
      <main className={hasPicture && !analysis.picture ? "last" : ""}>
        <Canvas place={canvas} fit={fit}>
          {hasPicture && picture
            ? <DraftPicture picture={picture} faults={analysis.report.faults} zoom={zoom} chosen={chosen} link={link}
                            variable={variable} cursorTask={cursorTask} choose={chooseBox} why={still}
                            showVariable={showVariable} pressPort={pressPort} />
            : <Empty state={state} why={why} />}
        </Canvas>
        <aside aria-label="Details">
          {still !== "" && <p className="hint">{still}</p>}
          {outline && outline.tasks.length > 0 && <AddTask outline={outline} file={now.file} why={still} />}
          {outline && (of ? <VariableForm key={variable} of={of} why={still} />
            : task?.task === "sequence" && outline.sequence ? <SequenceForm />
            : task ? <TaskForm key={task.task} outline={outline} task={task} text={text} why={still}
                               measured={measured} faults={analysis.report.faults} />
            : <AssemblyForm outline={outline} text={text} why={still} />)}
        </aside>
      </main>
      {isTrying && <TryPanel why={why} />}
      {areStepsOpen && <StepsPanel outline={outline} state={state} analysis={analysis} why={still} go={go} />}
      <section className="panels drawer" aria-label="Faults and text" hidden={isTrying || areStepsOpen}>
        <FaultList analysis={analysis} offers={state.offers} why={why} go={go} />
        <TextPanel text={text} why={why} place={place} atLine={setLine} />
      </section>
    </>
  );
}
