# SPDX-License-Identifier: Apache-2.0
"""Whoever hangs is noticed by a process that does not hang, within 2 s and with what was under way: the manager, a
real-time unit, a method, the opening of an object, the keeper. The systems of all tests run side by side."""
import ctypes
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "processes"))
from system import CHIMERA, TWO_UNITS, Client, System, await_that  # noqa: E402

TOLD = 2.0  # s, as promised; on a machine that other tests use as well a part of it goes to waiting for a processor
SLACK = 1.0

UNITS_THAT_HANG = """
subsystem: subject
rtpus:
  first: {cpu: 0, policy: edf}
  stopped: {cpu: 1, policy: edf}
  traced: {cpu: 1, policy: edf}
  loop: {cpu: 1, policy: edf}
  threads: {cpu: 1, policy: edf, executor: preemptive}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  beside: {component: t_source, rtpu: stopped, rate: 100 Hz, alias: {x: x1, expired: e1}}
  held: {component: t_source, rtpu: traced, rate: 100 Hz, alias: {x: x2, expired: e2}}
  bare:
    {component: t_crash, rtpu: loop, rate: 100 Hz, alias: {y: y3}, constants: {how: unplug}, resources: {armed: ARMED}}
  naked:
    {component: t_crash, rtpu: threads, rate: 100 Hz, alias: {y: y4}, constants: {how: unplug},
     resources: {armed: ARMED}}
configurations: {all: [steady, beside, held, bare, naked]}
start: all
"""

SLOW = """
subsystem: slow
rtpus:
  first: {cpu: 0, policy: edf}
  second: {cpu: 1, policy: edf}
  third: {cpu: 1, policy: edf}
  fourth: {cpu: 1, policy: edf, executor: preemptive}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 100 Hz}
  log: {component: csv_log, rtpu: second, rate: 100 Hz, alias: {in: [count]}, resources: {file: PLACE/pipe}}
  stuck: {component: t_crash, rtpu: third, rate: 100 Hz, constants: {where: init, how: sleep},
          resources: {armed: PLACE/armed}}
  beside: {component: t_source, rtpu: fourth, rate: 100 Hz}
configurations: {all: [steady, log, stuck, beside]}
start: all
"""

PTRACE_DETACH, PTRACE_SEIZE, PTRACE_INTERRUPT = 17, 0x4206, 0x4207
libc = ctypes.CDLL(None, use_errno=True)
libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]


def hold_by_debugger(pid):
    """All of its threads stand still, as under gdb."""
    threads = [int(thread) for thread in os.listdir(f"/proc/{pid}/task")]
    for thread in threads:
        for request in (PTRACE_SEIZE, PTRACE_INTERRUPT):
            if libc.ptrace(request, thread, None, None) != 0:
                raise OSError(ctypes.get_errno(), "ptrace")
    return threads


def let_go(threads):
    for thread in threads:
        os.waitpid(thread, 0x40000000)  # __WALL: the stop that was asked for
        libc.ptrace(PTRACE_DETACH, thread, None, None)


def hangs(system, since, **about):
    found = [e for e in system.events(since) if e["kind"] == "hang"]
    return [e for e in found if all(e.get(key) == value for key, value in about.items())]


