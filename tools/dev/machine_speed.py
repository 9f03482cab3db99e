# SPDX-License-Identifier: Apache-2.0
"""How much slower than usual the machine is just now: the time that a fixed piece of work takes on two processors."""
import statistics
import subprocess
import time

WORK = "s = 0\nfor i in range(5_000_000): s += i * i"
USUAL_S = 0.35  # on the build machine, where it takes 0.25 to 0.87: decision 0004
PYTHON = "/usr/bin/python3"  # Debian's
N_PROGRAMS, TIMES = 2, 3


def slowness():
    """1 at the usual speed of the build machine and above, 2 where the work takes twice as long. Takes a second."""
    return max(1.0, statistics.median(_seconds() for _ in range(TIMES)) / USUAL_S)


def _seconds():
    begin = time.monotonic()
    programs = [subprocess.Popen([PYTHON, "-I", "-c", WORK]) for _ in range(N_PROGRAMS)]
    for program in programs:
        program.wait()
    return time.monotonic() - begin
