// SPDX-License-Identifier: Apache-2.0
// Tests of all parts that do not need a browser: run by `node --test` after esbuild has joined them.
import assert from "node:assert/strict";
import test from "node:test";
import { ACTS, questionBefore } from "./acts";
import { loads } from "./load";
import { elements, forbidden } from "./machine";
import type { Picture, RtpuStatus, Status, TaskStatus } from "./protocol";
import { neighbours, step, toggled } from "./selection";
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
  response_ns: { max: 0 }, jitter_ns: 0, server: null, missed: 0, overrun: 0, dropped: 0, stale: 0, rejected: 0,
  demoted: 0, fault: null, faults: 0, standby_for: null, inputs: [], ...change,
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
