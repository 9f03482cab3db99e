// SPDX-License-Identifier: Apache-2.0
// Draft, FILE and machine: are they the same? With Save, Start and Restart, and what follows from a difference.
import { useEffect, useState } from "react";
import { Button } from "./controls";
import { draft, DraftState, lamps, namesOf } from "./draft";
import { forbidden, Machine, MachineState } from "./machine";
import type { BenchHello } from "./protocol";
import { openSteps } from "./steps_panel";
import { joinPath } from "./text";
import { tryDraft } from "./trial";
import { ask } from "./view";

/** Why the draft cannot be changed; "": it can. */
export const whyNot = (bench: BenchHello | null, isOpen: boolean): string =>
  isOpen && bench ? forbidden(bench.role, "configure") : "no connection to chimera-web";

/** Whether the machine runs the FILE of the page. */
export const runsFile = (state: MachineState | null, file: string | null): boolean =>
  state !== null && state.door === "open" && state.hello !== null && file !== null &&
  joinPath(state.hello.folder, state.hello.file) === file;

/** Follows the text of the machine: draft.ts compares it. */
export function useRunningText(machine: Machine | null, isRunning: boolean, version: number): void {
  useEffect(() => {
    if (!machine || !isRunning) return draft.runs(null);
    let isNeeded = true;
    void machine.find("text").then((answer: { text: string } | null) => {
      if (isNeeded && answer) draft.runs(answer.text);
    });
    return () => { isNeeded = false; };
  }, [machine, isRunning, version]);
}

const MOST_NAMES = 5;

function shortNames(paths: string[] | null): string {
  const names = namesOf(paths ?? []);
  if (names.length === 0) return "";
  return ` (${names.slice(0, MOST_NAMES).join(", ")}${names.length > MOST_NAMES ? ", …" : ""})`;
}

/** Ends the machine, and starts FILE when the machine is gone. */
function useRestart(machine: Machine | null, isGone: boolean): () => void {
  const [isAwaited, setAwaited] = useState(false);
  useEffect(() => {
    if (!isAwaited || !isGone) return;
    setAwaited(false);
    void draft.start();
  }, [isAwaited, isGone]);
  return () => void machine?.act("end", {}).then((answer) => setAwaited(answer !== null));
}

interface Props {
  state: DraftState; machine: Machine | null; machineState: MachineState | null; bench: BenchHello | null; why: string;
}

export function Lamps({ state, machine, machineState, bench, why }: Props) {
  const { draft: now, past, future } = state;
  const isRunning = runsFile(machineState, bench?.file ?? null);
  const restart = useRestart(machine, machineState === null || machineState.door === "gone");
  const { file, machine: machineLamp } = lamps(state);
  if (!now) return null;
  const sign = (lamp: string) => (lamp === "same" ? "=" : "≠");
  const ofFile = `draft ${sign(file)} file${file === "same" ? "" : shortNames(state.fromFile)}`;
  const ofMachine = machineLamp === "none" ? (isRunning ? "" : ", no machine runs it")
    : `, draft ${sign(machineLamp)} machine${machineLamp === "same" ? "" : shortNames(state.fromMachine)}`;
  const words = file === "same" && machineLamp === "same" ? "draft = file = machine" : ofFile + ofMachine;
  return (
    <div className="lamps">
      <span role="status" aria-label="Draft, file and machine" data-lamps title={now.file}>{words}</span>
      <Button label="Undo" title="Ctrl-Z" press={() => void draft.undo("undo")}
              forbidden={why || (past.length === 0 ? "no act to undo" : "")}>↶</Button>
      <Button label="Redo" title="Ctrl-Y" press={() => void draft.undo("redo")}
              forbidden={why || (future.length === 0 ? "no act was undone" : "")}>↷</Button>
      <Button label="Save FILE" title={`write ${now.file} (Ctrl-S)`} press={() => draft.write()}
              forbidden={why || (now.outside ? "first take FILE or keep the draft" : "")}>
        Save</Button>
      <Button label="Try" title="run the draft in virtual time (key t)" press={() => void tryDraft()} forbidden={why} />
      <button type="button" data-steps-button title="the sequence of the draft (key s)"
              onClick={openSteps}>Steps</button>
      {!isRunning && <Button label="Start" title={`chimera run ${now.file}`} press={() => void draft.start()}
                             forbidden={why || (now.exists && !now.touched ? "" : "save FILE first")} />}
      {isRunning && machineLamp === "differs" && !now.touched &&
        <Button label="Restart" forbidden={why || forbidden(machineState?.hello?.role, "configure")} press={() => ask({
          title: `Restart ${machineState?.name}?`, button: `Restart ${machineState?.name}`, carryOut: restart,
          text: "Every task goes OFF and every process ends; then FILE is started as it is now. The machine stands " +
            "still in between." })} />}
    </div>
  );
}

/** What a person must know or decide about the draft. */
export function DraftBanners({ state, why }: { state: DraftState; why: string }) {
  const { draft: now, running, output, message } = state;
  const fault = now?.analysis.report.faults[0];
  const isRestartNeeded = now !== null && !now.touched && running !== null && lamps(state).machine === "differs";
  return (
    <div className="banners" role="status" aria-label="State of the draft" aria-live="polite">
      {now?.problem && <p className="banner error">{now.problem}</p>}
      {now?.outside && (
        <p className="banner warning" data-outside-banner>{now.file} was changed by another program.{" "}
          <Button label="Take FILE" forbidden={why} press={() => void draft.keep("file")} />{" "}
          <Button label="Keep the draft" forbidden={why} press={() => void draft.keep("draft")} /></p>)}
      {now && !now.analysis.outline && state.outline && (
        <p className="banner warning">The text is no YAML{fault && fault.line > 0 ? ` at line ${fault.line}` : ""}: the
          last picture stands.</p>)}
      {isRestartNeeded && (
        <p className="banner warning">The machine runs an earlier FILE{shortNames(state.fromMachine)}. A restart takes
          the new one: every task goes OFF, every process ends, and FILE is started.</p>)}
      {output !== null && output.ended !== null && output.ended !== "with status 0" && (
        <div className="banner error"><p>What was started ended {output.ended}:</p>
          <pre data-output>{output.text}</pre></div>)}
      {message && (
        <p className={`message ${message.isError ? "error" : "good"}`} role="alert">
          <span data-message>{message.text}</span>
          <Button label="Dismiss" className="quiet" press={() => draft.dismiss()}>✕</Button></p>)}
    </div>
  );
}
