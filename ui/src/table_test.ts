// SPDX-License-Identifier: Apache-2.0
// Tests of tables, timelines and tuned values without a browser: run by `node --test` after esbuild has joined them.
import assert from "node:assert/strict";
import test from "node:test";
import type { Outline } from "./protocol";
import { curvePath, gapsOf, rangeOf, readTable, reduced, rowAt, ticks, unitsOf } from "./table";
import { blame, MOST_MISSES, MOST_PER_SECOND, TapRecords } from "./tap";
import { tuneActs, writtenValue } from "./tune";

const RECORDING = "t(s),q[0](rad),u(N.m),on,lost\n-0.001,1,,1,0\n0.000,2,5,1,0\n0.003,-3,6,0,2\n";

test("a table has its channels with their units, and empty cells are no values", () => {
  const table = readTable(RECORDING)!;
  assert.deepEqual(table.channels.map((one) => [one.name, one.unit, ...one.values]),
    [["q[0]", "rad", 1, 2, -3], ["u", "N.m", NaN, 5, 6], ["on", "1", 1, 1, 0]]);
  assert.deepEqual([...table.time], [-0.001, 0, 0.003]);
  assert.deepEqual(gapsOf(table), [{ from: 0, to: 0.003, rows: 2 }]);
  assert.deepEqual(unitsOf(table.channels), ["rad", "N.m", "1"]);
  assert.deepEqual([-1, -0.001, 0.001, 0.003, 9].map((at) => rowAt(table, at)), [0, 0, 1, 2, 2]);
  assert.equal(readTable("usage: chimera"), null);
  assert.equal(readTable(""), null);
  const run = readTable("t(s),lost(1)\n0.0,7\n")!;  // a variable of that name
  assert.deepEqual([run.channels[0]?.name, run.lost[0]], ["lost", 0]);
});

test("a long table keeps least and greatest of each part", () => {
  for (let round = 0; round < 50; ++round) {
    const n = 1 + Math.floor(Math.random() * 5000);
    const values = Array.from({ length: n }, () => (Math.random() < 0.02 ? NaN : Math.random() * 2 - 1));
    const lines = values.map((value, i) => `${i * 0.001},${Number.isNaN(value) ? "" : value}`);
    const table = readTable(["t(s),v(m)", ...lines].join("\n"))!;
    const columns = reduced(table, table.channels[0]!);
    assert.ok(columns.length <= 1000);
    const finite = values.filter((value) => !Number.isNaN(value));
    const ends = columns.flatMap((one) => [one.least, one.greatest]).filter((value) => !Number.isNaN(value));
    assert.equal(Math.min(...ends), Math.min(...finite));
    assert.equal(Math.max(...ends), Math.max(...finite));
    if (n <= 1000) assert.equal(columns.length, n);
  }
});

test("an axis holds all values, and its marks are round", () => {
  const channel = (...values: number[]) => ({ name: "v", unit: "m", values: Float64Array.from(values) });
  const [low, high] = rangeOf([channel(-1, 3), channel(NaN, Infinity)]);
  assert.ok(low < -1 && high > 3 && high < 4);
  assert.ok(rangeOf([channel(2, 2)])[0] < 2);
  assert.deepEqual(rangeOf([channel(NaN)]), [0, 1]);
  assert.deepEqual(ticks(0, 1), [0, 0.2, 0.4, 0.6, 0.8, 1]);
  assert.deepEqual(ticks(-0.001, 0.0035), [-0.001, 0, 0.001, 0.002, 0.003]);
  for (let i = 0; i < 500; ++i) {
    const from = Math.random() * 100 - 50, width = 10 ** (Math.random() * 8 - 4);
    assert.ok(ticks(from, from + width).length <= 7);
  }
});

test("a curve holds its values and breaks at gaps", () => {
  const columns = [1, 2, NaN, 3, 4].map((value, at) => ({ at, least: value, greatest: value }));
  const line = (breaks: number[]) => curvePath(columns, (at) => 10 * at, (value) => value, new Set(breaks));
  assert.equal(line([]), "M0.0 1.0h0H10.0V2.0M30.0 3.0h0H40.0V4.0");
  assert.equal(line([1]), "M0.0 1.0h0M10.0 2.0h0M30.0 3.0h0H40.0V4.0");
  const wide = [{ at: 0, least: 1, greatest: 2 }];
  assert.equal(curvePath(wide, (at) => at, (value) => value, new Set()), "M0.0 1.0h0V2.0");
});

