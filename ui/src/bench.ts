// SPDX-License-Identifier: Apache-2.0
// The connection to chimera-web: which subsystems run, and which of them the page shows first.
import { useEffect, useState } from "react";
import { Door, DoorState } from "./door";
import { draft } from "./draft";
import type { BenchHello, Hello, MachineName } from "./protocol";
import { Store, useStore } from "./store";
import { joinPath } from "./text";
import { Mode, View, view } from "./view";

interface BenchState { door: DoorState; sentence: string; hello: BenchHello | null; machines: MachineName[] | null }

/** The link has the key behind `#`, and perhaps wishes behind `&`. */
export const [key = "", ...wishes] = location.hash.slice(1).split("&");
export const bench = new Store<BenchState>({ door: "connecting", sentence: "", hello: null, machines: null });

export const door = new Door("/bench", key, {
  opened: (open) => void begin(open).catch(() => undefined),  // a loss is said by `changed`
  changed: (state, sentence) => bench.set({ door: state, sentence }),
  note: (method, parameters) => {
    if (method === "machines") bench.set({ machines: parameters.machines });
    if (method === "draft") draft.note(parameters);
  },
});

async function begin(open: Door): Promise<void> {
  const hello: BenchHello = await open.call("hello");
  bench.set({ hello });
  await open.call("subscribe", { to: "machines" });
  if (hello.file !== null) await draft.begin(open);
}

/** The subsystem that runs the file of the link: asks each one for its file. "" if none runs it. */
async function machineOf(file: string, machines: MachineName[]): Promise<string> {
  const asked = machines.map((one) => new Promise<string>((resolve) => {
    const asking: Door = new Door(`/machine/${encodeURIComponent(one.name)}`, key, {
      opened: () => void asking.call("hello").then(
        (hello: Hello) => resolve(joinPath(hello.folder, hello.file) === file ? one.name : ""), () => resolve(""))
        .finally(() => asking.close()),
      changed: (state) => { if (state !== "open" && state !== "connecting") resolve(""); },
      note: () => undefined,
    });
  }));
  return (await Promise.all(asked)).find((name) => name !== "") ?? "";
}

/** The mode that the page shows: without a subsystem that runs FILE the draft, until a person chooses. */
export const modeOf = ({ mode, machine }: View, hello: BenchHello | null): Mode =>
  hello === null || hello.file === null ? "look" : mode || (machine === "" ? "assemble" : "look");

/** Chooses the subsystem that the page shows first: that of the link; the one before, if the page is loaded again; that
 *  of the file, also when it starts later; the one before; the first of the list. */
export function useChoice(): void {
  const { machines, hello } = useStore(bench);
  const [isDone, done] = useState(false);
  useEffect(() => {
    if (isDone || !machines || !hello) return;
    const { machine: before, bench: pid } = view.get();
    const choose = (machine: string) => {
      view.set({ machine, bench: hello.pid, ...(pid !== hello.pid && machine === "" ? { mode: "" } : {}),
        ...(machine === before ? {} : { chosen: [], variable: "" }) });
      if (machine !== "") done(true);
    };
    const wished = wishes.map((one) => one.split("=")).find(([name]) => name === "machine")?.[1];
    const isThere = machines.some((one) => one.name === before);
    if (wished !== undefined) return choose(decodeURIComponent(wished));
    if (isThere && (pid === hello.pid || hello.file === null)) return choose(before);
    if (hello.file === null) return machines.length > 0 ? choose(machines[0]!.name) : undefined;
    let isNeeded = true;
    void machineOf(hello.file, machines).then((name) => { if (isNeeded) choose(name); });
    return () => { isNeeded = false; };
  }, [machines, hello, isDone]);
}
