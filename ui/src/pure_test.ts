// SPDX-License-Identifier: Apache-2.0
// Tests of all parts that do not need a browser: run by `node --test` after esbuild has joined them.
import assert from "node:assert/strict";
import test from "node:test";
import { ACTS, questionBefore } from "./acts";
import { instanceActs, linkActs, memberActs, pulledActs, quoted, removedTask, renameActs, rtpuActs, valueActs,
  valuePath } from "./edits";
import { boxOf, cpuVerdicts, faultsAt } from "./faults";
import { stepped } from "./history";
import { loads } from "./load";
import { elements, forbidden } from "./machine";
import type { EditAct, Fault, Outline, OutlinePort, OutlineTask, Picture, RtpuStatus, Schedule, Status, TaskStatus,
  } from "./protocol";
import { neighbours, step, toggled } from "./selection";
import { indexAt, lineAt, membersAt, movedCursor, taskAt, wordsAt } from "./text_places";
import { clock, count, duration, joinPath, rate, scalar, short, sliderRange, valueText, withUnit } from "./text";

test("a number has three significant digits and at most seven characters", () => {
  const cases: [number, string][] = [[0, "0"], [-0.4123, "-0.412"], [12.34, "12.3"], [1000, "1000"], [99999, "99999"],
    [123456, "1.2e5"], [1.25e-5, "1.3e-5"], [0.5, "0.5"], [1234.5, "1235"], [-1e-300, "-1e-300"], [Infinity, "inf"],
    [-Infinity, "-inf"], [NaN, "NaN"]];
  for (const [value, words] of cases) assert.equal(short(value), words);
  for (let i = 0; i < 2000; ++i) {
    const value = (Math.random() - 0.5) * 10 ** (Math.random() * 18 - 9);
    assert.ok(short(value).length <= 7, `${value} became ${short(value)}`);
    const least = Math.abs(value) * (short(value).includes("e") ? 0.5 : 0.06);
    assert.ok(Math.abs(Number(short(value)) - value) <= least, `${value} became ${short(value)}`);
  }
});

test("a time has at most five characters up to a hundred days", () => {
  const cases: [number, string][] = [[0, "0ns"], [850, "850ns"], [1000, "1us"], [12_000, "12us"], [3.2e6, "3.2ms"],
    [999_400, "999us"], [999_999, "1ms"], [1.2e9, "1.2s"], [45e9, "45s"], [120e9, "2min"],
    [7200e9, "2h"], [172800e9, "2d"]];
  for (const [ns, words] of cases) assert.equal(duration(ns), words);
  for (let ns = 1; ns < 8e15; ns *= 1.37) assert.ok(duration(ns).length <= 5, `${ns} became ${duration(ns)}`);
});

test("rates, counts and paths are texts of people", () => {
  assert.equal(rate(1000), "1 kHz");
  assert.equal(rate(12.5), "12.5 Hz");
  assert.equal(rate(0), "on events");
  assert.equal(count(9999), "9999");
  assert.equal(count(1234567), "1\u2009234\u2009567");
  assert.equal(joinPath("/a/b", "../c/./d.yaml"), "/a/c/d.yaml");
  assert.equal(joinPath("/a", "/x.yaml"), "/x.yaml");
  assert.ok(/^\d\d:\d\d:\d\d\.125$/.test(clock(1795864262125e6)));
});

test("a value beside its port is short, whatever its type", () => {
  const cases: [unknown, string][] = [[null, "never"], [undefined, "never"], [true, "true"],
    [[1, 2], "1…"], [[], "[]"],
    ["<b>bold</b>", "<b>bol…"], [{ position: [1] }, "{…}"], [[[0.25, 1]], "0.25……"]];
  for (const [value, words] of cases) assert.equal(valueText(value), words);
});

test("a typed number gets the unit of the present value, a quantity keeps its own", () => {
  assert.equal(withUnit("80", "100 N.m/rad"), "80 N.m/rad");
  assert.equal(withUnit(" 1e-3 ", "2 m"), "1e-3 m");
  assert.equal(withUnit("80 mm", "2 m"), "80 mm");
  assert.equal(withUnit("[1, 2]", "[3 4] rad"), "[1, 2]");
  assert.equal(withUnit("7", "6"), "7");
  assert.deepEqual(scalar("100 km/h"), { value: 100, unit: "km/h" });
  assert.equal(scalar("[1 2] rad"), null);
  assert.equal(scalar("true"), null);
});