const MS = 1e6;

test("a miss names the tasks that had the processor from the release on", () => {
  const tap = new TapRecords();
  tap.add({ rtpu: "servo", lost: 3, records: [
    [0, "run", "busy", 2, 2 * MS], [1 * MS, "release", "pid", 7, 5 * MS], [2 * MS, "run", "busy", 2, 3 * MS],
    [5 * MS, "run", "pid", 2, 2 * MS], [7 * MS, "miss", "pid", 7, 1 * MS], [8 * MS, "flag", null, 1, 0]] });
  tap.add({ rtpu: "beside", lost: 0, records: [[6 * MS, "run", "log", 2, 4 * MS]] });
  const words = (ns: number) => `${ns / MS}ms`;
  const [miss, ...others] = tap.misses(() => ["servo", "beside"]);
  assert.deepEqual(others, []);
  assert.deepEqual([miss?.task, miss?.late, miss?.at], ["pid", MS, 7 * MS]);
  assert.equal(blame(miss!, words), "busy 4ms, pid itself 2ms, log of beside 1ms");
  assert.equal(blame(tap.misses(() => [])[0]!, words), "busy 4ms, pid itself 2ms");
  assert.equal(tap.lost, 3);
  tap.add({ rtpu: "servo", lost: 0, records: [[11 * MS, "drop", "pid", 2, 0], [10 * MS, "run", "busy", 2, 3 * MS],
    [16 * MS, "release", "pid", 9, 5 * MS]] });
  const [drop] = tap.misses(() => []);
  assert.deepEqual([drop?.at, drop?.dropped], [11 * MS, 2]);
  assert.equal(blame(drop!, words), "busy 7ms, pid itself 2ms");
});

test("a timeline has its marks at their places, and keeps 10 s, or one second of very many records", () => {
  const tap = new TapRecords();
  tap.add({ rtpu: "r", lost: 0, records: [[0, "run", "old", 2, MS], [1e9, "release", "a", 1, 0],
    [1e9, "run", "a", 2, 5e9], [6e9, "preempt", "a", 1, 0], [11e9, "run", "b", 2, 0]] });
  assert.equal(tap.keep(), 10e9);
  assert.deepEqual(tap.rows(10e9, 100), [
    { rtpu: "r", task: "a", runs: [[0, 50]], releases: [0], preempts: [50], misses: [] },
    { rtpu: "r", task: "b", runs: [[100, 101]], releases: [], preempts: [], misses: [] }]);
  const records = Array.from({ length: MOST_PER_SECOND + 1 },
    (_, i): [number, string, string, number, number] => [11e9 + i * 10_000, "miss", "a", i, 1]);
  tap.add({ rtpu: "r", lost: 0, records });
  assert.equal(tap.keep(), 1e9);
  assert.deepEqual(tap.rows(1e9, 100).map((row) => row.task), ["a", "b"]);
  assert.equal(tap.misses(() => []).length, MOST_MISSES);
  assert.equal(tap.misses(() => [])[0]?.at, tap.latest);
});

test("present values of operator variables become edits where they differ", () => {
  assert.equal(writtenValue("100 N.m/rad"), "100 N.m/rad");
  assert.equal(writtenValue("[100 90] N.m/rad"), "[100 N.m/rad, 90 N.m/rad]");
  assert.equal(writtenValue("[1 2]"), "[1, 2]");
  assert.equal(writtenValue("true"), "true");
  const variable = (name: string, origin: "operator" | null, value: string | null) => ({
    variable: name, constant: false, origin, value, type: "float64", unit: "1", shape: "", producers: [],
    consumers: [] });
  const outline: Outline = { subsystem: "s", start: "", tasks: [], configurations: [], rtpus: [], sequence: null,
    variables: [variable("kp", "operator", "5 N.m"), variable("kd", "operator", "1"), variable("q", null, null)] };
  const present = new Map([["kp", "7 N.m"], ["kd", "1"], ["q", "3"], ["none", "4"]]);
  assert.deepEqual(tuneActs(outline, present), [{ act: "set", path: "operator/kp", value: "7 N.m" }]);
  assert.deepEqual(tuneActs(outline, new Map()), []);
});
