# SPDX-License-Identifier: Apache-2.0
# Needs: process_campaigns
"""Row 13, detection: from the SIGKILL of a real-time unit to its death as the manager tells it (event rtpu-ended), by
way of the keeper's pidfd. Baseline: a pidfd polled in this very process."""
import json
import os
import pathlib
import select
import signal
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "tests" / "processes"))
from system import System, await_that  # noqa: E402

GOAL_US = 200
ROUNDS = 100
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
    """Microseconds until the pidfd of a killed child is readable."""
    child = os.fork()
    if child == 0:
        signal.pause()
        os._exit(0)
    pidfd = os.pidfd_open(child)
    time.sleep(0.002)
    began = time.monotonic_ns()
    signal.pidfd_send_signal(pidfd, signal.SIGKILL)
    select.select([pidfd], [], [])
    took = (time.monotonic_ns() - began) / 1e3
    os.waitpid(child, 0)
    os.close(pidfd)
    return took


def once(system):
    """Microseconds until the death is told; the unit is brought back afterwards."""
    since = system.call("events", since=0)["last"]
    pid = system.rtpu("second")["pid"]
    pidfd = os.pidfd_open(pid)
    began = time.monotonic_ns()
    signal.pidfd_send_signal(pidfd, signal.SIGKILL)
    os.close(pidfd)
    ended = await_that(lambda: [e for e in system.events(since + 1) if e["kind"] == "rtpu-ended"], 5)[0]
    if any(e["kind"] == "rtpu-given-up" for e in system.events(since + 1)):
        system.signal("clear", "victim")
        system.signal("on", "victim")
    system.await_state("victim", "ON")
    return (ended["at_ns"] - began) / 1e3


def percentile(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


baseline = [pidfd_of_a_child() for _ in range(300)]
with System(TEXT, ("--priority", "80")) as system:
    times = [once(system) for _ in range(ROUNDS)]
figure = percentile(times, 0.99)
print(json.dumps({"row": 13, "what": f"death seen, p99 (p50 {statistics.median(times):.0f}, max {max(times):.0f} us)",
                  "unit": "us", "figure": round(figure, 1), "baseline": round(percentile(baseline, 0.99), 1),
                  "baseline_name": "pidfd alone, p99", "goal": f"<= {GOAL_US} us", "met": figure <= GOAL_US,
                  "n": ROUNDS}))
