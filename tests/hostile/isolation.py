# SPDX-License-Identifier: Apache-2.0
"""What the misdeeds of one rtpu cost another rtpu that has a CPU of its own.

`good` runs at 1 kHz on CPU 0, t_misdeed or t_crash on CPU 1. For each misdeed: a quiet span, then the span with the
misdeed, then one line with the cycles that `good` lost (deadlines missed and releases dropped) in both, of how many.
The machine loses some by itself: a quiet span says how many.

usage: isolation.py --build TREE [--seconds N] [--span S] [MISDEED...]
The last line is {"name": ..., "n": cycles beside misdeeds, "faults": misdeeds beside which `good` lost clearly more
than in its quiet spans in each of five tries, or its unit was restarted; "tries_with_loss": tries that lost clearly
more}. A misdeed that costs something costs it every time, what the host takes does not.
Exit 77: no real-time rights, or only one CPU.
"""
import argparse
import json
import os
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "processes"))

CRASHES = ("segv", "abort", "fpe", "stack", "exit", "vanish", "scribble", "hang", "sleep")
OTHERS = ("child", "daemon", "chain", "exec", "stays", "leak", "ordinary", "top", "strays", "unlocked", "close", "spin")
PRIORITY = 40
DEADLINE_US = 900
# More than this beyond the quiet span is no chance: what a virtual machine's host takes away comes in such pieces.
CHANCE = 6
TRIES = 5


def text_of(way, executor):
    component = "t_crash" if way in CRASHES else "t_misdeed"
    return f"""
subsystem: subject
rtpus:
  good: {{cpu: 0, policy: edf}}
  evil: {{cpu: 1, policy: edf{', executor: preemptive' if executor == 'preemptive' else ''}}}
tasks:
  good: {{component: t_counter, rtpu: good, rate: 1 kHz, deadline: {DEADLINE_US} us}}
  evil: {{component: {component}, rtpu: evil, rate: 100 Hz, alias: {{y: z}}, constants: {{how: {way}}},
         resources: {{armed: ARMED}}}}
configurations: {{all: [good, evil]}}
start: all
"""


def lost_in(system, span):
    """(lost, cycles) of `good` in that time."""
    before = system.task("good")
    time.sleep(span)
    after = system.task("good")
    lost = sum(after[key] - before[key] for key in ("missed", "dropped"))
    return lost, after["cycles"] - before["cycles"]


def measure(way, executor, span):
    from system import System
    with System(text_of(way, executor), arguments=("--priority", str(PRIORITY))) as system:
        time.sleep(0.2)
        quiet = lost_in(system, span)
        system.arm()
        beside = lost_in(system, span)
        system.disarm()
        return quiet, beside, system.rtpu("good")["restarts"], system.rtpu("evil")["restarts"]


def judge(way, executor, span, count):
    """Counts what was seen; True for a misdeed that costs the other unit something in each try, or harms it."""
    for _ in range(TRIES):
        (quiet, n_quiet), (beside, n_beside), harmed, restarts = measure(way, executor, span)
        is_loss = beside > quiet + CHANCE
        print(f"{way:9} quiet: lost {quiet} of {n_quiet}, beside it: lost {beside} of {n_beside}, evil restarted "
              f"{restarts} times{'  HARMED' if harmed else '  MORE' if is_loss else ''}", flush=True)
        count["n"] += n_beside
        count["lost_beside"] += beside
        count["lost_quiet"] += quiet
        count["tries_with_loss"] += is_loss
        if harmed or not is_loss:
            return harmed > 0
    return True


def why_not():
    if len(os.sched_getaffinity(0)) < 2:
        return "isolation with a CPU for each unit needs two CPUs"
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    except OSError:
        return "no right to real-time priorities"
    return ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("misdeeds", nargs="*", metavar="MISDEED", help="of " + " ".join(CRASHES + OTHERS) + " (all)")
    parser.add_argument("--build", required=True, help="the tree whose programs are measured")
    parser.add_argument("--seconds", type=float, default=0, help="again and again for that time")
    parser.add_argument("--span", type=float, default=1.0, help="seconds of each span (1)")
    parser.add_argument("--executor", choices=("executive", "preemptive"), default="executive", help="of the evil unit")
    arguments = parser.parse_args()
    unknown = set(arguments.misdeeds) - set(CRASHES + OTHERS)
    if unknown:
        parser.error(f"no such misdeed: {' '.join(sorted(unknown))}")
    if reason := why_not():
        print(reason)
        return 77
    os.environ["CHIMERA_BUILD"] = arguments.build
    end = time.monotonic() + arguments.seconds
    count = {"n": 0, "faults": 0, "counted": "cycles", "lost_beside": 0, "lost_quiet": 0, "tries_with_loss": 0}
    while count["n"] == 0 or time.monotonic() < end:
        for way in arguments.misdeeds or CRASHES + OTHERS:
            count["faults"] += judge(way, arguments.executor, arguments.span, count)
            if arguments.seconds and time.monotonic() > end:
                break
    print(json.dumps({"name": "hostile_isolation", **count}))
    return 1 if count["faults"] else 0


if __name__ == "__main__":
    sys.exit(main())