test("a slider covers its declared range, or both sides of the present value", () => {
  assert.deepEqual(sliderRange(5, 0, 10), [0, 10, 0.05]);
  assert.deepEqual(sliderRange(2), [0, 4, 0.02]);
  assert.deepEqual(sliderRange(-2), [-4, 4, 0.04]);
  assert.deepEqual(sliderRange(0), [0, 2, 0.01]);
});

test("a shape has the number of its elements", () => {
  const cases: [string, number][] = [["", 1], ["[6]", 6], ["[ndof<=10]", 10], ["[3 x 4]", 12], ["[2, 8]", 16]];
  for (const [shape, n] of cases) assert.equal(elements(shape), n, shape);
});

test("a role below what an act needs is said", () => {
  assert.equal(forbidden("configure", "operate"), "");
  assert.equal(forbidden("observe", "operate"), "this needs the role 'operate'; your role here is 'observe'");
  assert.equal(forbidden(undefined, "observe"), "no connection to the subsystem");
});

const box = (task: string, x: number, y: number) => ({ task, x, y, width: 100, height: 50 });
const port = (task: string, name: string, kind: "in-var" | "out-var") =>
  ({ task, port: name, kind, variable: name, x: 0, y: 0 });
const picture: Picture = {
  title: "loop", width: 500, height: 300, lines: [], dots: [], labels: [],
  boxes: [box("path", 0, 0), box("pid", 200, 0), box("arm", 400, 0), box("log", 200, 100)],
  ports: [port("path", "q_ref", "out-var"), port("pid", "q_ref", "in-var"), port("pid", "tau", "out-var"),
    port("arm", "tau", "in-var"), port("arm", "q", "out-var"), port("pid", "q", "in-var")],
};

test("arrow keys go along the lines, and up and down to the nearest box", () => {
  assert.deepEqual(neighbours(picture, "pid", true), ["arm"]);
  assert.deepEqual(neighbours(picture, "pid", false), ["path", "arm"]);
  assert.equal(step(picture, "path", "ArrowRight"), "pid");
  assert.equal(step(picture, "arm", "ArrowRight"), "pid");  // the line goes back
  assert.equal(step(picture, "pid", "ArrowDown"), "log");
  assert.equal(step(picture, "log", "ArrowUp"), "pid");
  assert.equal(step(picture, "pid", "ArrowUp"), "pid");
  assert.equal(step(picture, "no such task", "ArrowUp"), "path");
  assert.deepEqual(toggled(["a", "b"], "a"), ["b"]);
  assert.deepEqual(toggled(["a"], "b"), ["a", "b"]);
});

const task = (name: string, change: Partial<TaskStatus>): TaskStatus => ({
  task: name, component: name, rtpu: "servo", state: "ON", in_service: false, incarnation: 1, rate_hz: 1000,
  period_ns: 1e6, budget_ns: 1e5, busy_ns: 0, on_ns: 0, cycles: 0, execution_ns: { mean: 0, max: 0 },
  response_ns: { max: 0 }, jitter_ns: 0, server: null, has_doorbell: false, missed: 0, overrun: 0, dropped: 0, stale: 0,
  rejected: 0, demoted: 0, fault: null, faults: 0, standby_for: null, inputs: [], ...change,
});
const rtpu = (name: string, alive: boolean): RtpuStatus => ({
  name, cpu: 1, policy: "muf", executor: "executive", pid: 2, alive, phase: "serving", hang: null, restarts: 0,
  last_end: null, given_up: false, remedy: null, running: null, not_real_time: null, lost_rights: null,
  unguarded: null, flag: false,
});
const status = (now: number, tasks: TaskStatus[]): Status => ({
  subsystem: "s", configuration: "", now_ns: now, origin_ns: 1, started_ns: 1, ending: false,
  flag: { up: false, by: [] }, keeper: { pid: 1, hang: null }, guard: null,
  cpus: [{ cpu: 1, budgets: 0.2, capacity: 0.93 }], rtpus: [rtpu("servo", true), rtpu("beside", false)], tasks,
});

