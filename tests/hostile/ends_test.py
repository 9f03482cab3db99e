# SPDX-License-Identifier: Apache-2.0
"""Ends are judged: an `off` or a `kill` that fails is reported by task, method and cause, the exit code is 1, and no
event says what does not happen. docs/formats/processes.md, "Ending"; docs/formats/run.md, "How a run went"."""
import ctypes
import json
import os
import pathlib
import signal
import sys
import threading
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "processes"))

from system import HANG, Client, System, await_that  # noqa: E402


def application(ends, **others):
    """`steady`, and one rtpu for each of `ends`: (executor, method, way)."""
    units = "".join(f"  u{i}: {{cpu: {i % 2}, policy: edf, executor: {executor}}}\n"
                    for i, (executor, _, _) in enumerate(ends))
    tasks = "".join(f"  t{i}: {{component: t_ends, rtpu: u{i}, rate: 100 Hz, alias: {{n: n{i}}}, "
                    f"constants: {{where: {where}, how: {how}}}, resources: {{armed: ARMED}}}}\n"
                    for i, (_, where, how) in enumerate(ends))
    names = ", ".join(["steady", *(f"t{i}" for i in range(len(ends))), *others])
    more = "".join(f"  {name}: {text}\n" for name, text in others.items())
    return (f"subsystem: subject\nrtpus:\n  good: {{cpu: 0, policy: edf}}\n{units}tasks:\n"
            f"  steady: {{component: t_counter, rtpu: good, rate: 100 Hz}}\n{tasks}{more}"
            f"configurations: {{all: [{names}]}}\nstart: all\n")


RECORDER = ("{component: t_recorder, rtpu: RTPU, rate: 100 Hz, alias: {x: X, y: Y}, "
            "constants: {label: LABEL, slow: SLOW}}")


def recorder(label, rtpu, x, y, slow="0 ns"):
    words = {"RTPU": rtpu, "LABEL": label, "X": x, "Y": y, "SLOW": slow}
    text = RECORDER
    for word, value in words.items():
        text = text.replace(word, value)
    return text


class Listener(threading.Thread):
    """All events from the start to the last one of the manager."""

    def __init__(self, system):
        super().__init__(daemon=True)
        self.client = Client(system.socket)
        self.client.call("subscribe", to="events", since=0)
        self.events = []
        self.start()

    def run(self):
        try:
            while True:
                self.events += self.client.note()["params"].get("events", [])
        except OSError:
            self.client.close()

    def heard(self):
        self.join(HANG)
        return self.events

    def of(self, kind):
        return {(e.get("task") or e.get("rtpu")): e["text"] for e in self.events if e["kind"] == kind}


