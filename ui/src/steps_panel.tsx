// SPDX-License-Identifier: Apache-2.0
// The panel "Steps": the sequence of the draft as a row of tiles, with the switch from each step to the next.
import { useEffect, useState } from "react";
import { door } from "./bench";
import { Button } from "./controls";
import { draft, DraftState, OFFERS_MS } from "./draft";
import { EditChoice, EditField, focusField } from "./edit_field";
import { FaultLine } from "./fault_list";
import { stepOf } from "./faults";
import type { Analysis, EditAct, Fault, Modes, Outline, Sequence } from "./protocol";
import { movedTasks, nameOf, StepTile, Thumbnail } from "./step_tile";
import { addedStep, Edge, edgeOf, keyActs, MOST_STEPS, removedStep, repeatActs, StepKey, swapActs, untilWords,
  } from "./steps";
import { wordsAt } from "./text_places";
import { tried } from "./trial";
import { choose, view } from "./view";

const PANEL = 'section[aria-label="Steps"]', FIRST = "select, button";

const focusIn = (selector: string) => window.setTimeout(() => (  // when it is there
  document.querySelector<HTMLElement>(`${PANEL} :is(${selector})`)?.focus()), 0);

/** The first control of a tile; of the panel for 0. */
const tileAt = (number: number) => (number === 0 ? FIRST : `[data-step="${number}"] select`);

export function openSteps(): void {
  tried.set({ isOpen: false });
  view.set({ areStepsOpen: true });
  focusIn(FIRST);
}

function closeSteps(): void {
  view.set({ areStepsOpen: false });
  document.querySelector<HTMLElement>("[data-steps-button]")?.focus();
}

/** A press on a box. That of the sequence shows the steps, too. */
export function chooseBox(tasks: string[]): void {
  choose(tasks);
  if (tasks.join() === "sequence" && draft.state.get().outline?.sequence) view.set({ areStepsOpen: true });
}

/** Leads to the field of a step that a fault names, or to its tile. */
export function goToStep({ path }: Fault, number: number): void {
  view.set({ areStepsOpen: true });
  focusIn(tileAt(number));
  window.setTimeout(() => focusField("field", `step ${number} ${path.split("/").pop()}`), 0);
}

/** How the configurations of the draft switch into each other; null: not known, or not yet. */
function useModes(analysis: Analysis): Modes | null {
  const [known, set] = useState<{ of: Analysis; modes: Modes | null } | null>(null);
  useEffect(() => {
    if (!analysis.report.legal) return;
    let isNeeded = true;
    const asking = window.setTimeout(() => void door.call("transitions", { version: analysis.version }).then(
      ({ modes }) => { if (isNeeded) set({ of: analysis, modes }); }, () => undefined), OFFERS_MS);
    return () => { isNeeded = false; window.clearTimeout(asking); };
  }, [analysis]);
  return known?.of === analysis ? known.modes : null;
}

const LINES: Record<Edge["look"], string> = {
  fast: "M0 8C12 2 24 14 38 8", slow: "M0 8h7l4-5 5 10 5-10 5 10 4-5h8", open: "M0 8h12M26 8h12", none: "M0 8h38" };

function EdgeLine({ edge, to }: { edge: Edge; to: string }) {
  return (
    <span className={`edge ${edge.look}`} data-edge={to} title={edge.why}>
      <svg viewBox="0 0 44 16" aria-hidden="true">
        <path d={LINES[edge.look]} /><path className="head" d="M37 4l6 4-6 4z" /></svg>{" "}
      {edge.word} <span className="soft">{to}</span>
    </span>
  );
}

interface Props { outline: Outline; state: DraftState; analysis: Analysis; why: string; go: (fault: Fault) => void }
interface StepProps extends Props { sequence: Sequence; i: number; modes: Modes | null; moved: () => void }

