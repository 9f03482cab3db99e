// SPDX-License-Identifier: Apache-2.0
// The sequence that runs: the panel "Steps" with all steps, and the large view of an operator with the present one.
import { ReactNode, useEffect } from "react";
import { Banners, machineBanners, MessageBox } from "./banners";
import { bench } from "./bench";
import { Button } from "./controls";
import { PlaceLink } from "./place_link";
import { Flag, stateWord } from "./header";
import { takeKey } from "./keys";
import { forbidden, Machine, MachineState } from "./machine";
import { go, Place } from "./place";
import type { Sequence, Step } from "./protocol";
import { conditionOf, DONE, FAILED, goStep, limitOf, mayGoOn, PAUSED, RUNS, stateWords, SWITCHES, valueOf,
  } from "./sequence";
import { movedTasks, nameOf, StepTile, Thumbnail, wordsOf } from "./step_tile";
import { useStore } from "./store";
import { clock } from "./text";
import { useReading } from "./values";

export const STEPS_PLACE = "steps";
const HERE: Place = { doc: "", at: "" };
const NONE: string[] = [];

/** What the task `sequence` says of itself. */
interface Present {
  number: number; phase: number; step: Step | undefined; words: string;
  /** Of its outputs; "" while they are fresh. */
  age: string;
  isUnderWay: boolean;
  /** Its rtpu, if that has ended. */
  ended: string;
}

function usePresent(machine: Machine, state: MachineState, sequence: Sequence): Present {
  const { reading: step, age } = useReading(machine.values, "sequence_step");
  const { reading: phase } = useReading(machine.values, "sequence_state");
  const number = Number(step?.value ?? 0), now = Number(phase?.value ?? -1);
  const task = state.status?.tasks.find((one) => one.task === "sequence");
  const rtpu = state.status?.rtpus.find((one) => one.name === task?.rtpu);
  const ended = rtpu && !rtpu.alive ? rtpu.name : "";
  const lack = ended !== "" ? `its rtpu ${ended} has ended` : !task || task.state === "ON" ? ""
    : `task sequence is ${task.state}`;
  return { number, phase: now, age, ended, words: lack || stateWords(sequence, now),
    step: sequence.steps[number - 1], isUnderWay: lack === "" && (now === RUNS || now === SWITCHES) };
}

const isLive = (state: MachineState, isBenchOpen: boolean): boolean =>
  isBenchOpen && state.door === "open" && !state.isSilent;

/** Why this person may not act on the sequence. */
const whyNotHere = (state: MachineState): string =>
  forbidden(state.door === "open" ? state.hello?.role : undefined, "operate");

/** Why it begins no step. A process that has ended forgets what it was told. */
const whyNotBegin = (state: MachineState, { ended }: Present): string =>
  whyNotHere(state) || (ended === "" ? "" : `its rtpu ${ended} has ended`);

const begin = (machine: Machine, number: number): void =>
  void machine.act("set", { values: { sequence_go: number } });

interface Shown { machine: Machine; state: MachineState; sequence: Sequence; present: Present }

/** Go and Pause. Go begins no step that runs: it may have become the next one just now. */
function Acts({ machine, state, sequence, present }: Shown) {
  const { number, phase, isUnderWay } = present;
  const why = whyNotHere(state);
  const next = goStep(number, phase);
  return (
    <>
      <Button label="Go" title={`begins step ${next} ${nameOf(sequence.steps[next - 1]!)}`}
              forbidden={whyNotBegin(state, present) || (isUnderWay ? `step ${number} is under way` : "")}
              press={() => begin(machine, next)} />
      <Button label="Pause" title="stays in the present configuration" press={() => begin(machine, 0)}
              forbidden={why || ([PAUSED, FAILED, DONE].includes(phase) ? "no step is under way" : "")} />
      {why !== "" && <span className="soft">{why}</span>}
    </>
  );
}

/** The wait of the present step as a bar and as words. */
function Wait({ machine, step, phase }: { machine: Machine; step: Step; phase: number }) {
  const { reading, age } = useReading(machine.values, "sequence_waited");
  const limit = limitOf(step, phase);
  if (limit === null || typeof reading?.value !== "number") return null;
  const isTimed = step.for !== null && phase === RUNS;
  const words = `${reading.value.toFixed(1)} s of ${isTimed ? step.for : `at most ${step.within ?? "10 s"}`}`;
  return (
    <div className={age === "" ? "wait live" : "wait live old"}>
      <progress value={Math.min(1, reading.value * 1e9 / limit)} aria-label={`Wait of step ${step.number}`}
                aria-valuetext={words} />
      <span data-waited>{words}{phase === SWITCHES && " for the switch"}{age !== "" && `, ${age}`}</span>
    </div>
  );
}

/** The present value of the variable of `until`. */
function ConditionValue({ machine, until }: { machine: Machine; until: string }) {
  const condition = conditionOf(until)!;
  const { reading, age } = useReading(machine.values, condition.variable);
  const { variable, element } = condition;
  return (
    <div className={age === "" && reading?.valid !== false ? "now live" : "now live old"}>
      {variable}{element === null ? "" : `[${element}]`} is{" "}
      <span data-condition-value>{reading ? valueOf(condition, reading) : "not known"}</span>
      {age !== "" && `, ${age}`}
    </div>
  );
}

/** The last word of the sequence or of a person about it: why it stands. */
function LastNote({ state }: { state: MachineState }) {
  const isNote = ({ kind, task, text }: MachineState["events"][number]) =>
    kind === "note" && task === "sequence" || kind === "set" && text.startsWith("sequence_go ");
  const event = [...state.events].reverse().find(isNote);
  if (!event) return null;
  return <p className="soft" data-note>{clock(event.wall_ns)} {event.text}{event.by && ` by ${event.by}`}</p>;
}

