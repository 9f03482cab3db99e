// SPDX-License-Identifier: Apache-2.0
// Tests of the functions behind the panel "Steps": run by `node --test` after esbuild has joined them.
import assert from "node:assert/strict";
import test from "node:test";
import { memberActs, ownTasks } from "./edits";
import { boxOf, stepOf } from "./faults";
import type { EditAct, Fault, Modes, Outline, OutlineTask, OutlineVariable, Sequence, Step, Transition,
  } from "./protocol";
import { addedStep, edgeOf, keyActs, removedStep, repeatActs, swapActs, unitsLike, untilWords } from "./steps";
import { movedTasks, nameOf, wordsOf } from "./step_tile";

const stepWith = (keys: Partial<Step>): Step => ({ number: 1, name: null, switch: null, until: null, for: null,
  within: null, else: null, confirm: false, reentry: false, ...keys });
const sequenceOf = (path: Sequence["path"], ...steps: Partial<Step>[]): Sequence => (
  { line: 9, path, repeat: false, steps: steps.map((keys, i) => stepWith({ number: i + 1, ...keys })) });
const FETCH = { switch: "fetch", until: "q[0] >= 0.8 rad", within: "3 s", else: "home" };
const HOME = { switch: "home", for: "2 s", reentry: true };
const set = (path: string, value: string): EditAct => ({ act: "set", path, value });
const remove = (path: string): EditAct => ({ act: "remove", path });

test("a step says how it ends", () => {
  assert.deepEqual(wordsOf(stepWith(FETCH)), ["until q[0] >= 0.8 rad", "within 3 s, else home"]);
  assert.deepEqual(wordsOf(stepWith({ ...HOME, confirm: true })), ["for 2 s", "waits for Go", "reentry"]);
  assert.deepEqual(wordsOf(stepWith({ until: "x > 1", within: "1 s" })), ["until x > 1", "within 1 s, else stop"]);
  assert.deepEqual(wordsOf(stepWith({ else: "home" })), ["within 10 s, else home", "stays"]);
  assert.deepEqual([FETCH, { ...FETCH, name: "a" }, {}].map((keys) => nameOf(stepWith(keys))), ["fetch", "a", "?"]);
  assert.equal(movedTasks(["arm", "welder"], ["arm", "gripper"]), "arrives: welder; leaves: gripper");
  assert.equal(movedTasks(["arm"], ["arm"]), "");
});

test("each form of a sequence is edited at its own path", () => {
  for (const path of ["sequence", "sequence/steps"] as const) {
    const sequence = sequenceOf(path, FETCH, HOME);
    assert.deepEqual(keyActs(sequence, 1, "for", "3 s"), [set(`${path}/1/for`, "3 s")]);
    assert.deepEqual(keyActs(sequence, 0, "until", "q[1] > 1 rad"), [set(`${path}/0/until`, '"q[1] > 1 rad"')]);
    assert.deepEqual(keyActs(sequence, 0, "within", ""), [remove(`${path}/0/within`)]);
    assert.deepEqual(keyActs(sequence, 1, "until", ""), []);
    assert.deepEqual(keyActs(sequence, 1, "reentry", ""), [remove(`${path}/1/reentry`)]);
    assert.deepEqual(addedStep(sequence, "weld"), [set(`${path}/2`, "{switch: weld}")]);
    assert.deepEqual(addedStep(sequenceOf(path), "weld"), [set(path, "[{switch: weld}]")]);
    assert.deepEqual(removedStep(sequence, 0), [remove(`${path}/0`)]);
    assert.deepEqual(removedStep(sequenceOf(path, HOME), 0), [remove("sequence")]);
  }
  assert.deepEqual(addedStep(null, "weld"), [set("sequence", "[{switch: weld}]")]);
});

test("the list alone becomes a map that repeats, and its steps keep their words", () => {
  const text = "sequence:\n  - {switch: fetch, until: 'q[0] >= 0.8 rad', untl: 1}  # note\n" +
    "  - {switch: home, for: 2 s}\n";
  const list = sequenceOf("sequence", FETCH, HOME);
  assert.deepEqual(repeatActs(text, list, true), [remove("sequence"), set("sequence",
    "{repeat: true, steps: [{switch: fetch, until: 'q[0] >= 0.8 rad', untl: 1}, {switch: home, for: 2 s}]}")]);
  assert.deepEqual(repeatActs("sequence:\n  - switch: home\n    for: 2 s\n", sequenceOf("sequence", HOME), true),
    [remove("sequence"), set("sequence", "{repeat: true, steps: [{switch: home, for: 2 s, reentry: true}]}")]);
  assert.deepEqual(repeatActs(text, sequenceOf("sequence/steps", HOME), true), [set("sequence/repeat", "true")]);
  assert.deepEqual(repeatActs(text, sequenceOf("sequence/steps", HOME), false), [remove("sequence/repeat")]);
});

