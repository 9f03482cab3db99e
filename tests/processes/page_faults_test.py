# SPDX-License-Identifier: Apache-2.0
"""From arming on no real-time thread takes a page fault: a switch brings no page in for the first time, a slow one with
`kill`, `init` and `reinit` and the takeover by a standby neither. Counted by the kernel for each real-time thread, over
switches there and back and over the first ones, in executives and where each task has a thread. The guard stands above
all of them, with its memory locked. Memory is locked in a release build only; else it says so and is skipped."""
import os
import pathlib
import sys

import frames_test
from descriptions import DEVICE_SWITCH, SLOW_SWITCH, STANDBY, SWITCH, mixed, preemptive
from system import System

SWITCHES = int(os.environ.get("CHIMERA_ROUNDS", "20"))
MINOR, MAJOR, PRIORITY, POLICY = 9, 11, 39, 40  # in /proc/PID/stat, from 0
ABOVE_ALL = 81  # the bands of a run are counted down from --priority 80
SCHED_FIFO = "1"


def fields(path):
    text = path.read_text()
    return [text.split(" ", 1)[0], text[text.index("("):text.rindex(")") + 1], *text[text.rindex(")") + 2:].split()]


def page_faults(pid):
    """{thread: (its name, page faults so far)} of those that are real-time."""
    found = {}
    for thread in pathlib.Path(f"/proc/{pid}/task").iterdir():
        of = fields(thread / "stat")
        if of[POLICY] == SCHED_FIFO:
            found[thread.name] = (of[1], int(of[MINOR]) + int(of[MAJOR]))
    return found


def locked_kib(pid):
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(next(line for line in status.splitlines() if line.startswith("VmLck:")).split()[1])


class Watch:
    """Page faults of the real-time threads of two rtpus from here on."""

    def __init__(self, system):
        self.rtpus = {name: pid for name, pid in system.pids().items() if name in ("first", "second")}
        self.before = {name: page_faults(pid) for name, pid in self.rtpus.items()}

    def is_judged(self):
        return all(locked_kib(pid) > 0 and self.before[name] for name, pid in self.rtpus.items())

    def more(self, what):
        found = []
        for name, pid in self.rtpus.items():
            if not pathlib.Path(f"/proc/{pid}/task").is_dir():
                continue  # it was killed
            for thread, (of, n) in page_faults(pid).items():
                if more := n - self.before[name].get(thread, (of, n))[1]:
                    found.append(f"{what}: {more} page faults of thread {of} of {name}")
        return found


def judge_takeover():
    with System(STANDBY, ("--priority", "80")) as system:
        system.await_value("seen", 2)
        watch = Watch(system)
        if not watch.is_judged():
            return None
        system.kill(watch.rtpus["first"])
        system.await_state("spare", "ON")
        return watch.more("takeover")


def judge_guard():
    drive = frames_test.Drive(1)
    try:
        text = frames_test.TEXT.replace("LINE", drive.name).replace("RATE", "100 Hz").replace("TORQUE", "[3]")
        with System(text, ("--priority", "80")) as system:
            system.await_state("drive", "ON")
            guard, = system.named("chimera-guard")
            stat, locked = fields(pathlib.Path(f"/proc/{guard}/stat")), locked_kib(guard)
            if (stat[POLICY], stat[PRIORITY]) != (SCHED_FIFO, str(ABOVE_ALL)) or locked == 0:
                return [f"the guard has policy {stat[POLICY]}, priority {stat[PRIORITY]}, {locked} KiB locked"]
            return [f"thread {thread} of {name} is not below the guard"
                    for name, pid in system.pids().items() if name in ("first", "second")
                    for thread in pathlib.Path(f"/proc/{pid}/task").iterdir()
                    if int(fields(thread / "stat")[PRIORITY]) >= ABOVE_ALL]
    finally:
        drive.end()


def judge_switches(text, there, back):
    """What is wrong in switches of the description there and back; None: it cannot be judged."""
    wrong = []
    with System(text, ("--priority", "80")) as system:
        for number in range(SWITCHES):
            watch = Watch(system)
            if not watch.is_judged():
                return None
            receipt = system.call("switch", configuration=(there, back)[number % 2])
            if receipt["end"] != "done":
                wrong.append(f"switch {number + 1}: {receipt['end']}, {receipt['why']}")
            print(f"switch {number + 1}: {receipt['way']}")
            wrong += watch.more(f"switch {number + 1}")
    return wrong


def main():
    runs = [(judge_switches, text, "quick", "gentle") for text in (SWITCH, mixed(SWITCH), preemptive(SWITCH))]
    runs += [(judge_switches, text, "with_heavy", "with_light") for text in (SLOW_SWITCH, preemptive(SLOW_SWITCH))]
    runs += [(judge_switches, DEVICE_SWITCH, "with_drill", "with_hand"), (judge_takeover,), (judge_guard,)]
    for run, *given in runs:
        wrong = run(*given)
        if wrong is None:
            print("skipped: the system grants no locked memory or no real-time rights")
            return 77
        if wrong:
            print("\n".join(wrong))
            return 1
    print(f"{6 * SWITCHES} switches and a takeover without a page fault of a real-time thread; the guard above them")
    return 0


if __name__ == "__main__":
    sys.exit(main())
