# SPDX-License-Identifier: Apache-2.0
"""Events over real processes: a pipe rings a task behind a server, which rings a task of another rtpu, which rings a
task of the first one. Each event is counted and answered by one job. Events in the other sense, what happened, outlive
the manager and the subsystem."""
import json
import os
import pathlib
import tempfile
import unittest

from system import CHAIN, System, await_that

IN_C = """
subsystem: subject
rtpus:
  served: {cpu: 1, policy: edf, executor: preemptive}
  other: {cpu: 0, policy: edf, executor: preemptive}
tasks:
  first:
    component: t_relay
    rtpu: served
    resources: {pipe: PIPE}
    constants: {target: second}
    server: {kind: sporadic, capacity: 1 ms, period: 20 ms}
  second:
    component: t_relay
    rtpu: other
    resources: {pipe: none}
    alias: {passed: again}
    constants: {target: third}
    server: {kind: deferrable, capacity: 1 ms, period: 20 ms}
  third:
    component: on_event
    rtpu: served
    server: {kind: deferrable, capacity: 1 ms, period: 20 ms}
"""
# The first two in one loop without preemption, where an event source takes the place of a server.
IN_LOOP = (IN_C.replace("cpu: 0, policy: edf, executor: preemptive", "cpu: 0, policy: edf, executor: executive")
           .replace("rtpu: served\n    resources", "rtpu: other\n    resources")
           .replace("server: {kind: sporadic, capacity: 1 ms, period: 20 ms}", "rate: 100 Hz")
           .replace("server: {kind: deferrable, capacity: 1 ms, period: 20 ms}", "rate: 50 Hz", 1))
TASKS = ("first", "second", "third")


class Events(unittest.TestCase):
    def test_come_from_a_descriptor_and_ring_doorbells_here_and_there(self):
        with tempfile.TemporaryDirectory(prefix="chimera-events-") as place:
            pipe = pathlib.Path(place) / "pipe"
            os.mkfifo(pipe)
            with System(IN_C.replace("PIPE", str(pipe))) as system:
                self.assert_answered(system, pipe)
                refused = system.chimera("run", system.file, "--virtual", "--for", "1 s", code=1).stderr
                self.assertIn("from a descriptor, in virtual time: run cannot do this yet", refused)

    def test_release_jobs_of_a_loop_without_preemption(self):
        with tempfile.TemporaryDirectory(prefix="chimera-events-") as place:
            pipe = pathlib.Path(place) / "pipe"
            os.mkfifo(pipe)
            with System(IN_LOOP.replace("PIPE", str(pipe))) as system:
                self.assert_answered(system, pipe)
                for _ in range(3):
                    system.chimera("ring", "second")
                for task in ("second", "third"):
                    await_that(lambda: system.task(task)["events"] == 11, f"11 events of {task}")
                self.assertEqual(system.task("first")["events"], 8)

    def assert_answered(self, system, pipe):
        for task in TASKS:
            system.await_state(task, "ON")
        with open(pipe, "wb", buffering=0) as end:
            for total, written in ((5, b"12345"), (8, b"678")):
                end.write(written)
                for task in TASKS:
                    await_that(lambda: system.task(task)["cycles"] == total, f"{total} events of {task}")
        for task in TASKS:
            seen = system.task(task)
            self.assertEqual((seen["events"], seen["events_lost"], seen["faults"]), (8, 0, 0), task)

    def test_outlive_the_manager_and_the_subsystem(self):
        with System(CHAIN, ("--log", "run.log")) as system:
            for i in range(6):
                manager, since = system.pids()["manager"], system.next_event()
                system.call("flag", up=i % 2 == 0)
                system.kill(manager)  # at once: the disk may not have the event yet
                system.await_event(since, "manager-started", f"incarnation {i + 2}")
                raised = system.await_event(since, "flag", "the operator")
                self.assertRegex(raised["by"], "^configure:.")
            told = system.events()
            self.assertEqual([e["number"] for e in told], list(range(1, len(told) + 1)))
            self.assertIn(f", by {raised['by']}\n", system.chimera("events").stdout)
            log = system.place / "run.log"
            await_that(lambda: "incarnation 7" in log.read_text(), lambda: log.read_text())
            logged = [int(line.split()[0]) for line in log.read_text().splitlines()]
            self.assertEqual(logged, list(range(1, len(logged) + 1)))
            system.chimera("end", "--subsystem", "subject")
            system.wait()
            filed = json.loads(system.chimera("events", "--json").stdout)["events"]
            self.assertEqual(filed[:len(told)], told)
            self.assertIn("ending", [e["kind"] for e in filed])
            of_all_runs = json.loads(system.chimera("events", "--since", "1 h", "--json").stdout)["events"]
            self.assertEqual(of_all_runs, filed)
            folder = system.chimera("run", system.file, "--log", system.place, code=1).stderr
            self.assertEqual(folder, f"{system.place}: error: cannot be opened: Is a directory\n")


if __name__ == "__main__":
    unittest.main(verbosity=1)
