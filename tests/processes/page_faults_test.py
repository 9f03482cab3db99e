# SPDX-License-Identifier: Apache-2.0
"""From arming on no real-time thread takes a page fault: a switch brings no page in for the first time. Counted by the
kernel for each thread with a real-time policy, over switches there and back and over the first ones, in executives and
where each task has a thread. Memory that is locked in a release build only; else it says so and is skipped."""
import os
import pathlib
import sys

from switch_test import MIXED, PREEMPTIVE, TEXT
from system import System

SWITCHES = int(os.environ.get("CHIMERA_ROUNDS", "20"))
MINOR, MAJOR, POLICY = 9, 11, 40  # in /proc/PID/stat, from 0
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


def judge(text):
    """What is wrong in a run of the description; None: it cannot be judged."""
    wrong = []
    with System(text, ("--priority", "80")) as system:
        units = {name: pid for name, pid in system.pids().items() if name in ("first", "second")}
        for name, pid in units.items():
            if locked_kib(pid) == 0 or not page_faults(pid):
                return None
        for number in range(SWITCHES):
            before = {name: page_faults(pid) for name, pid in units.items()}
            receipt = system.call("switch", configuration=("quick", "gentle")[number % 2])
            if receipt["end"] != "done":
                wrong.append(f"switch {number + 1}: {receipt['end']}, {receipt['why']}")
            for name, pid in units.items():
                for thread, (what, n) in page_faults(pid).items():
                    more = n - before[name].get(thread, (what, n))[1]
                    if more:
                        wrong.append(f"switch {number + 1}: {more} page faults of thread {what} of {name}")
    return wrong


def main():
    for text in (TEXT, MIXED, PREEMPTIVE):
        wrong = judge(text)
        if wrong is None:
            print("skipped: the system grants no locked memory or no real-time rights")
            return 77
        if wrong:
            print("\n".join(wrong))
            return 1
    print(f"{3 * SWITCHES} switches without a page fault of a real-time thread")
    return 0


if __name__ == "__main__":
    sys.exit(main())