test("else follows a step that gets another name, if only that step had the name", () => {
  const sequence = sequenceOf("sequence", FETCH, HOME);
  assert.deepEqual(keyActs(sequence, 1, "name", "rest"),
    [set("sequence/1/name", "rest"), set("sequence/0/else", "rest")]);
  assert.deepEqual(keyActs(sequence, 1, "switch", "park"),
    [set("sequence/1/switch", "park"), set("sequence/0/else", "park")]);
  assert.deepEqual(keyActs(sequenceOf("sequence", FETCH, HOME, HOME), 1, "name", "rest"),
    [set("sequence/1/name", "rest")]);
  const named = sequenceOf("sequence", { ...FETCH, else: "rest" }, { ...HOME, name: "rest" });
  assert.deepEqual(keyActs(named, 1, "name", ""), [remove("sequence/1/name"), set("sequence/0/else", "home")]);
});

/** The steps after acts on keys. */
function after(sequence: Sequence, acts: EditAct[]): Step[] {
  const steps = sequence.steps.map((step) => ({ ...step })) as unknown as Record<string, string | boolean | null>[];
  for (const act of acts) {
    if (act.act !== "set" && act.act !== "remove") throw new Error(act.act);
    const [, i, key] = /^sequence\/(\d+)\/(\w+)$/.exec(act.path)!;
    const step = steps[Number(i)]!, isTruth = typeof step[key!] === "boolean";
    if (act.act === "remove") assert.ok(step[key!]);
    step[key!] = act.act === "remove" ? (isTruth ? false : null) : isTruth ? true : act.value.replace(/^"(.*)"$/, "$1");
  }
  return steps as unknown as Step[];
}

test("two steps change places, and no step is empty in between", () => {
  const some = <T>(all: readonly T[]): T => all[Math.floor(Math.random() * all.length)]!;
  const any = (): Step => stepWith({ name: some([null, "a", "b"]), switch: some(["run", "rest", "weld"]),
    until: some([null, "q[0] > 1 rad", "x == true"]), for: some([null, "1 s"]), within: some([null, "2 s"]),
    else: some([null, "stop", "a"]), confirm: some([true, false]), reentry: some([true, false]) });
  for (let turn = 0; turn < 500; ++turn) {
    const sequence = sequenceOf("sequence", any(), any(), any());
    const [i, k] = some<[number, number]>([[0, 1], [1, 2], [2, 0]]);
    const acts = swapActs(sequence, i, k);
    const wanted = [...sequence.steps];
    [wanted[i], wanted[k]] = [sequence.steps[k]!, sequence.steps[i]!];
    assert.deepEqual(after(sequence, acts).map((step) => ({ ...step, number: 0 })),
      wanted.map((step) => ({ ...step, number: 0 })));
    assert.ok(/^(set ?)*(remove ?)*$/.test(acts.map((act) => act.act).join(" ")));
  }
});

const variable = (name: string, more: Partial<OutlineVariable>): OutlineVariable => ({ variable: name, constant: false,
  origin: null, value: null, type: "float64", unit: "1", shape: "", producers: [], consumers: [], ...more });
const from = (task: string) => ({ producers: [{ task, port: "out" }] });
const outline: Outline = {
  subsystem: "cell", start: "run", rtpus: [], sequence: sequenceOf("sequence", FETCH),
  tasks: ["arm", "welder", "sequence"].map((task) => ({ task, standby_for: null }) as OutlineTask),
  configurations: [{ configuration: "run", tasks: ["arm", "sequence"], safe_when: null },
    { configuration: "weld", tasks: ["arm", "welder", "sequence"], safe_when: null }],
  variables: [
    variable("q", { unit: "rad", shape: "[3]", ...from("arm") }),
    variable("closed", { type: "bool", ...from("welder") }), variable("heat", { unit: "K", ...from("welder") }),
    variable("pose", { shape: "[4, 4]", ...from("arm") }),
    variable("log", { type: "string", ...from("arm") }), variable("kp", { constant: true, origin: "constants" }),
    variable("wish", { origin: "operator", unit: "m/s" }), variable("sequence_step", from("sequence"))],
};