function Faults({ analysis, state, why, go, number }: Props & { number: number }) {
  const press = (_: number, acts: EditAct[]) => {
    focusIn(tileAt(number));
    void draft.press(acts);
  };
  const found = analysis.report.faults.map((fault, at) => ({ fault, at }))
    .filter(({ fault }) => stepOf(fault) === number);
  return found.length === 0 ? null : (
    <ul className="step-faults" aria-label={number === 0 ? "Faults of the sequence" : `Faults of step ${number}`}>
      {found.map(({ fault, at }) => (
        <FaultLine key={at} fault={fault} number={at} offers={state.offers} why={why} go={go} press={press} />))}</ul>);
}

const HINTS: [StepKey, string][] = [["name", "for else and for people; none: the configuration"],
  ["until", "VARIABLE, one of < <= > >= == !=, and a value; ends the step"], ["for", "a time, as 2 s; ends the step"],
  ["within", "most time for the switch, and again for until"]];

/** The keys of a step, each a field. */
function StepFields({ sequence, i, outline, why }: StepProps) {
  const step = sequence.steps[i]!, n = i + 1;
  const field = (key: StepKey) => ({
    label: key, name: `${key} of step ${n}`, mark: ["field", `step ${n} ${key}`] as ["field", string], why,
    commit: (words: string) => draft.edit(keyActs(sequence, i, key, words)) });
  const places: Partial<Record<StepKey, string>> = { name: step.switch ?? "",
    within: step.until === null ? "10 s for the switch" : "required" };
  const plain = (words: string[]) => [...new Set(words)].map((one): [string, string] => [one, one]);
  const fields = HINTS.map(([key, title]) => (
    <EditField key={key} {...field(key)} present={String(step[key] ?? "")} title={title} placeholder={places[key]}
               {...(key === "until" ? { complete: (typed) => untilWords(outline, step.switch, typed) } : {})} />));
  const goal = field("else");
  return (
    <>
      {fields[0]}
      <EditChoice {...field("switch")} present={step.switch ?? ""}
                  options={plain(outline.configurations.map((one) => one.configuration))} />
      {fields.slice(1)}
      <EditChoice {...goal} present={step.else ?? "stop"} options={plain(["stop", ...sequence.steps.map(nameOf)])}
                  commit={(words) => goal.commit(words === "stop" ? "" : words)} />
      {(["confirm", "reentry"] as const).map((key) => (
        <label key={key} className="check" title={why || (key === "confirm" ? "waits for Go before it switches"
          : "the sequence may go on here after an error")}>
          <input type="checkbox" checked={step[key]} disabled={why !== ""} aria-label={`${key} of step ${n}`}
                 onChange={(event) => void draft.press(
                   keyActs(sequence, i, key, event.target.checked ? "true" : ""))} /> {key}</label>))}
    </>
  );
}

function DraftStep(props: StepProps) {
  const { sequence, i, outline, state, why, modes, moved } = props;
  const { steps } = sequence, step = steps[i]!, n = i + 1;
  const tasksOf = (name: string | null | undefined) =>
    outline.configurations.find((one) => one.configuration === name)?.tasks ?? [];
  const before = tasksOf(
    i > 0 ? steps[i - 1]!.switch : sequence.repeat ? steps[steps.length - 1]!.switch : outline.start);
  const tasks = tasksOf(step.switch), words = movedTasks(tasks, before);
  const goal = steps.find((one) => nameOf(one) === step.else);
  const change = async (acts: EditAct[], focused: string) => {
    await draft.press(acts);
    moved();
    focusIn(focused);
  };
  const move = (to: number, way: string) => (
    <Button label={`Move step ${n} ${way}`} forbidden={why || (steps[to] ? "" : `no step is ${way} of it`)}
            press={() => void change(swapActs(sequence, i, to), `button[aria-label="Move step ${to + 1} ${way}"]`)}>
      {way === "left" ? "←" : "→"}</Button>);
  return (
    <StepTile number={n} name={nameOf(step)} words={words ? [words] : []} mark={["data-draft-step", nameOf(step)]}
              isPresent={false} thumbnail={state.picture &&
                <Thumbnail picture={state.picture} tasks={tasks} before={before} />}>
      <Faults {...props} number={n} />
      <StepFields {...props} />
      {goal && <p><EdgeLine edge={edgeOf(modes, step.switch, goal.switch)} to={`else ${step.else}`} /></p>}
      <div className="acts">
        {move(i - 1, "left")}{move(i + 1, "right")}
        <Button label={`Remove step ${n}`} forbidden={why}
                press={() => void change(removedStep(sequence, i), FIRST)}>Remove</Button>
      </div>
    </StepTile>
  );
}

