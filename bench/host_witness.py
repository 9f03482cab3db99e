# SPDX-License-Identifier: Apache-2.0
"""Says when the host took a processor away: what happens in real time then is not judged."""
import contextlib
import gc
import json
import math
import os
import select
import subprocess
import sys
import time

LATE_S = 100e-6
PERIOD_S = 0.0004


class HostWitness:
    """Wakes 2,500 times a second on that processor and keeps when it was late by more than 100 us: above everything,
    or, where the machine grants no real-time rights, like any other program."""

    def __init__(self, cpu):
        self.process = subprocess.Popen([sys.executable, __file__, str(cpu)], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)
        self.process.stdout.readline()

    def stalls(self):
        """Ends it. [(from, to)] in seconds of the monotonic clock."""
        return [tuple(stall) for stall in json.loads(self.process.communicate("\n")[0])]


def any_stall(stalls, begin=0.0, end=math.inf, longer_than=0.0):
    """One of them lay in that time and was that long."""
    return any(begin < to and since < end and to - since > longer_than for since, to in stalls)


def watch(cpu):
    os.sched_setaffinity(0, {cpu})
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(90))
    gc.disable()
    print(flush=True)
    stalls, due = [], time.monotonic() + PERIOD_S
    while not select.select([sys.stdin], [], [], 0)[0]:
        time.sleep(max(0, due - time.monotonic()))
        woken = time.monotonic()
        if woken - due > LATE_S:
            stalls.append((due, woken))
        due += PERIOD_S * (1 + int((woken - due) / PERIOD_S))
    print(json.dumps(stalls))


if __name__ == "__main__":
    watch(int(sys.argv[1]))