class Ends(unittest.TestCase):
    def ended(self, system, how):
        """Its exit code and output, after the action that ends it."""
        how()
        return system.wait(), system.said()

    def failures(self, said):
        return sorted(line.removeprefix("FAILED: ") for line in said.splitlines() if line.startswith("FAILED: "))

    def test_failed_off_and_kill_at_ctrl_c_are_reported_by_task_method_and_cause(self):
        ends = {("executive", "off", "throw"): "off failed: thrown on demand",
                ("executive", "off", "sleep"): "t1.off did not return within 2 s",
                ("preemptive", "kill", "segv"): "u2 ended by signal 11 (SIGSEGV) in t2.kill",
                ("preemptive", "off", "exit"): "u3 ended with status 0 in t3.off",
                ("executive", "kill", "fault"): "kill failed: refused on demand",
                ("preemptive", "kill", "loop"): "t5.kill did not return within 2 s"}
        expected = [f"t{i}: {words}: its hardware may not be off" + " or released" * ("refused" in words)
                    for i, words in enumerate(ends.values())]
        text = application(list(ends), beside="{component: t_source, rtpu: u2, rate: 100 Hz}")
        with System(text, ["--json"]) as system:
            system.arm()
            listener = Listener(system)
            code, said = self.ended(system, lambda: system.process.send_signal(signal.SIGINT))
            self.assertEqual(code, 1, said)
            verdict = json.loads(said.splitlines()[-1])["verdict"]
            self.assertFalse(verdict["clean"])
            self.assertEqual(sorted(verdict["failures"]), expected)
            names = [f"t{i}" for i in range(len(ends))]
            self.assertEqual(sorted(verdict["not_off"]), names)
            listener.heard()
            self.assertEqual(sorted(listener.of("not-off")), names)
            self.assertEqual(listener.of("rtpu-restarted"), {})

    def test_an_rtpu_that_cannot_be_ended_is_a_failed_end(self):
        """A process with a traced thread counts as living until its tracer, this test, waits for the thread."""
        with System(application([]), ["--json"]) as system:
            pid = system.rtpu("good")["pid"]
            thread = max(int(number) for number in os.listdir(f"/proc/{pid}/task"))
            libc = ctypes.CDLL(None, use_errno=True)
            if libc.ptrace(0x4206, thread, None, None) != 0:  # PTRACE_SEIZE: it runs on
                self.skipTest("the system allows no tracing")
            code, said = self.ended(system, lambda: system.process.send_signal(signal.SIGINT))
            os.waitpid(thread, 0x40000000)  # __WALL
            verdict = json.loads(next(line for line in said.splitlines() if line.startswith('{"')))["verdict"]
            self.assertEqual((code, verdict["clean"]), (1, False), said)
            self.assertIn("good did not end in order: it ended by signal 9 (SIGKILL)", str(verdict["failures"]))

    def test_a_plain_kill_of_an_rtpu_is_a_death_like_any_other(self):
        units = [("executive", "cycle", "loop")]
        chain = {"a": recorder("a", "good", "x0", "x1"), "b": recorder("b", "u1", "x1", "x2"),
                 "c": recorder("c", "u1", "x2", "x3"), "asleep": recorder("d", "u1", "x3", "x4"),
                 "e": recorder("e", "good", "x3", "x5")}
        text = application([*units, ("preemptive", "none", "none")], **chain) + "operator: {x0: 0}\n"
        with System(text) as system:
            system.signal("off", "asleep")
            listener = Listener(system)
            system.arm()  # the loop of t0 must be reported while the rest goes on
            before, steady = system.rtpu("u1"), system.task("steady")
            self.assertTrue(system.kill(before["pid"], signal.SIGTERM))
            system.await_restart("u1", before)
            for task in ("b", "c", "t1"):
                system.await_state(task, "ON")
            system.await_state("asleep", "OFF")
            self.assertEqual(system.rtpu("u1")["last_end"], "ended by signal 15 (SIGTERM)")
            self.assertEqual(system.task("steady")["incarnation"], steady["incarnation"])
            self.assertEqual([m for label, m, _ in system.lines() if label == "b"],
                             ["init", "on", "off", "kill", "init", "on"])
            while not (unit := system.rtpu("u1"))["given_up"]:  # the fourth time within 10 s
                if unit["alive"]:
                    system.kill(unit["pid"], signal.SIGTERM)
            await_that(lambda: system.call("status")["flag"]["up"], "the flag")
            self.assertIn("chimera clear", system.rtpu("u1")["remedy"])
            await_that(lambda: "u0" in listener.of("rtpu-ended"), "the loop")
            self.assertRegex(listener.of("rtpu-ended")["u0"],
                             r"^u0 was ended: t0\.cycle used \S+ m?s, \d+ x its period of 10 ms: lower its rate, or")
            system.disarm()
            self.assertEqual(self.ended(system, lambda: system.process.send_signal(signal.SIGTERM))[0], 1)  # given up

    def test_no_event_is_false_when_all_processes_end_at_once(self):
        slow = recorder("a", "u0", "x0", "x1", "1000 ms")
        text = application([("executive", "none", "none")], a=slow, b=recorder("b", "good", "x1", "x2"))
        with System(text + "operator: {x0: 0}\n") as system:
            listener = Listener(system)
            pids = system.pids()
            system.process.send_signal(signal.SIGTERM)
            await_that(lambda: system.call("status")["ending"], "the end")
            for unit in ("good", "u0"):
                system.kill(pids[unit], signal.SIGTERM)
            code, said = self.ended(system, lambda: None)
            self.assertEqual((code, self.failures(said)), (0, []), said)
            listener.heard()
            kinds = [e["kind"] for e in listener.events]
            for kind in ("rtpu-restarted", "rtpu-given-up", "flag", "not-off"):
                self.assertNotIn(kind, kinds, listener.events)
            self.assertEqual(set(listener.of("rtpu-ended").values()),
                             {"good ended with status 0", "u0 ended with status 0"})


if __name__ == "__main__":
    unittest.main(verbosity=1)
