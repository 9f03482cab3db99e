// SPDX-License-Identifier: Apache-2.0
// What is wrong now, said at once: losses of connections, ended processes, rights that lack, the flag.
import type { DoorState } from "./door";
import { Button } from "./controls";
import { forbidden, Machine, MachineState } from "./machine";
import { carryOut, ACTS } from "./acts";

export interface Banner { kind: "lost" | "error" | "warning"; text: string }

export function benchBanner(door: DoorState, sentence: string): Banner | null {
  if (door === "refused" && sentence.startsWith("this link has no key"))
    return { kind: "error", text: `T${sentence.slice(1)}. The page then goes to the place of this link.` };
  if (door === "refused")
    return { kind: "error", text: "This link is old: chimera-web was started anew. What runs goes on. Open the link " +
      "that `chimera web` printed last; the page goes on where it was." };
  if (door === "lost")
    return { kind: "lost", text: `No connection to chimera-web${sentence && ` (${sentence})`}. What runs goes on; ` +
      "the values below are old. If chimera-web has ended, type `chimera web` and open its link: the page goes on " +
      "where it was." };
  return null;
}

/** Banners of one subsystem. `isBenchOpen`: without chimera-web the loss of the subsystem is said by its banner. */
export function machineBanners(state: MachineState, isBenchOpen: boolean): Banner[] {
  const { name, door, doorSentence, status } = state;
  const banners: Banner[] = [];
  if (isBenchOpen && door === "gone")
    banners.push({ kind: "lost", text: `${name} has ended: ${doorSentence}. The page shows it again when it runs.` });
  if (isBenchOpen && door === "lost")
    banners.push({ kind: "lost", text: `The manager of ${name} does not answer: ${doorSentence || "no connection"}. ` +
      "Tasks go on without it; the values below are old. The page connects again by itself." });
  if (isBenchOpen && state.isSilent)
    banners.push({ kind: "lost", text: `The manager of ${name} has said nothing for 2 s or more. Tasks go on without ` +
      "it; the values below are old. Its keeper replaces a manager that hangs." });
  if (!status || door === "gone") return banners;
  for (const rtpu of status.rtpus) {
    if (!rtpu.alive && rtpu.phase !== "starting")
      banners.push({ kind: "error", text: `rtpu ${rtpu.name} has ended${rtpu.last_end ? `: ${rtpu.last_end}` : ""}. ` +
        "Its values are old." +
        (rtpu.given_up ? ` It is not started again${rtpu.remedy ? `: ${rtpu.remedy}` : ""}.` : "") });
    if (rtpu.hang) banners.push({ kind: "error", text: `rtpu ${rtpu.name} hangs: ${rtpu.hang}` });
    if (rtpu.unguarded) banners.push({ kind: "error", text: rtpu.unguarded });
    if (rtpu.lost_rights) banners.push({ kind: "warning", text: `rtpu ${rtpu.name}: ${rtpu.lost_rights}` });
    if (rtpu.not_real_time)
      banners.push({ kind: "warning", text: `rtpu ${rtpu.name} is not real time: ${rtpu.not_real_time}` });
  }
  if (status.guard?.lack) banners.push({ kind: "error", text: `The guard: ${status.guard.lack}` });
  if (status.keeper.hang) banners.push({ kind: "error", text: `The keeper hangs: ${status.keeper.hang}` });
  if (status.ending) banners.push({ kind: "warning", text: `${name} is ending.` });
  const faulty = status.tasks.filter((task) => task.state === "ERROR");
  if (faulty.length > 0)
    banners.push({ kind: "error", text: `In ERROR: ${faulty.map(
      (task) => task.task + (task.fault ? ` (${task.fault})` : "")).join(", ")}` });
  return banners;
}

export function Banners({ banners }: { banners: Banner[] }) {
  return (
    <div className="banners" role="status" aria-label="State of the subsystem" aria-live="polite">
      {banners.map((banner) => <p key={banner.text} className={`banner ${banner.kind}`}>{banner.text}</p>)}
    </div>
  );
}

/** The answer to the last act, until it is dismissed or the next act comes. */
export function MessageBox({ machine, state }: { machine: Machine; state: MachineState }) {
  const { message } = state;
  const on = ACTS[0]!;
  return (
    <div className="message-place" role="alert" aria-label="Answer">
      {message && (
        <div className={`message ${message.isError ? "error" : "good"}`}>
          <span data-message>{message.text}</span>
          {message.remedy !== "" && <span className="remedy"> {message.remedy}</span>}
          {message.tasks.length > 0 &&
            <Button label={`Turn ON together: ${message.tasks.join(", ")}`}
                    forbidden={forbidden(state.hello?.role, "operate")}
                    press={() => void carryOut(machine, on, message.tasks)} />}
          <Button label="Dismiss" className="quiet" press={() => machine.dismiss()}>✕</Button>
        </div>
      )}
    </div>
  );
}