/** One more step, first of a configuration that no step has yet. */
function AddStep({ outline, why }: { outline: Outline; why: string }) {
  const [chosen, set] = useState("");
  const { sequence, configurations } = outline;
  const names = configurations.map((one) => one.configuration);
  const next = names.find((name) => !sequence?.steps.some((step) => step.switch === name)) ?? names[0]!;
  const present = names.includes(chosen) ? chosen : next, n = sequence?.steps.length ?? 0;
  return (
    <>
      <label>configuration <select id="add-step" value={present} disabled={why !== ""} title={why || undefined}
          onChange={(event) => set(event.target.value)}>
        {names.map((name) => <option key={name} value={name}>{name}</option>)}</select></label>
      <Button label="Add step" forbidden={why || (n >= MOST_STEPS ? `a sequence has at most ${MOST_STEPS} steps` : "")}
              press={() => void draft.press(addedStep(sequence, present)).then(() => set(""))} />
    </>
  );
}

export function StepsPanel(props: Props) {
  const { outline, analysis, why } = props;
  const { sequence } = outline;
  const [moves, count] = useState(0);
  const modes = useModes(analysis);
  const steps = sequence?.steps ?? [];
  const hasSets = wordsAt(analysis.text, "configurations") !== null;
  const others = analysis.report.faults.filter((fault) => stepOf(fault) === null).length;
  const addSet = () => {
    choose([]);
    window.setTimeout(() => document.getElementById("add-configuration-name")?.focus(), 0);
  };
  return (
    <section className="panels trial" aria-label="Steps">
      <div className="acts">
        {hasSets ? <AddStep outline={outline} why={why} />
          : <Button label="Add a configuration" forbidden={why} press={addSet} />}
        {sequence && <label className="check" title={why || "the first step follows the last"}>
          <input type="checkbox" checked={sequence.repeat} disabled={why !== ""} aria-label="repeat"
                 onChange={(event) => void draft.press(repeatActs(analysis.text, sequence, event.target.checked))} />
          {" "}repeat</label>}
        <Button label="Close" press={closeSteps} />
        {others > 0 && <span className="soft">{others} more in the list of faults, which Close shows</span>}
      </div>
      {!hasSets && <p className="hint">The text has no configurations. A step switches to a configuration: add one
        first.</p>}
      {hasSets && steps.length === 0 && <p className="hint">A sequence goes through configurations, step by step,
        without a program. Add its first step.</p>}
      <Faults {...props} number={0} />
      <ol className="steps" aria-label="Steps of the sequence">
        {sequence && steps.flatMap((step, i) => {
          const next = steps[i + 1] ?? (sequence.repeat ? steps[0] : undefined);
          const to = steps[i + 1] ? i + 2 : 1;
          return [
            <DraftStep key={`${moves} ${i}`} {...props} sequence={sequence} i={i} modes={modes}
                       moved={() => count((now) => now + 1)} />,
            next && <li key={`edge ${i}`} className="between">
              <EdgeLine edge={edgeOf(modes, step.switch, next.switch)} to={`to step ${to}`} /></li>];
        })}
      </ol>
    </section>
  );
}

/** In place of the fields of a task: the key makes this one. */
export const SequenceForm = () => (
  <article aria-label="Task sequence">
    <h3>sequence</h3>
    <p className="doc">The key <code>sequence</code> makes this task, in every configuration. The steps are changed in
      the panel Steps; rate, rtpu and budget are keys of <code>sequence</code> in the text.</p>
    <Button label="Show the steps" press={openSteps} />
  </article>
);
