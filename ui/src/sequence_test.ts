// SPDX-License-Identifier: Apache-2.0
// Tests of the words about a sequence that runs.
import assert from "node:assert/strict";
import test from "node:test";
import type { Reading, Sequence, Step } from "./protocol";
import { conditionOf, DONE, goStep, INTERRUPTED, limitOf, mayGoOn, nanoseconds, PAUSED, RUNS, stateWords,
  STATES, SWITCHES, valueOf, variablesOf } from "./sequence";

const step = (number: number, words: Partial<Step>): Step => ({ name: null, switch: "a", until: null, for: null,
  within: null, else: null, confirm: false, reentry: false, ...words, number });
const sequence = (...steps: Partial<Step>[]): Sequence =>
  ({ line: 1, path: "sequence", repeat: false, steps: steps.map((words, i) => step(i + 1, words)) });
const reading = (value: unknown, unit: string): Reading => ({ value, text: "", unit, type: "float64", shape: "",
  producer: "arm", state: "ON", published_ns: 0, age_ns: 0, sequence: 1, valid: true });

test("a time is read as a description writes it", () => {
  const cases: [string | null, number | null][] = [["40 us", 40e3], ["1.5s", 1.5e9], ["1e3 ms", 1e9], ["250 ns", 250],
    ["2 min", 120e9], ["1 h", 3600e9], ["2", null], ["2 m", null], ["s", null], ["1.2.3 s x", null], [null, null]];
  for (const [text, ns] of cases) assert.equal(nanoseconds(text), ns);
});

test("the limit of a wait is that of the step, and of its switch while it switches", () => {
  const until = step(1, { until: "q > 1", within: "3 s" }), wait = step(2, { for: "2 s" });
  assert.deepEqual([until, wait].map((one) => limitOf(one, RUNS)), [3e9, 2e9]);
  assert.deepEqual([until, wait].map((one) => limitOf(one, SWITCHES)), [3e9, 10e9]);
  assert.equal(limitOf(until, PAUSED), null);
});

test("a condition is split as the analyst splits it", () => {
  assert.deepEqual(conditionOf("q_ref[0] >= 0.8 rad"), { variable: "q_ref", element: 0, level: "0.8 rad" });
  assert.deepEqual(conditionOf(" tau [ 12 ]<-1e-3N.m "), { variable: "tau", element: 12, level: "-1e-3N.m" });
  assert.deepEqual(conditionOf("closed==true"), { variable: "closed", element: null, level: "true" });
  assert.deepEqual(conditionOf("n != 2"), { variable: "n", element: null, level: "2" });
  for (const text of [null, "", "q", "q >", ">= 2", "q[x] > 1"]) assert.equal(conditionOf(text), null, text ?? "null");
});

test("the present value has the unit of its condition", () => {
  const cases: [string, unknown, string, string][] = [
    ["d <= 5 mm", 0.0043, "m", "4.3 mm"], ["d <= 5 m", 0.0043, "m", "0.0043 m"], ["d <= 3 in", 0.0043, "m", "0.0043 m"],
    ["q[1] > 0.5 rad", [0, 0.499999], "rad", "0.5 rad"], ["q[1] > 0.5 rad", [0, 0.49996], "rad", "0.49996 rad"],
    ["q[3] > 90 deg", [[0, 0], [0, Math.PI / 2]], "rad", "90 deg"],
    ["q[0] > 0.5 rad", [1.23456e-4], "rad", "0.00012 rad"], ["q[0] > 0 rad", [1.23456e-4], "rad", "0.00012346 rad"],
    ["q[0] > 0 rad", [0], "rad", "0 rad"], ["v < 60 deg/s", Math.PI, "rad/s", "180 deg/s"],
    ["v < 1e-3 km/s", 20, "m/s", "0.02 km/s"], ["n >= 3", 2, "1", "2"], ["ok == true", false, "1", "false"],
    ["q[7] > 0 rad", [1], "rad", "never published"], ["q[0] > 0 rad", null, "rad", "never published"],
    ["m < 500 g", 0.4, "kg", "0.4 kg"]];
  for (const [until, value, unit, words] of cases)
    assert.equal(valueOf(conditionOf(until)!, reading(value, unit)), words, until);
});

test("the page reads the variables of the conditions beside those of the task", () => {
  assert.deepEqual(variablesOf(null), []);
  assert.deepEqual(variablesOf(sequence({ until: "q[2] > 1" }, { for: "1 s" }, {})).slice(3), ["q"]);
});

test("each state has words, an interruption names the steps that go on", () => {
  const two = sequence({ reentry: true }, {}, { reentry: true });
  assert.equal(stateWords(two, INTERRUPTED), "interrupted: may go on with step 1, 3");
  assert.equal(mayGoOn(sequence({})), "no step allows reentry");
  assert.deepEqual(STATES.map((_, state) => stateWords(two, state)).filter((_, state) => state !== INTERRUPTED),
    STATES.filter((word) => word !== "interrupted"));
});

test("Go begins the present step, at the end the first one", () => {
  assert.deepEqual([goStep(0, PAUSED), goStep(3, PAUSED), goStep(3, DONE)], [1, 3, 1]);
});
