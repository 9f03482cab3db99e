# SPDX-License-Identifier: Apache-2.0
"""What the misdeeds of one rtpu cost another rtpu that has a CPU of its own.

`good` runs at 1 kHz on CPU 0, t_misdeed or t_crash on CPU 1. For each misdeed: a quiet span, then a span with the
misdeed, then one line with the cycles that `good` lost (deadlines missed and releases dropped) in both. A fault is a
misdeed beside which `good` lost clearly more than in its quiet span in each of five tries, or after which its rtpu was
restarted: a misdeed that costs something costs it every time, what the host takes does not.

usage: isolation_campaign.py --build TREE --seconds N
Exit 77: no real-time rights, or only one CPU.
"""
import os
import sys
import time

import campaigns

CRASHES = ("segv", "abort", "fpe", "stack", "exit", "vanish", "scribble", "hang", "sleep")
MISDEEDS = CRASHES + ("child", "daemon", "chain", "exec", "stays", "leak", "ordinary", "top", "strays", "unlocked",
                      "close", "spin")
SPAN = 1.0  # s
CHANCE = 6  # cycles beyond those of the quiet span that a virtual machine may lose by itself
TRIES = 5
TEXT = """
subsystem: subject
rtpus:
  good: {cpu: 0, policy: edf}
  evil: {cpu: 1, policy: edf, executor: EXECUTOR}
tasks:
  good: {component: t_counter, rtpu: good, rate: 1 kHz, deadline: 900 us}
  evil: {component: COMPONENT, rtpu: evil, rate: 100 Hz, alias: {y: z}, constants: {how: WAY},
         resources: {armed: ARMED}}
configurations: {all: [good, evil]}
start: all
"""


def lost_in(system):
    """(lost, cycles) of `good` in a span."""
    before = system.task("good")
    time.sleep(SPAN)
    after = system.task("good")
    return sum(after[key] - before[key] for key in ("missed", "dropped")), after["cycles"] - before["cycles"]


class Isolation:
    def __init__(self, arguments):
        from system import System
        self.start = System
        self.count = {"n": 0, "counted": "cycles", "lost_beside": 0, "lost_quiet": 0, "tries_with_loss": 0}

    def once(self, number):
        way = MISDEEDS[number % len(MISDEEDS)]
        executor = "preemptive" if number // len(MISDEEDS) % 2 else "executive"
        text = TEXT.replace("COMPONENT", "t_crash" if way in CRASHES else "t_misdeed").replace("WAY", way)
        for _ in range(TRIES):
            is_loss, is_harmed = self.measure(way, text.replace("EXECUTOR", executor))
            if is_harmed:
                return [f"{way}: the other rtpu was restarted"]
            if not is_loss:
                return []
        return [f"{way} in an {executor} rtpu costs the other rtpu cycles"]

    def measure(self, way, text):
        with self.start(text, ("--priority", "40")) as system:
            quiet, _ = lost_in(system)
            system.arm()
            beside, n = lost_in(system)
            system.disarm()
            restarts = {name: system.rtpu(name)["restarts"] for name in ("good", "evil")}
        is_loss = beside > quiet + CHANCE
        print(f"{way:9} lost {quiet} in a quiet span, {beside} of {n} beside it, restarts {restarts}", flush=True)
        for key, more in (("n", n), ("lost_beside", beside), ("lost_quiet", quiet), ("tries_with_loss", is_loss)):
            self.count[key] += more
        return is_loss, restarts["good"] > 0

    def figures(self):
        return self.count


def why_not():
    if len(os.sched_getaffinity(0)) < 2:
        return "isolation with a CPU for each rtpu needs two CPUs"
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    except OSError:
        return "no right to real-time priorities"
    return ""


if __name__ == "__main__":
    if reason := why_not():
        print(reason)
        sys.exit(77)
    sys.exit(campaigns.run("hostile_isolation", __doc__, Isolation))
