# SPDX-License-Identifier: Apache-2.0
"""Events for a task behind a server, from a task of another rtpu, a descriptor or a person: each is counted and answered
in turn, and lost only while the task is not ON."""
import os
import pathlib
import tempfile
import unittest

from protocol_test import Judged
from system import System, await_that

APPLICATION = """
subsystem: subject
rtpus:
  served: {cpu: 1, policy: edf, executor: preemptive}
  other: {cpu: 0, policy: edf}
tasks:
  steady: {component: t_counter, rtpu: served, rate: 100 Hz}
  button: {component: ringer, rtpu: other, rate: 200 Hz, constants: {target: alarm, burst: 2}}
  neighbour: {component: ringer, rtpu: served, rate: 100 Hz, alias: {rung: again}, constants: {target: alarm}}
  alarm:
    component: on_event
    rtpu: served
    server: {kind: deferrable, capacity: 4 ms, period: 20 ms}
    constants: {time: 100 us}
configurations: {all: [steady, button, neighbour, alarm]}
start: all
"""


OF_A_PIPE = """
subsystem: subject
rtpus:
  served: {cpu: 1, policy: edf, executor: preemptive}
tasks:
  steady: {component: t_counter, rate: 100 Hz}
  reader:
    component: t_pipe
    resources: {pipe: PIPE}
    server: {kind: sporadic, capacity: 1 ms, period: 20 ms}
"""


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


class Events(unittest.TestCase):
    def test_in_c_come_from_a_descriptor_and_ring_doorbells_here_and_there(self):
        with tempfile.TemporaryDirectory(prefix="chimera-events-") as place:
            pipe = pathlib.Path(place) / "pipe"
            os.mkfifo(pipe)
            with System(IN_C.replace("PIPE", str(pipe))) as system:
                for task in ("first", "second", "third"):
                    system.await_state(task, "ON")
                with open(pipe, "wb", buffering=0) as end:
                    end.write(b"12345")
                    for task in ("first", "second", "third"):
                        await_that(lambda: system.task(task)["cycles"] == 5, f"five events of {task}")
                for task in ("first", "second", "third"):
                    seen = system.task(task)
                    self.assertEqual((seen["events"], seen["events_lost"], seen["faults"]), (5, 0, 0), task)

    def test_of_a_descriptor_that_a_resource_port_names_are_answered_as_long_as_there_are_some(self):
        with tempfile.TemporaryDirectory(prefix="chimera-events-") as place:
            pipe = pathlib.Path(place) / "pipe"
            os.mkfifo(pipe)
            text = OF_A_PIPE.replace("PIPE", str(pipe))
            with System(text) as system:
                system.await_state("reader", "ON")
                with open(pipe, "wb", buffering=0) as end:
                    end.write(b"12345")
                    await_that(lambda: system.task("reader")["cycles"] == 5, "five events")
                    end.write(b"678")
                    reader = await_that(lambda: (t := system.task("reader"))["cycles"] == 8 and t, "three more")
                self.assertEqual((reader["events"], reader["events_lost"], reader["faults"]), (8, 0, 0))
                refused = system.chimera("run", system.file, "--virtual", "--for", "1 s", code=1).stderr
            self.assertIn("events of task 'reader' from a descriptor, in virtual time: run cannot do this yet", refused)

    def test_of_a_person_are_one_for_each_ring_and_refused_where_no_job_would_answer(self):
        quiet = APPLICATION.replace("all: [steady, button, neighbour, alarm]", "all: [steady, alarm]")
        with System(quiet) as system:
            system.await_state("alarm", "ON")
            client = Judged(system.socket)
            self.addCleanup(client.close)
            for n in range(1, 4):
                self.assertEqual(client.exchange("ring", tasks=["alarm"]), {"tasks": ["alarm"]})
                await_that(lambda: client.exchange("status")["tasks"][3]["cycles"] == n, "an answer")
            self.assertEqual(client.exchange("ring", tasks=["alarm"] * 5), {"tasks": ["alarm"] * 5})
            await_that(lambda: system.task("alarm")["cycles"] == 8, "five more")

            def refusal(task):
                self.assertIsNone(client.exchange("ring", tasks=["alarm", task]))
                return client.last["error"]

            self.assertEqual(refusal("steady"), {
                "code": -32000, "message": "steady is not behind a server: it has no doorbell",
                "data": {"kind": "no-server", "where": "steady", "remedy": "give it 'server:' in the description"}})
            system.signal("off", "alarm")
            self.assertEqual(refusal("alarm"), {
                "code": -32000, "message": "alarm is OFF: no job would answer the event",
                "data": {"kind": "state", "where": "alarm", "remedy": "turn it ON first"}})
            alarm = system.task("alarm")
            self.assertEqual((alarm["events"], alarm["events_lost"], alarm["cycles"]), (8, 0, 8))
            self.assertEqual(client.faults, [])
            told = [e["text"] for e in client.exchange("events")["events"] if e["kind"] == "command"]
            self.assertEqual(told[0], "ring alarm: done")
            self.assertEqual(told[-1], "ring alarm, alarm: refused: alarm is OFF: no job would answer the event")

    def test_of_other_rtpus_are_answered_each_by_one_job(self):
        with System(APPLICATION) as system:
            alarm = system.await_cycles("alarm", 50)
            self.assertEqual((alarm["faults"], system.task("steady")["faults"]), (0, 0))
            self.assertGreaterEqual(alarm["events"], alarm["cycles"])
            system.signal("off", "alarm")
            system.await_state("alarm", "OFF")
            off = await_that(lambda: (t := system.task("alarm"))["events_lost"] > alarm["events_lost"] and t,
                             "a lost event")
            self.assertLessEqual(off["cycles"], off["events"])
            system.signal("on", "alarm")
            system.await_cycles("alarm")


if __name__ == "__main__":
    unittest.main(verbosity=1)