test("the load of a CPU is execution time over elapsed time, over all its rtpus", () => {
  const before = status(0, [task("pid", {}), task("arm", { missed: 1, rtpu: "beside" })]);
  const now = status(1e9, [task("pid", { busy_ns: 2e8 }), task("arm", { busy_ns: 1e8, missed: 2, rtpu: "beside" })]);
  const [load, ...others] = loads(now, before);
  assert.ok(load && Math.abs((load.measured ?? 0) - 0.3) < 1e-9);
  assert.deepEqual([load?.late, load?.missed, load?.rtpus, load?.ended], [["arm"], 2, ["servo", "beside"], ["beside"]]);
  assert.deepEqual([load?.budgets, load?.capacity, others], [0.2, 0.93, []]);
  assert.equal(loads(now, null)[0]?.measured, null);
  const restarted = status(2e9, [task("pid", { busy_ns: 5, incarnation: 2 })]);
  assert.equal(loads(restarted, now)[0]?.measured, 0);
});

test("a person is asked only before the kill of a task that is ON", () => {
  const kill = ACTS.find((act) => act.name === "kill")!, off = ACTS.find((act) => act.name === "off")!;
  assert.equal(questionBefore(off, [task("pid", {})], () => undefined), null);
  assert.equal(questionBefore(kill, [task("pid", { state: "OFF" })], () => undefined), null);
  const question = questionBefore(kill, [task("pid", {}), task("arm", { state: "OFF" })], () => undefined);
  assert.equal(question?.title, "Kill pid?");
  assert.equal(question?.button, "Kill pid, arm");
});

test("a ring is offered for tasks that are ON and have a doorbell", () => {
  const ring = ACTS.find((act) => act.name === "ring")!;
  assert.ok(ring.fits(task("lamp", { has_doorbell: true })));
  assert.ok(!ring.fits(task("pid", {})));
  assert.ok(!ring.fits(task("lamp", { has_doorbell: true, state: "OFF" })));
});

const TEXT = `# A loop.
subsystem: loop
constants: {gain: 2, "name: odd": 'a, b'}
tasks:
  path: {component: source, rate: 1 kHz, alias: {out: q_ref}}   # {not: this}
  pid:
    rate: 2 kHz  # twice
    on_miss: {switch: safe,
              }
    constants:
      rate: 3
    in: [a, "b c",
         d]
  arm:
operator: {kp: 1}
configurations:
  run: [path, pid, arm]
  safe: {tasks: [arm], safe_when: 'v < 1'}
  hold:
    - arm  # alone
    - pid
`;

test("the text shows how a value is written, in brackets and in lines", () => {
  const cases: [string, string | null][] = [["subsystem", "loop"], ["tasks/path/rate", "1 kHz"],
    ["tasks/pid/rate", "2 kHz"],
    ["tasks/pid/on_miss", "{switch: safe,\n              }"], ["tasks/pid/constants/rate", "3"], ["tasks/arm", ""],
    ["tasks/arm/rate", null], ["tasks/path/not", null], ["constants/gain", "2"], ["constants/name: odd", "'a, b'"],
    ["tasks/path/alias/out", "q_ref"], ["operator/kp", "1"], ["configurations/safe/safe_when", "'v < 1'"],
    ["none", null]];
  for (const [path, words] of cases) assert.equal(wordsAt(TEXT, path), words, path);
  assert.equal(wordsAt(TEXT.replace(/\n/g, "\r\n"), "tasks/pid/rate"), "2 kHz");
  assert.equal(wordsAt("", "tasks"), null);
  assert.deepEqual(membersAt(TEXT, "configurations/run"),
    { path: "configurations/run", members: ["path", "pid", "arm"] });
  assert.deepEqual(membersAt(TEXT, "configurations/safe"), { path: "configurations/safe/tasks", members: ["arm"] });
  assert.deepEqual(membersAt(TEXT, "configurations/hold"), { path: "configurations/hold", members: ["arm", "pid"] });
  assert.equal(membersAt(TEXT, "configurations/none"), null);
});

test("a line of the text belongs to its task", () => {
  const tasks = [{ task: "path", line: 5 }, { task: "pid", line: 6 }, { task: "arm", line: 14 }];
  const found = [1, 4, 5, 6, 9, 13, 14, 15, 17].map((line) => taskAt(TEXT, tasks, line));
  assert.deepEqual(found, ["", "", "path", "pid", "pid", "pid", "arm", "", ""]);
  assert.equal(lineAt(TEXT, indexAt(TEXT, 7, 5)), 7);
  assert.ok(TEXT.slice(indexAt(TEXT, 7, 5)).startsWith("rate: 2 kHz"));
  assert.equal(indexAt(TEXT, 999), TEXT.length);
});

