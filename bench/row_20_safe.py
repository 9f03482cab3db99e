# SPDX-License-Identifier: Apache-2.0
# Needs: process_campaigns
"""Row 20: from the SIGKILL of an rtpu to its safe frame at the other end of the serial line. Baseline, in turn
with it: the pidfd of a small child polled in this very process, which then writes the same bytes to a line of its
own."""
import json
import os
import pathlib
import select
import signal
import statistics
import subprocess
import sys
import time
import tty

sys.path.insert(0, str(pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "tests" / "processes"))
from percentile import percentile  # noqa: E402
from system import System, await_that  # noqa: E402

GOAL_US = 1000
ROUNDS = 100
QUIET_S = 0.03
FILL = bytes(132)
TEXT = """
subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 1 kHz}
  drive:
    {component: serial_frame, rtpu: second, rate: 1 kHz, alias: {command: torque}, constants: {timeout: 3600 s},
     resources: {device: LINE}}
operator: {torque: [3]}
configurations: {all: [steady, drive]}
start: all
"""


class Line:
    def __init__(self):
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        os.set_blocking(self.master, False)
        self.name = os.ttyname(self.slave)

    def drain(self):
        while select.select([self.master], [], [], 0)[0]:
            os.read(self.master, 65536)

    def await_fill(self, limit=5):
        """The instant at which the safe frame was there."""
        held, end = b"", time.monotonic() + limit
        while FILL not in held:
            if not select.select([self.master], [], [], max(0, end - time.monotonic()))[0]:
                raise AssertionError("no safe frame")
            held += os.read(self.master, 65536)
        return time.monotonic_ns()


def small_child(line):
    """Microseconds until a killed child is seen dead here and the bytes are through a line."""
    child = subprocess.Popen(["/bin/sleep", "100"], stdin=subprocess.DEVNULL)
    pidfd = os.pidfd_open(child.pid)
    time.sleep(QUIET_S)
    began = time.monotonic_ns()
    signal.pidfd_send_signal(pidfd, signal.SIGKILL)
    select.select([pidfd], [], [])
    os.write(line.slave, FILL + bytes(8))
    took = (line.await_fill() - began) / 1e3
    child.wait()
    os.close(pidfd)
    return took


def once(system, line):
    since = system.call("events", since=0)["last"]
    pidfd = os.pidfd_open(system.rtpu("second")["pid"])
    time.sleep(QUIET_S)
    line.drain()
    began = time.monotonic_ns()
    signal.pidfd_send_signal(pidfd, signal.SIGKILL)
    took = (line.await_fill() - began) / 1e3
    os.close(pidfd)
    await_that(lambda: [e for e in system.events(since + 1) if e["kind"] == "rtpu-ended"])
    time.sleep(QUIET_S)
    if any(e["kind"] == "rtpu-given-up" for e in system.events(since + 1)):
        system.signal("clear", "drive")
        system.signal("on", "drive")
    system.await_state("drive", "ON")
    return took


def p50_p99(times):
    return f"p50 {statistics.median(times):.0f}", round(percentile(times, 0.99), 1)


line, own = Line(), Line()
frames, baseline = [], []
with System(TEXT.replace("LINE", line.name), ("--priority", "80")) as system:
    for _ in range(ROUNDS):
        baseline.append(small_child(own))
        frames.append(once(system, line))
middle, figure = p50_p99(frames)
middle_small, small = p50_p99(baseline)
print(json.dumps({"row": 20, "what": f"kill to safe frame, p99 ({middle})", "unit": "us", "figure": figure,
                  "baseline": small, "baseline_name": f"small child ({middle_small})",
                  "ratio": round(figure / small, 2), "goal": f"<= {GOAL_US} us", "met": figure <= GOAL_US,
                  "n": ROUNDS}))
