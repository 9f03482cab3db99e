# SPDX-License-Identifier: Apache-2.0
"""A process, a method or a constructor that hangs is reported, with what was under way, by a process that does not
hang: the manager, an rtpu, a method, the opening of an object, the keeper. The systems of all tests run at once."""
import contextlib
import ctypes
import fcntl
import os
import pathlib
import re
import shutil
import signal
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "processes"))
from system import TWO_RTPUS, Refused, System, await_that, duration  # noqa: E402

RTPUS_THAT_HANG = """
subsystem: subject
rtpus:
  first: {cpu: 0, policy: edf}
  stopped: {cpu: 1, policy: edf}
  traced: {cpu: 1, policy: edf}
  loop: {cpu: 1, policy: edf}
  threads: {cpu: 1, policy: edf, executor: preemptive}
  timed: {cpu: 1, policy: edf, executor: preemptive}
  between: {cpu: 1, policy: edf}
  inside: {cpu: 1, policy: edf}
  serving: {cpu: 1, policy: edf}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  blind: {component: t_misdeed, rtpu: timed, rate: 100 Hz, alias: {y: y5}, constants: {how: timer},
          resources: {armed: ARMED}}
  beside: {component: t_source, rtpu: stopped, rate: 100 Hz, alias: {x: x1, expired: e1}}
  held: {component: t_source, rtpu: traced, rate: 100 Hz, alias: {x: x2, expired: e2}}
  bare:
    {component: t_crash, rtpu: loop, rate: 100 Hz, alias: {y: y3}, constants: {how: unplug}, resources: {armed: ARMED}}
  naked:
    {component: t_crash, rtpu: threads, rate: 100 Hz, alias: {y: y4}, constants: {how: unplug},
     resources: {armed: ARMED}}
  strict: {component: t_misdeed, rtpu: between, rate: 100 Hz, alias: {y: y6}, constants: {how: strict},
           resources: {armed: ARMED-threads}}
  leaver: {component: t_crash, rtpu: inside, rate: 100 Hz, alias: {y: y7}, constants: {how: vanish},
           resources: {armed: ARMED-threads}}
  killer: {component: t_crash, rtpu: serving, rate: 100 Hz, alias: {y: y8}, constants: {where: kill, how: vanish},
           resources: {armed: ARMED-threads}}
configurations: {all: [steady, blind, beside, held, bare, naked, strict, leaver, killer]}
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

# Each in an rtpu of its own: a task whose `on` loops, one whose `off` does, one whose `kill` does, and a logger whose
# reader does not read.
METHODS = """
subsystem: methods
rtpus:
  first: {cpu: 0, policy: edf}
  ons: {cpu: 1, policy: edf}
  offs: {cpu: 1, policy: edf}
  kills: {cpu: 1, policy: edf}
  logs: {cpu: 1, policy: edf}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 1000 Hz}
  a_on: {component: t_ends, rtpu: ons, rate: 100 Hz, alias: {n: n1}, constants: {where: on, how: loop},
         resources: {armed: ARMED}}
  an_off: {component: t_ends, rtpu: offs, rate: 100 Hz, alias: {n: n2}, constants: {where: off, how: loop},
           resources: {armed: ARMED}}
  a_kill: {component: t_ends, rtpu: kills, rate: 100 Hz, alias: {n: n3}, constants: {where: kill, how: loop},
           resources: {armed: ARMED}}
  log: {component: csv_log, rtpu: logs, rate: 1000 Hz, alias: {in: [count]}, resources: {file: PLACE/unread}}