test("the cursor stays at its words when another act changes the text", () => {
  assert.equal(movedCursor("abcdef", "abXcdef", 1), 1);
  assert.equal(movedCursor("abcdef", "abXcdef", 4), 5);
  assert.equal(movedCursor("abcdef", "ef", 5), 1);
  assert.equal(movedCursor("abcdef", "ef", 2), 0);
  assert.equal(movedCursor("", "abc", 0), 0);
});

const outlinePort = (port: string, kind: OutlinePort["kind"], variable: string | null): OutlinePort => ({
  port, declared: port.replace(/\[.*/, ""), kind, type: "float64", unit: "1", shape: "", solved: true, variable,
  shared: false, parted: false, value: null, default: null, doc: "" });
const outlineTask = (task: string, line: number, ports: OutlinePort[], standby_for: string | null): OutlineTask => ({
  task, line, component: task, known: true, doc: "", rtpu: "main", rate_hz: null, own_rate: false, budget_ns: null,
  criticality: "low", standby_for, ports, repeated: [] });
const outline: Outline = {
  subsystem: "loop", start: "run", variables: [], rtpus: [],
  tasks: [
    outlineTask("path", 5, [outlinePort("out", "out-var", "q_ref"), outlinePort("goal", "in-const", "goal")], null),
    outlineTask("pid", 6, [outlinePort("in[0]", "in-var", "a"), outlinePort("in[1]", "in-var", "b")], "arm"),
    outlineTask("arm", 14, [outlinePort("x", "in-var", null), outlinePort("model", "resource", null)], null)],
  configurations: ["run", "safe", "hold"].map((configuration) => (
    { configuration, tasks: membersAt(TEXT, `configurations/${configuration}`)!.members, safe_when: null })),
  sequence: null,
};
const link = (task: string, port: string, variable: string, instance: number | null = null): EditAct[] =>
  [{ act: "link", task, port, variable, instance }];

test("what is typed in a field is one act", () => {
  assert.deepEqual(valueActs("tasks/pid/rate", "1 kHz", true),
    [{ act: "set", path: "tasks/pid/rate", value: "1 kHz" }]);
  assert.deepEqual(valueActs("tasks/pid/rate", "", true), [{ act: "remove", path: "tasks/pid/rate" }]);
  assert.deepEqual(valueActs("tasks/pid/rate", "", false), []);
  assert.deepEqual(linkActs("pid", outlinePort("in[1]", "in-var", "b"), "c"), link("pid", "in", "c", 1));
  assert.deepEqual(linkActs("arm", outlinePort("x", "in-var", "b"), ""), link("arm", "x", "x"));
  assert.equal(valuePath("path", outlinePort("goal[2]", "in-const", null)), "tasks/path/constants/goal/2");
  assert.equal(valuePath("arm", outlinePort("model", "resource", null)), "tasks/arm/resources/model");
  assert.equal(valuePath("arm", outlinePort("x", "in-var", null)), "");
  assert.deepEqual(["a.xml", "0:100", "a: b", "#x", '"x"', ""].map(quoted),
    ["a.xml", "0:100", '"a: b"', '"#x"', '"x"', ""]);
  assert.deepEqual(instanceActs("sum", { port: "in", kind: "in-var", instances: 2, max_instances: 4, doc: "" }, "c"),
    [{ act: "set", path: "tasks/sum/alias/in/2", value: "c" }]);
  assert.deepEqual(rtpuActs(TEXT, "main", "cpu", "2"), [{ act: "set", path: "rtpus/main", value: "{cpu: 2}" }]);
  const q = { variable: "q", constant: false, origin: null, value: null, type: "", unit: "", shape: "", producers: [],
    consumers: [] };
  assert.deepEqual(renameActs(q, "p"), [{ act: "rename", path: "variables/q", to: "p" }]);
  assert.deepEqual(renameActs({ ...q, origin: "operator" }, "p"), [{ act: "rename", path: "operator/q", to: "p" }]);
});

test("a pulled line links the reader to the variable of the producer, from either end", () => {
  const out = { task: "path", port: "out" }, x = { task: "arm", port: "x" }, second = { task: "pid", port: "in[1]" };
  assert.deepEqual(pulledActs(outline, out, x), link("arm", "x", "q_ref"));
  assert.deepEqual(pulledActs(outline, x, out), link("arm", "x", "q_ref"));
  assert.deepEqual(pulledActs(outline, second, x), link("arm", "x", "b"));
  assert.deepEqual(pulledActs(outline, out, second), link("pid", "in", "q_ref", 1));
  assert.deepEqual(pulledActs(outline, out, out), []);
  assert.equal(typeof pulledActs(outline, out, { task: "path", port: "goal" }), "string");
  assert.equal(typeof pulledActs(outline, out, { task: "arm", port: "model" }), "string");
});

test("a task leaves its configurations and standbys with it", () => {
  assert.deepEqual(memberActs(TEXT, outline, "safe", "pid", true),
    [{ act: "set", path: "configurations/safe/tasks", value: "[arm, pid]" }]);
  assert.deepEqual(memberActs(TEXT, outline, "run", "pid", true), []);
  assert.deepEqual(removedTask(TEXT, outline, "arm"), [
    { act: "set", path: "configurations/run", value: "[path, pid]" },
    { act: "set", path: "configurations/safe/tasks", value: "[]" },
    { act: "set", path: "configurations/hold", value: "[pid]" },
    { act: "remove", path: "tasks/pid/standby_for" }, { act: "remove", path: "tasks/arm" }]);
});

test("each act is one step back, and a new act forgets the steps forward", () => {
  let history = stepped({ past: [], future: [] }, "act", "a", "b");
  assert.deepEqual(stepped(history, "act", "b", "b"), history);
  history = stepped(history, "act", "b", "c");
  assert.deepEqual(history, { past: ["a", "b"], future: [] });
  history = stepped(history, "undo", "c", "b");
  assert.deepEqual(history, { past: ["a"], future: ["c"] });
  assert.deepEqual(stepped(history, "redo", "b", "c"), { past: ["a", "b"], future: [] });
  assert.deepEqual(stepped(history, "act", "b", "x"), { past: ["a", "b"], future: [] });
});

test("a fault leads to its box and port", () => {
  const fault = (change: Partial<Fault>): Fault => ({ rule: "", severity: "error", line: 1, column: 1, found: "",
    expected: "", nearest: "", message: "bad", remedy: "", set: "", task: "", port: "", path: "", ...change });
  const faults = [fault({ task: "pid", port: "in", message: "one" }), fault({ task: "arm", port: "x", message: "two" }),
    fault({ task: "arm", severity: "warning" })];
  assert.equal(faultsAt(faults, "pid", "in[1]"), "one");
  assert.equal(faultsAt(faults, "arm"), "two");
  assert.equal(faultsAt(faults, "arm", "xy"), "");
  assert.equal(boxOf(faults[1]!, outline), "arm");
  assert.equal(boxOf(fault({ path: "tasks/pid/rate" }), outline), "pid");
  assert.equal(boxOf(fault({ path: "tasks/none/rate" }), outline), "");
});

test("a CPU is judged by its worst set", () => {
  const cpu = (utilisation: number, fits: boolean, guarantee: "yes" | "no" | "not-stated") => ({
    cpu: 1, fits, utilisation, limit: 0.93,
    give_way: fits ? [] : ["log"], remedies: [], tasks: [{ task: "pid", guarantee }] });
  const schedule: Schedule = { fits: false, sets: [{ name: "a", fits: true, cpus: [cpu(0.9, true, "yes")] },
    { name: "b", fits: false, cpus: [cpu(0.5, false, "no")] }] };
  const notes = (...sets: Schedule["sets"]) =>
    cpuVerdicts({ fits: true, sets }).map((one) => `${one.set}: ${one.note}`);
  assert.deepEqual(notes(...schedule.sets), ["b: may miss deadlines: pid; the rest fits without log"]);
  assert.deepEqual(notes(schedule.sets[0]!), ["a: all keep their deadlines"]);
  assert.deepEqual(notes({ name: "c", fits: true, cpus: [cpu(0, true, "not-stated")] }), ["c: without a budget: pid"]);
});