/** State, wait and condition of the present step. */
function PresentStep({ machine, present }: { machine: Machine; present: Present }) {
  const { step, phase, words, age, isUnderWay } = present;
  return (
    <>
      <p className={age === "" ? "live state-of" : "live state-of old"} data-sequence-state={phase}>
        <span role="status">{words}</span>{age !== "" && `, ${age}`}</p>
      {step && isUnderWay && <Wait machine={machine} step={step} phase={phase} />}
      {step && step.until !== null && conditionOf(step.until) &&
        <ConditionValue key={step.until} machine={machine} until={step.until} />}
    </>
  );
}

/** All steps, in the panel. */
export function StepsPanel({ machine, state, sequence }: Omit<Shown, "present">) {
  const present = usePresent(machine, state, sequence);
  const { door } = useStore(bench);
  const { configurations = [], picture } = state.description ?? {};
  const tasksOf = (step: Step) => configurations.find(({ name }) => name === step.switch)?.tasks ?? NONE;
  return (
    <div className={isLive(state, door === "open") ? "" : "stale"}>
      <div className="acts">
        <Acts machine={machine} state={state} sequence={sequence} present={present} />
        <PlaceLink to={{ doc: STEPS_PLACE, at: "" }} go={go}>Large view</PlaceLink>
        <span className="soft">after an error: {mayGoOn(sequence)}</span>
      </div>
      {!present.step && <PresentStep machine={machine} present={present} />}
      <LastNote state={state} />
      <ol className="steps" aria-label="Steps">
        {sequence.steps.map((step, i) => {
          const tasks = tasksOf(step);
          const before = tasksOf(sequence.steps[i - 1] ?? (sequence.repeat ? sequence.steps.slice(-1)[0]! : step));
          return <StepTile key={step.number} number={step.number} name={nameOf(step)} isPresent={step === present.step}
                    words={[...wordsOf(step), movedTasks(tasks, before)].filter((words) => words !== "")}
                    mark={["data-step-name", nameOf(step)]}
                    thumbnail={picture && <Thumbnail picture={picture} tasks={tasks} before={before} />}>
            {step === present.step && <PresentStep machine={machine} present={present} />}
            <Button label={`Begin step ${step.number} ${nameOf(step)}`} press={() => begin(machine, step.number)}
                    forbidden={whyNotBegin(state, present)}>Begin here</Button>
          </StepTile>;
        })}
      </ol>
    </div>
  );
}

/** Where the sequence goes from its present step. */
function Ways({ sequence, step }: { sequence: Sequence; step: Step }) {
  const next = sequence.steps[step.number] ?? (sequence.repeat ? sequence.steps[0] : undefined);
  const isLast = !step.until && !step.for;
  return (
    <dl className="ways">
      <div><dt>then</dt><dd data-next>{isLast ? "stays" : next ? `${next.number}. ${nameOf(next)}${
        next.confirm ? ", which waits for Go" : ""}` : "the end"}</dd></div>
      {!isLast && step.within !== null &&
        <div><dt>else, after {step.within}</dt><dd data-else>{step.else ?? "stop"}</dd></div>}
    </dl>
  );
}

function Large({ machine, state, sequence }: Omit<Shown, "present">) {
  const present = usePresent(machine, state, sequence);
  const { step } = present;
  return (
    <>
      <main className={isLive(state, useStore(bench).door === "open") ? "large" : "large stale"}>
        <p className="soft">{step ? `step ${step.number} of ` : "steps: "}{sequence.steps.length}</p>
        <h1 className={present.age === "" ? "live" : "live old"} data-present={present.number}>
          {step ? nameOf(step) : "no step yet"}</h1>
        {step?.until && <p className="until" data-until>until {step.until}</p>}
        <PresentStep machine={machine} present={present} />
        {step && <Ways sequence={sequence} step={step} />}
        <LastNote state={state} />
      </main>
      <footer className="large-acts">
        <Acts machine={machine} state={state} sequence={sequence} present={present} />
        <span className="space" />
        <Flag machine={machine} state={state} />
      </footer>
    </>
  );
}

/** The page of `&doc=steps`. */
export function StepsPage({ machine, state }: { machine: Machine | null; state: MachineState | null }) {
  const close = () => go(HERE);
  const isBenchOpen = useStore(bench).door === "open";
  useEffect(() => {
    const take = (event: KeyboardEvent) => {
      if (event.key === "Escape" && !event.defaultPrevented) close();
      else takeKey(event, machine, () => undefined, () => false);
    };
    window.addEventListener("keydown", take);
    return () => window.removeEventListener("keydown", take);
  }, [machine]);
  const sequence = state?.description?.sequence;
  const nothing: ReactNode = <main><p className="hint empty">{!state ? "Nothing runs."
    : state.description ? `${state.name} has no sequence.` : state.door === "gone" ? `${state.name} does not run.`
    : "Connecting…"}</p></main>;
  return (
    <>
      <header>
        {state && <>
          <strong>{state.name}</strong> <strong className="state-word" data-state-word>{stateWord(state)}</strong>
          <span className="in-force" data-in-force>{state.status?.configuration}</span></>}
        <span className="space" />
        <Button label="Back to the page" title="Escape" press={close} />
      </header>
      {state && <Banners banners={machineBanners(state, isBenchOpen)} />}
      {machine && state && <MessageBox machine={machine} state={state} />}
      {machine && state && sequence
        ? <Large key={state.name} machine={machine} state={state} sequence={sequence} /> : nothing}
    </>
  );
}