test("until is completed by variables of the configuration, relations, values with units", () => {
  const words = (typed: string, configuration: string | null = "weld") => untilWords(outline, configuration, typed);
  assert.deepEqual(words(""), ["q[0] ", "q[1] ", "q[2] ", "closed ", "heat ", "wish "]);
  assert.deepEqual(words("", "run"), ["q[0] ", "q[1] ", "q[2] ", "wish "]);
  assert.deepEqual(words("", null), ["wish "]);
  assert.deepEqual(words("heat"), [">=", "<=", "==", "!=", ">", "<"].map((one) => `heat ${one} `));
  assert.deepEqual(words("closed "), ["closed == ", "closed != "]);
  assert.deepEqual(words("closed =="), ["closed == true", "closed == false"]);
  assert.deepEqual(words("heat > 300"), ["heat > 300 K"]);
  assert.deepEqual(words("q[1] >= -0.5 r"), ["rad", "deg", "mrad", "rev"].map((unit) => `q[1] >= -0.5 ${unit}`));
  assert.deepEqual(words("q[1]<1e-3"), ["rad", "deg", "mrad", "rev"].map((unit) => `q[1]<1e-3 ${unit}`));
  assert.deepEqual(words("wish <="), ["m/s", "mm/s", "km/h"].map((unit) => `wish <= 0 ${unit}`));
  assert.deepEqual(words("pose > 1"), []);
  assert.deepEqual(words("heat > 1", "run"), []);
  assert.deepEqual(unitsLike("deg"), ["deg", "rad", "mrad", "rev"]);
  for (const typed of ["q[", "q[9] > 1 rad", "<", "a b > 1", "q[0] >= x", "é > 1", "=".repeat(50)]) words(typed);
});

const way = (keys: Partial<Transition>): Modes => ({ transitions: [
  { from: "run", to: "weld", way: "fast", cpus: [], constants: [], resources: [], initialised_anew: [], ...keys }] });

test("an edge says how the switch goes, and why", () => {
  const look = (modes: Modes | null, to: string | null = "weld") => {
    const { look, word, why } = edgeOf(modes, "run", to);
    return `${look}: ${word}: ${why}`;
  };
  const cpu = (schedulable: "yes" | "no" | "not-stated", task: string | null) => (
    { cpus: [{ cpu: 1, schedulable, task }] });
  assert.equal(look(null, "run"), "none: no switch: both steps have this configuration");
  assert.equal(look(null), "none: not judged: switches are judged when the draft is legal");
  assert.equal(look(way({}), "home"), "open: refused: no switch leads from run to home");
  assert.equal(look(way(cpu("yes", null))), "fast: fast: the tasks cycle on");
  assert.equal(look(way(cpu("not-stated", "arm"))), "fast: fast: arm has no budget: deadlines not judged");
  assert.equal(look(way(cpu("no", "arm"))), "open: not schedulable: arm may miss its deadline on cpu1");
  assert.equal(look(way({ way: "slow", ...cpu("no", "arm") })), "slow: slow: arm may miss its deadline on cpu1");
  assert.equal(look(way({ way: "slow", resources: [{ resource: "/dev/a", before: "x", after: "y" }] })),
    "slow: slow: resource /dev/a goes from x to y");
  assert.equal(look(way({ way: "slow" })), "slow: slow: tasks leave before others arrive, under the flag");
  const constants = [{ constant: "mass", before: "gripper", after: "welder", tasks: ["arm"] }];
  assert.equal(look(way({ way: "slow-unless-same", constants, initialised_anew: ["arm"] })),
    "slow: slow unless the constants keep their values: " +
    "constant mass comes from welder instead of gripper; initialised anew: arm");
});

const faultAt = (path: string, rule = "key-unknown"): Fault => ({ rule, severity: "error", line: 1, column: 1,
  found: "", expected: "", nearest: "", message: "", remedy: "", set: "", task: "", port: "", path });

test("a fault of the sequence leads to its step", () => {
  const paths: [string, string, number | null][] = [["sequence/2/until", "", 3], ["sequence/steps/0", "", 1],
    ["sequence", "", 0], ["sequence/repeat", "", 0], ["", "sequence-wait", 0], ["sequence/1/else", "sequence-step", 2],
    ["sequencer/1", "", null], ["tasks/sequence", "name-illegal", null], ["operator/sequence_go", "", null]];
  for (const [path, rule, step] of paths) assert.equal(stepOf(faultAt(path, rule)), step, `${path} ${rule}`);
  assert.equal(boxOf(faultAt("sequence/1/for"), outline), "sequence");
  assert.equal(boxOf(faultAt("tasks/arm/rate"), outline), "arm");
});

test("no act writes the task that the key makes", () => {
  assert.deepEqual(ownTasks(outline).map((one) => one.task), ["arm", "welder"]);
  assert.deepEqual(memberActs("", outline, "run", "welder", true), [set("configurations/run", "[arm, welder]")]);
  assert.deepEqual(ownTasks({ ...outline, sequence: null }).length, 3);
});
