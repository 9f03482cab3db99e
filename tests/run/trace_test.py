# SPDX-License-Identifier: Apache-2.0
"""What must hold in every trace of a preemptive processor, in virtual and in real time: docs/formats/trace.md."""
import collections
import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "processes"))
from system import System  # noqa: E402

# `c` uses more than it may and comes below the others, or is late.
APPLICATION = """
subsystem: traced
rtpus:
  only: {cpu: 1, policy: POLICY, executor: preemptive}
tasks:
  a: {component: t_source, rate: 200 Hz, budget: 1 ms, alias: {x: xa, expired: ea}, constants: {spend: 500000 ns}}
  b: {component: t_source, rate: 50 Hz, budget: 8 ms, alias: {x: xb, expired: eb}, constants: {spend: 7000000 ns}}
  c: {component: t_source, rate: 20 Hz, deadline: 15 ms, budget: 2 ms, on_overrun: REACTION,
      alias: {x: xc, expired: ec}, constants: {spend: 12000000 ns}}
configurations: {all: [a, b, c]}
start: all
"""


class Trace(unittest.TestCase):
    def traced(self, policy, reaction, *arguments):
        text = APPLICATION.replace("POLICY", policy).replace("REACTION", reaction)
        with System(text, ("--for", "0.4 s", "--trace", "trace.json", "--json", "--may-miss", "c", *arguments),
                    wait=False) as system:
            self.assertEqual(system.wait(), 0, system.said())
            trace = json.loads((system.place / "trace.json").read_text())
            tasks = {t["task"]: t for t in json.loads(system.said())["tasks"]}
        self.assertEqual(trace["otherData"]["lost_records"], 0)
        return [e for e in trace["traceEvents"] if e["ph"] != "M"], tasks

    def judge(self, events, tasks, is_virtual):
        """In real time the machine decides when a job runs, and without real-time rights how many run at once."""
        self.assertEqual([e["args"]["ns"] for e in events], sorted(e["args"]["ns"] for e in events))
        by = collections.defaultdict(list)
        for event in events:
            by[event["name"], "abc"[event["tid"] - 1]].append(event["args"])
        slices = [(e["args"]["ns"], e["args"]["ns"] + e["args"]["dur_ns"], e["tid"]) for e in events
                  if e["name"] == "cycle"]
        for (_, end, _), (start, _, _) in zip(slices, slices[1:]):
            self.assertTrue(end <= start or not is_virtual, f"two jobs on one processor: {end} {start}")
        for name, task in tasks.items():
            releases = {args["cycle"]: args["ns"] for args in by["release", name]}
            self.assertTrue(releases)
            self.assertEqual({d["cycle"]: d["ns"] for d in by["deadline", name]},
                             {r["cycle"]: r["ns"] + r["deadline_ns"] for r in by["release", name]})
            ends = {end for _, end, tid in slices if "abc"[tid - 1] == name}
            for preempted in by["preempt", name]:
                self.assertIn(preempted["ns"], ends, "the processor is taken from the job that has it")
            self.assertEqual(len(by["hang", name]), 0)
            first = min(releases.values())
            self.assertTrue(all(start >= first for start, _, tid in slices if "abc"[tid - 1] == name))
        self.assertTrue(tasks["b"]["preempted"] > 0 or not is_virtual)
        return by

    def all_is_told(self, by, tasks):
        """In virtual time, where the trace ends with the run."""
        for name, task in tasks.items():
            self.assertGreaterEqual(len(by["release", name]), task["cycles"])
            self.assertEqual(len(by["preempt", name]), task["preempted"])
            self.assertLessEqual(len(by["miss", name]), task["missed"])

    def test_in_virtual_time(self):
        for policy in ("rm", "edf", "muf"):
            with self.subTest(policy):
                events, tasks = self.traced(policy, "continue", "--virtual")
                by = self.judge(events, tasks, True)
                self.all_is_told(by, tasks)
                self.assertEqual(len(by["overrun", "c"]), tasks["c"]["overrun"])
                self.assertEqual(by["overrun", "c"][0]["used_ns"], 12_000_000)
                events, tasks = self.traced(policy, "demote", "--virtual")
                by = self.judge(events, tasks, True)
                self.all_is_told(by, tasks)
                self.assertEqual(len(by["overrun", "c"]), tasks["c"]["demoted"])

    def test_in_real_time(self):
        for policy in ("rm", "edf"):
            with self.subTest(policy):
                events, tasks = self.traced(policy, "demote", "--priority", "40")
                by = self.judge(events, tasks, False)
                for name, task in tasks.items():  # from the first cycle on, and so all that the profile counts
                    releases = by["release", name]
                    self.assertEqual(releases[0]["cycle"], 0, name)
                    self.assertGreaterEqual(len(releases), task["cycles"], name)
                self.assertGreaterEqual(events[0]["args"]["ns"], 0)
                self.assertGreater(tasks["c"]["demoted"], 0)
                self.assertGreaterEqual(len(by["overrun", "c"]), tasks["c"]["overrun"])


if __name__ == "__main__":
    unittest.main(verbosity=1)