configurations: {all: [steady, a_on, an_off, a_kill, log]}
start: all
"""

MADE = """
subsystem: made
tasks: {stuck: {component: t_load}}
configurations: {all: [stuck]}
start: all
"""

PTRACE_GETREGS, PTRACE_SETREGS = 12, 13
RIP, ORIG_RAX = 16, 15  # of the 27 words of user_regs_struct, x86-64
PTRACE_DETACH, PTRACE_SEIZE, PTRACE_INTERRUPT = 17, 0x4206, 0x4207
libc = ctypes.CDLL(None, use_errno=True)
libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]


def hold_by_debugger(pid):
    """All threads of the process stand still, as under gdb."""
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


def send_into_a_loop(pid):
    """Makes the main thread jump to itself, if its code has the bytes of such a jump. False: not possible."""
    if os.uname().machine != "x86_64" or libc.ptrace(PTRACE_SEIZE, pid, None, None) != 0:
        return False
    libc.ptrace(PTRACE_INTERRUPT, pid, None, None)
    os.waitpid(pid, 0x40000000)
    registers = (ctypes.c_ulong * 27)()
    libc.ptrace(PTRACE_GETREGS, pid, None, ctypes.addressof(registers))
    place = jump_to_itself(pid)
    if place is not None:
        registers[RIP], registers[ORIG_RAX] = place, ctypes.c_ulong(-1).value
        libc.ptrace(PTRACE_SETREGS, pid, None, ctypes.addressof(registers))
    libc.ptrace(PTRACE_DETACH, pid, None, None)
    return place is not None


def jump_to_itself(pid):
    with open(f"/proc/{pid}/maps") as maps, open(f"/proc/{pid}/mem", "rb", 0) as memory:
        for line in maps:
            place, rights = line.split()[:2]
            begin, end = (int(word, 16) for word in place.split("-"))
            if "x" not in rights or line.rstrip().endswith("[vsyscall]"):
                continue
            memory.seek(begin)
            with contextlib.suppress(OSError):
                if (found := memory.read(end - begin).find(b"\xeb\xfe")) >= 0:
                    return begin + found
    return None


class Watch(unittest.TestCase):
    """Every hang begins at once in setUpClass."""

    @classmethod
    def setUpClass(cls):
        cls.place = pathlib.Path(tempfile.mkdtemp(prefix="chimera-watch-"))
        os.mkfifo(cls.place / "pipe")
        os.mkfifo(cls.place / "unread")
        cls.unread = os.open(cls.place / "unread", os.O_RDWR)
        fcntl.fcntl(cls.unread, fcntl.F_SETPIPE_SZ, 4096)
        (cls.place / "armed").touch()
        cls.systems = []
        cls.slow = cls.begin(SLOW.replace("PLACE", str(cls.place)), name="slow", wait=False)
        cls.made = cls.begin(MADE, name="made", wait=False, environment={"CHIMERA_TEST_LOAD": "construct hang"})
        cls.system, cls.pair = cls.begin(RTPUS_THAT_HANG), cls.begin(TWO_RTPUS)
        cls.methods = cls.begin(METHODS.replace("PLACE", str(cls.place)), name="methods")
        cls.pids, cls.pair_pids = cls.system.pids(), cls.pair.pids()
        cls.since = cls.system.next_event()
        cls.steady, cls.pair_steady = cls.system.task("steady"), cls.pair.task("steady")
        cls.pair.disconnect()
        try:
            cls.threads = hold_by_debugger(cls.pids["traced"])
        except PermissionError:  # the system allows no tracing
            cls.threads = []
        cls.stopped_at = cls.system.call("status")["now_ns"]
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
        os.close(cls.unread)
        for system in cls.systems:
            system.process.terminate()  # all at once: each takes its time
        for system in cls.systems:
            system.end()
        shutil.rmtree(cls.place)

    def ended(self, system, rtpu, since, words):
        event = system.await_event(since, "rtpu-ended", rtpu=rtpu)
        self.assertIn(words, event["text"])
        duration(f"from the begin of the hangs to the end of {rtpu}", (event["at_ns"] - self.stopped_at) / 1e9)

    def replaced(self, how):
        """The manager of the pair has another process, which says so."""
        event = self.pair.await_event(self.pair_since, "hang")
        self.assertNotEqual(self.pair.call("hello")["manager"]["pid"], self.pair_pids["manager"])
        self.assertRegex(event["text"], rf"^manager did not answer for \d+(\.\d)? s: {how}; it was replaced$")
        duration("until the manager was replaced", float(re.search(r"for ([\d.]+) s", event["text"])[1]))
        self.goes_on(self.pair, self.pair_steady)

    def goes_on(self, system, before):
        after = system.await_cycles("steady")
        self.assertEqual((after["state"], after["incarnation"]), ("ON", before["incarnation"]))

    def status_of(self, system):
        return system.chimera("status", code=None).stdout

    def test_1_closed_descriptors_end_an_rtpu_by_name(self):
        for rtpu in ("loop", "threads"):
            self.ended(self.system, rtpu, self.since, "ended with status 4 (its descriptors were closed)")
        self.system.disarm()
        for task in ("bare", "naked"):
            self.system.await_state(task, "ON")

    def test_a_timer_that_is_closed_ends_its_rtpu(self):
        """The supervisor sleeps on what was closed while it has nothing to check, and is not woken any more."""
        self.system.signal("off", "blind")
        self.system.signal("kill", "blind")
        self.system.arm()
        with contextlib.suppress(Refused):  # its rtpu may have ended before it answered
            self.system.signal("spawn", "blind")
        self.system.disarm()
        with contextlib.suppress(Refused):  # the same
            self.system.signal("on", "blind")
        self.ended(self.system, "timed", self.since, "ended with status 4 (its descriptors were closed)")

    def test_a_thread_that_a_component_ended_ends_the_rtpu(self):
        armed = pathlib.Path(f"{self.system.armed}-threads")
        self.system.signal("off", "killer")
        armed.write_text("")
        with contextlib.suppress(Refused):  # its rtpu ends before it answers
            self.system.signal("kill", "killer")
        self.ended(self.system, "between", self.since, "ended with status 6 (a component ended one of its threads)")
        self.ended(self.system, "inside", self.since, "was ended: leaver.cycle ended its thread")
        self.ended(self.system, "serving", self.since, "was ended: killer.kill ended its thread")
        armed.unlink()
        self.system.await_state("strict", "ON")
        self.system.await_state("leaver", "ON")

    def test_2_a_stopped_rtpu_is_reported(self):
        event = self.system.await_event(self.since, "hang", rtpu="stopped")
        duration("until a stopped rtpu is reported", (event["at_ns"] - self.stopped_at) / 1e9)
        self.assertIn("does not run: stopped by a signal (state T)", event["text"])

    def test_3_a_stopped_manager_is_replaced(self):
        self.__class__.pair_since = 0
        self.replaced(r"stopped by a signal \(state T\)")

    def test_4_a_stopped_rtpu_is_dead_after_its_patience_and_a_debugger_is_waited_for(self):
        if self.threads:
            event = self.system.await_event(self.since, "hang", rtpu="traced")
            self.assertIn(f"held by a debugger (pid {os.getpid()})", event["text"])
            rtpu = self.system.rtpu("traced")
            self.assertFalse(rtpu["alive"])
            self.assertIn("held by a debugger", rtpu["hang"])
            self.assertEqual(self.system.state("held"), "ERROR", "a task that does not run is not shown as ON")
            self.assertIn("traced: HANGS: does not run: held by a debugger", self.status_of(self.system))
        self.ended(self.system, "stopped", self.since, "it did not run for")
        self.system.await_state("beside", "ON")
        self.assertEqual(self.system.rtpu("stopped")["incarnation"], 2)
        self.assertEqual(self.system.rtpu("traced")["incarnation"], 1)
        let_go(self.threads)
        await_that(lambda: self.system.state("held") == "ON" and self.system.rtpu("traced")["alive"], "the return")
        if self.threads:
            self.system.await_event(self.since, "hang", "runs again", rtpu="traced")
        self.goes_on(self.system, self.steady)

    def test_5_a_stopped_keeper_is_reported_and_no_process_is_taken_for_hung(self):
        pids = self.pair.pids()
        since = self.pair.next_event()
        self.assertTrue(self.pair.kill(pids["keeper"], signal.SIGSTOP))
        try:
            self.pair.await_event(since, "hang", "keeper does not run: stopped by a signal (state T)")
            self.assertIn("keeper: HANGS: does not run: stopped by a signal", self.status_of(self.pair))
        finally:
            self.pair.kill(pids["keeper"], signal.SIGCONT)
        await_that(lambda: self.pair.call("status")["keeper"]["hang"] is None, "the return of the keeper")
        self.assertEqual(self.pair.pids(), pids)
        self.goes_on(self.pair, self.pair_steady)

    def test_6_slow_methods_are_named_and_not_killed(self):
        for task, rtpu in (("log", "second"), ("stuck", "third")):
            event = self.slow.await_event(0, "hang", task=task, rtpu=rtpu)
            self.assertRegex(event["text"], rf"^{task}\.init for \d+(\.\d)? s$")
        rtpu = self.slow.rtpu("second")
        self.assertRegex(rtpu["hang"], r"^log\.init for \d+(\.\d)? s$")
        self.assertTrue(rtpu["alive"])
        self.assertRegex(self.status_of(self.slow), r"second: HANGS: log\.init for ")
        with open(self.place / "pipe", "rb"):  # the reader for which init waits
            await_that(lambda: self.slow.state("log") != "NOT-CREATED", "the end of the slow init")
        self.assertEqual([r["incarnation"] for r in self.slow.call("status")["rtpus"]], [1, 1, 1, 1])

    def test_7_a_manager_in_a_loop_is_replaced(self):
        self.__class__.pair_pids, self.__class__.pair_since = self.pair.pids(), self.pair.next_event()
        self.pair.disconnect()
        if not send_into_a_loop(self.pair_pids["manager"]):
            self.skipTest("the system allows no tracing")
        self.replaced(r"in a loop that does not end \(state [RSD]\)")

    def test_8_methods_that_loop_are_reported_by_name(self):
        system = self.methods
        for task in ("a_on", "a_kill"):
            system.signal("off", task)
        system.arm()
        since, pid = system.next_event(), system.rtpu("kills")["pid"]
        words = (("on", "a_on"), ("off", "an_off"), ("kill", "a_kill"))
        waiting = {word: system.ask("signal", signal=word, tasks=[task]) for word, task in words}
        for word, task in words:
            event = system.await_event(since, "hang", task=task)
            self.assertRegex(event["text"], rf"^{task}\.{word} for \d+(\.\d)? s$")
        error = waiting["kill"].answer()  # while the method goes on
        self.assertEqual(error.code, -32006)
        # The answer names the hang only if the watch has already seen it.
        self.assertRegex(str(error), r"^no answer from rtpu kills(: a_kill\.kill for \d\.\d s; it goes on: |$)")
        system.disarm()
        for rtpu, method in (("ons", "a_on.on"), ("offs", "an_off.off")):
            self.ended(system, rtpu, since, f"was ended: {method} did not return within 2 s")
        for word in ("on", "off"):
            waiting[word].answer()
        self.assertEqual(system.rtpu("kills")["incarnation"], 1, "a slow `kill` ends no rtpu")
        said = system.chimera("kill", "a_kill", "--subsystem", "methods", code=1).stderr
        self.assertRegex(said, r"a_kill\.kill for \d+(\.\d)? s; it goes on: ")
        self.assertIn(f"`kill -KILL {pid}` ends the process of kills", said)

    def test_9_a_constructor_and_a_background_that_do_not_end_are_reported_by_name(self):
        self.assertRegex(self.made.await_event(0, "hang", task="stuck")["text"], r"stuck\b.* for \d+(\.\d)? s$")
        self.assertRegex(self.status_of(self.made), r"main: HANGS: .*stuck")
        self.assertRegex(self.methods.await_event(0, "hang", task="log")["text"],
                         r"^log\.background for \d+(\.\d)? s$")
        self.assertEqual(self.methods.state("log"), "ON", "it holds up no other method")


if __name__ == "__main__":
    unittest.main()
