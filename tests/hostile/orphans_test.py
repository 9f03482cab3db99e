# SPDX-License-Identifier: Apache-2.0
"""Processes that components start end with their rtpu, at the latest with the subsystem, and are never real time; what
memory an rtpu takes and which rights it gives up is reported."""
import contextlib
import ctypes
import os
import pathlib
import signal
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "processes"))
from system import RTPUS, System, await_that, processes_of  # noqa: E402

# The test itself has no real-time rights on some machines; then there is nothing to inherit.
PRIORITY = 20


def tasks(*ways, rate="100 Hz"):
    """A task for each misdeed, all in the second rtpu; `steady` in the first must not notice."""
    text = RTPUS + "tasks:\n  steady: {component: t_counter, rtpu: first, rate: 200 Hz}\n"
    for way in ways:
        text += (f"  {way}: {{component: t_misdeed, rtpu: second, rate: {rate}, alias: {{y: y_{way}}}, "
                 f"constants: {{how: {way}}}, resources: {{armed: ARMED}}}}\n")
    return text + f"configurations: {{all: [{', '.join(('steady',) + ways)}]}}\nstart: all\n"


def name_of(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/comm").read_text().strip()
    except OSError:
        return ""


def rt_rights():
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        return True
    except OSError:
        return False


def descriptors(pid):
    found = {}
    for fd in os.listdir(f"/proc/{pid}/fd"):
        with contextlib.suppress(FileNotFoundError):  # closed since the listing
            found[int(fd)] = os.readlink(f"/proc/{pid}/fd/{fd}")
    return found


class Rig(System):
    def __init__(self, text, priority=PRIORITY):
        super().__init__(text, arguments=("--priority", str(priority if rt_rights() else 0)))

    def children(self):
        """Children that components started: no processes of the project."""
        own = set(self.pids().values()) | {self.process.pid}
        ours = ("memory-holder", "chimera", "chimera-guard", "")
        return [p for p in self.left_over() if p not in own and name_of(p) not in ours]

    def memory_holder_of(self, pid):
        found = [p for p in self.left_over() if name_of(p) == "memory-holder" and parent_of(p) == pid]
        return found[0] if found else None


def parent_of(pid):
    return int(pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[1])


def traced_thread(pid):
    """The number of a thread of the process that has a tracer; None if there is none."""
    return next((int(status.parent.name) for status in pathlib.Path(f"/proc/{pid}/task").glob("*/status")
                 if "TracerPid:\t0\n" not in status.read_text()), None)


def gone(pids, marker):
    return not set(pids) & set(processes_of(marker))


class Orphans(unittest.TestCase):
    WAYS = ("child", "daemon", "chain", "exec", "stays")

    def test_children_are_never_real_time_and_end_with_their_rtpu(self):
        with Rig(tasks(*self.WAYS)) as system:
            missed = system.task("steady")["cycles"]
            system.arm()
            # The number of the chain changes at each reading; three of its processes are sure.
            children = await_that(lambda: len(c := system.children()) >= 3 and "sleep" in map(name_of, c) and c,
                                  "children")
            for pid in children:
                try:
                    policy, name = os.sched_getscheduler(pid), name_of(pid)
                except OSError:
                    continue
                self.assertIn(policy, (os.SCHED_OTHER, os.SCHED_IDLE), f"{name} {pid} is a real-time process")
            sleeper = [p for p in children if name_of(p) == "sleep"]
            self.assertEqual(len(sleeper), 1)
            # The child closes the files of its loader before it sleeps.
            await_that(lambda: sorted(descriptors(sleeper[0])) == [0, 1, 2], "no descriptor but its own three")
            # Its rtpu ends: so do they, while the others go on; a stopped memory holder does not keep its memory.
            system.disarm()
            second = system.pids()["second"]
            memory_holder = system.memory_holder_of(second)
            if memory_holder:
                system.kill(memory_holder, signal.SIGSTOP)
            system.kill(second)
            await_that(lambda: not system.children(), "the end of the children of a dead rtpu")
            if memory_holder:
                await_that(lambda: gone([memory_holder], system.marker), "the end of a stopped memory holder")
            self.assertGreater(system.task("steady")["cycles"], missed)
            self.assertEqual(system.rtpu("first")["restarts"], 0)
            # And again at the end of everything.
            system.await_state("child", "ON")
            system.arm()
            await_that(lambda: len(system.children()) >= 3, "children")
            system.disconnect()
            system.process.send_signal(signal.SIGTERM)
            self.assertEqual(system.wait(), 0, system.said())
            self.assertEqual(system.left_over(), [])

    def test_a_component_that_has_itself_traced_does_not_outlive_its_end(self):
        with Rig(tasks("traced"), 0) as system:
            system.arm()
            for how in (signal.SIGSEGV, signal.SIGKILL):
                before = system.rtpu("second")
                thread = await_that(lambda: traced_thread(before["pid"]), "a traced thread")
                ctypes.CDLL(None).tgkill(before["pid"], thread, how)
                after = system.await_restart("second", before)
                self.assertIn(how.name, after["last_end"])
                system.await_state("traced", "ON")
            await_that(lambda: traced_thread(after["pid"]), "a traced thread")
            system.disconnect()
            system.process.send_signal(signal.SIGTERM)
            self.assertEqual(system.wait(), 0, system.said())
            self.assertRegex(system.said(), r"not clean: .*\b2 restarts of second")  # and misses of a busy machine
            self.assertEqual(system.left_over(), [])

    def test_children_end_also_when_the_keeper_was_killed(self):
        with Rig(tasks("child", "daemon", "exec"), 0) as system:
            system.arm()
            await_that(lambda: len(system.children()) >= 3, "children")
            system.disconnect()
            system.process.kill()
            system.wait()
            system.await_nothing_left()


class Watched(unittest.TestCase):
    def test_growing_memory_and_lost_rights_are_reported(self):
        with Rig(tasks("leak", "ordinary", "unlocked", rate="1 kHz")) as system:
            before = system.rtpu("second")["resident_bytes"]
            self.assertGreater(before, 1 << 20)
            self.assertIsNone(system.rtpu("second")["lost_rights"])
            system.arm()

            def told(kind):
                return [e["text"] for e in system.events() if e["kind"] == kind and e.get("rtpu") == "second"]
            grown = await_that(lambda: told("memory"), "the growth")
            self.assertRegex(grown[0], r"^second has grown to \d+ MB resident, from \d+ MB when it was ON")
            self.assertGreater(system.rtpu("second")["resident_bytes"], before + (64 << 20))
            self.assertNotIn("first", [e.get("rtpu") for e in system.events() if e["kind"] in ("memory", "rights")])
            if not rt_rights():
                return self.skipTest("no real-time rights on this machine: none can be given up")
            lost = await_that(lambda: told("rights"), "the lost priority")
            self.assertRegex(lost[0], r"^second gave up real-time rights: .*SCHED_OTHER instead of SCHED_FIFO 20")
            self.assertIn("SCHED_OTHER", system.rtpu("second")["lost_rights"])


if __name__ == "__main__":
    unittest.main()