class Watch(unittest.TestCase):
    """Everything is begun at once, and looked at when it must have been noticed."""

    @classmethod
    def setUpClass(cls):
        cls.place = pathlib.Path(tempfile.mkdtemp(prefix="chimera-watch-"))
        os.mkfifo(cls.place / "pipe")
        (cls.place / "armed").touch()
        cls.systems = []
        cls.slow_began = time.monotonic()
        cls.slow = cls.begin(SLOW.replace("PLACE", str(cls.place)), name="slow", wait=False)
        cls.system, cls.pair = cls.begin(UNITS_THAT_HANG), cls.begin(TWO_UNITS)
        cls.pids, cls.pair_pids = cls.system.pids(), cls.pair.pids()
        cls.since = cls.system.events()[-1]["number"] + 1
        cls.steady, cls.pair_steady = cls.system.task("steady"), cls.pair.task("steady")
        cls.pair.disconnect()
        try:
            cls.threads = hold_by_debugger(cls.pids["traced"])
        except PermissionError:  # the system allows no tracing: nothing to see of it
            cls.threads = []
        cls.stopped_at = time.monotonic_ns()
        assert cls.system.kill(cls.pids["stopped"], signal.SIGSTOP)
        assert cls.pair.kill(cls.pair_pids["manager"], signal.SIGSTOP)
        cls.system.arm()

    @classmethod
    def begin(cls, *arguments, **options):
        cls.systems.append(System(*arguments, **options))
        return cls.systems[-1]

    @classmethod
    def tearDownClass(cls):
        for system in cls.systems:
            for pid in system.left_over():
                system.kill(pid, signal.SIGCONT)
        for system in cls.systems:
            system.process.terminate()  # all at once: each takes its time
        for system in cls.systems:
            system.end()
        shutil.rmtree(cls.place)

    def told(self, system, since, **about):
        return await_that(lambda: hangs(system, since, **about), TOLD + SLACK, f"a hang of {about}")[0]

    def ended(self, unit):
        def found():
            return [e for e in self.system.events(self.since) if e["kind"] == "rtpu-ended" and e.get("rtpu") == unit]
        return await_that(found, 5, f"the end of {unit}")[0]

    def goes_on(self, system, before):
        after = system.task("steady")
        self.assertEqual((after["state"], after["incarnation"]), ("ON", before["incarnation"]))
        self.assertGreater(after["cycles"], before["cycles"])

    def status_of(self, system):
        return subprocess.run([CHIMERA, "status"], env=system.environment, cwd=system.place, capture_output=True,
                              text=True).stdout

    def test_1_closed_descriptors_end_a_unit_by_name(self):
        for unit in ("loop", "threads"):
            end = self.ended(unit)
            self.assertIn("ended with status 4 (its descriptors were closed)", end["text"])
            self.assertLess(end["at_ns"] - self.stopped_at, (TOLD + SLACK) * 1e9)
        self.system.disarm()
        for task in ("bare", "naked"):
            self.system.await_state(task, "ON")

    def test_2_a_stopped_unit_is_told_and_not_shown_as_on(self):
        event = self.told(self.system, self.since, rtpu="stopped")
        self.assertLess(event["at_ns"] - self.stopped_at, (TOLD + SLACK) * 1e9)
        self.assertIn("does not run: stopped by a signal (state T)", event["text"])
        unit = self.system.rtpu("stopped")
        self.assertFalse(unit["alive"])
        self.assertIn("stopped by a signal", unit["hang"])
        self.assertEqual(self.system.state("beside"), "ERROR")
        self.assertIn("stopped: HANGS: does not run: stopped by a signal (state T)", self.status_of(self.system))

    def test_3_a_stopped_manager_is_replaced(self):
        client = Client(self.pair.socket)
        self.addCleanup(client.close)
        self.assertNotEqual(client.call("hello")["manager"]["pid"], self.pair_pids["manager"])
        event = await_that(lambda: [e for e in client.call("events", since=0)["events"] if e["kind"] == "hang"], 1)[0]
        self.assertLess(event["at_ns"] - self.stopped_at, (TOLD + SLACK) * 1e9)
        self.assertRegex(event["text"], r"^manager did not answer for [12]\.\d s: stopped by a signal \(state T\); "
                                        "it was replaced$")
        self.goes_on(self.pair, self.pair_steady)

    def test_4_a_stopped_unit_is_dead_after_its_patience_and_a_debugger_is_waited_for(self):
        if self.threads:
            event = self.told(self.system, self.since, rtpu="traced")
            self.assertIn(f"held by a debugger (pid {os.getpid()})", event["text"])
        end = self.ended("stopped")
        self.assertIn("it did not run for", end["text"])
        self.assertLess(end["at_ns"] - self.stopped_at, (3 + SLACK) * 1e9)
        self.system.await_state("beside", "ON")
        self.assertEqual(self.system.rtpu("stopped")["incarnation"], 2)
        self.assertEqual(self.system.rtpu("traced")["incarnation"], 1)
        let_go(self.threads)
        await_that(lambda: self.system.state("held") == "ON" and self.system.rtpu("traced")["alive"], 5, "the return")
        again = [e for e in hangs(self.system, self.since, rtpu="traced") if "runs again" in e["text"]]
        self.assertEqual(len(again), 1 if self.threads else 0)
        self.goes_on(self.system, self.steady)

    def test_5_a_stopped_keeper_is_told_and_takes_nobody_for_hung(self):
        pids = self.pair.pids()
        since = self.pair.events()[-1]["number"] + 1
        self.assertTrue(self.pair.kill(pids["keeper"], signal.SIGSTOP))
        try:
            event = self.told(self.pair, since)
            self.assertIn("keeper does not run: stopped by a signal (state T)", event["text"])
            self.assertIn("keeper: HANGS: does not run: stopped by a signal", self.status_of(self.pair))
        finally:
            self.pair.kill(pids["keeper"], signal.SIGCONT)
        await_that(lambda: self.pair.call("status")["keeper"]["hang"] is None, 5, "the return of the keeper")
        self.assertEqual(self.pair.pids(), pids)
        self.goes_on(self.pair, self.pair_steady)

    def test_6_slow_methods_are_named_and_not_killed(self):
        log = self.told(self.slow, 0, task="log")
        self.assertRegex(log["text"], r"^log\.init for [12]\.\d s$")
        self.assertEqual(log["rtpu"], "second")
        self.assertRegex(self.told(self.slow, 0, task="stuck")["text"], r"^stuck\.init for [12]\.\d s$")
        unit = self.slow.rtpu("second")
        self.assertRegex(unit["hang"], r"^log\.init for \d+(\.\d)? s$")
        self.assertTrue(unit["alive"])
        self.assertRegex(self.status_of(self.slow), r"second: HANGS: log\.init for ")
        await_that(lambda: time.monotonic() > self.slow_began + 5, 6, "longer than any patience")
        self.assertEqual([r["incarnation"] for r in self.slow.call("status")["rtpus"]], [1, 1, 1, 1])


if __name__ == "__main__":
    unittest.main()
