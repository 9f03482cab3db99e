# SPDX-License-Identifier: Apache-2.0
# Needs: process_campaigns
"""Row 13, detection: from the SIGKILL of an rtpu to the event rtpu-ended of the manager, by way of the keeper's pidfd.
Baseline, in turn with it: the pidfd of a small child polled in this very process. A death must cost the task of the
other rtpu no cycle. Its lost cycles are compared with those of an equally long time without a death."""
import json
import os
import pathlib
import select
import signal
import statistics
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "tests" / "processes"))
from percentile import percentile  # noqa: E402
from system import System, await_that  # noqa: E402

GOAL_US = 200
ROUNDS = 150
QUIET_S = 0.03
TEXT = """
subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 1 kHz}
  victim: {component: t_source, rtpu: second, rate: 1 kHz}
configurations: {all: [steady, victim]}
start: all
"""


def pidfd_of_a_child():
    """Microseconds until the pidfd of a killed child is readable: a small program with nothing locked."""
    child = subprocess.Popen(["/bin/sleep", "100"], stdin=subprocess.DEVNULL)
    pidfd = os.pidfd_open(child.pid)
    time.sleep(QUIET_S)
    began = time.monotonic_ns()
    signal.pidfd_send_signal(pidfd, signal.SIGKILL)
    select.select([pidfd], [], [])
    took = (time.monotonic_ns() - began) / 1e3
    child.wait()
    os.close(pidfd)
    return took


def end_memory_holder(pid):
    """Kills the second process of an rtpu (chimera/platform/process.h), to measure a death without it."""
    children = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    assert len(children) == 1, children
    os.kill(int(children[0]), signal.SIGKILL)  # it stays a zombie: its number is not used again


def once(system, with_memory_holder):
    """Microseconds until the event of the death. The rtpu is started again afterwards."""
    since = system.call("events", since=0)["last"]
    pid = system.rtpu("second")["pid"]
    pidfd = os.pidfd_open(pid)
    if not with_memory_holder:
        end_memory_holder(pid)
    time.sleep(QUIET_S)  # at the death the manager answers no client and has handled the last death
    began = time.monotonic_ns()
    signal.pidfd_send_signal(pidfd, signal.SIGKILL)
    os.close(pidfd)
    time.sleep(QUIET_S)
    ended = await_that(lambda: [e for e in system.events(since + 1) if e["kind"] == "rtpu-ended"])[0]
    if any(e["kind"] == "rtpu-given-up" for e in system.events(since + 1)):
        system.signal("clear", "victim")
        system.signal("on", "victim")
    system.await_state("victim", "ON")
    return (ended["at_ns"] - began) / 1e3


def lost(system):
    """Cycles of the task in the other rtpu that were late or not run so far."""
    task = system.task("steady")
    assert task["incarnation"] == 1 and task["faults"] == 0, task
    return task["dropped"] + task["missed"]


def counted(system, with_memory_holder):
    """(microseconds of once(), cycles that the other rtpu lost during it)"""
    before = lost(system)
    return once(system, with_memory_holder), lost(system) - before


baseline, quick, slow = [], [], []
with System(TEXT, ("--priority", "80")) as system:
    took = 0.0
    for _ in range(ROUNDS):
        baseline.append(pidfd_of_a_child())
        slow.append(counted(system, False))
        began = time.monotonic()
        quick.append(counted(system, True))
        took += time.monotonic() - began
    control = lost(system)
    time.sleep(took)
    control = lost(system) - control


def p50_p99(times):
    return f"p50 {statistics.median(times):.0f}", round(percentile(times, 0.99), 1)


middle, figure = p50_p99([took for took, _ in quick])
middle_small, small = p50_p99(baseline)
middle_slow, without = p50_p99([took for took, _ in slow])
print(json.dumps({"row": 13, "what": f"death seen, p99 ({middle})", "unit": "us", "figure": figure, "baseline": small,
                  "baseline_name": f"small child ({middle_small})", "ratio": round(figure / small, 2),
                  "goal": f"<= {GOAL_US} us", "met": figure <= GOAL_US, "n": ROUNDS}))
print(json.dumps({"row": 13, "what": "death seen, against no memory holder", "unit": "us", "figure": figure,
                  "baseline": without, "baseline_name": f"without ({middle_slow})",
                  "ratio": round(figure / without, 2), "goal": "< 1", "met": figure < without, "n": ROUNDS}))
for what, deaths in (("cycles that the other rtpu lost", quick), ("cycles lost without memory holder", slow)):
    missing = sum(n for _, n in deaths)
    print(json.dumps({"row": 13, "what": what, "unit": "", "figure": missing, "baseline": control,
                      "baseline_name": "no death", "goal": "no more than without death",
                      "met": missing <= control, "n": ROUNDS}))
