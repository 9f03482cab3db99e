# SPDX-License-Identifier: Apache-2.0
"""Fault row 17: the wall clock jumps, and nothing but stamps notices. CHIMERA_ROUNDS: jumps."""
import mmap
import os
import random
import struct
import sys
import tempfile
import time
import unittest

from switch_test import TEXT
from system import BUILD, QUIET, System

ROUNDS = int(os.environ.get("CHIMERA_ROUNDS", "60"))
SEED = int(os.environ.get("CHIMERA_SEED", str(random.SystemRandom().randrange(1 << 32))))
HOUR_NS = 3600 * 10 ** 9


class WallClock:
    """The clock of the processes of `environment`, which can be set."""

    def __init__(self):
        self.file = tempfile.NamedTemporaryFile(prefix="chimera-wall-")
        self.file.write(bytes(8))
        self.file.flush()
        self.ahead = mmap.mmap(self.file.fileno(), 8)
        shim = BUILD / "tests/processes/libjumping_clock.so"
        assert shim.exists(), f"{shim} is not built"
        self.environment = {"LD_PRELOAD": str(shim), "CHIMERA_WALL": self.file.name,
                            "ASAN_OPTIONS": QUIET + ":verify_asan_link_order=0"}

    def jump(self, by_ns):
        self.ahead[:] = struct.pack("=q", struct.unpack("=q", self.ahead[:])[0] + by_ns)

    def shown_ns(self):
        return time.time_ns() + struct.unpack("=q", self.ahead[:])[0]


class Clocks(unittest.TestCase):
    def test_row_17_a_wall_clock_that_jumps_changes_no_cycle_and_no_deadline(self):
        random.seed(SEED)
        print(f"seed {SEED}", file=sys.stderr)
        clock = WallClock()
        with System(TEXT, environment=clock.environment) as system:
            pids, began = system.pids(), time.monotonic()
            cycles = system.task("reference")["cycles"]
            for n in range(ROUNDS):
                clock.jump(random.choice((HOUR_NS, -HOUR_NS, 10 ** 9, -10 ** 9, random.randrange(-10 ** 6, 10 ** 6))))
                if n % 10 == 9:
                    target = "quick" if n % 20 == 9 else "gentle"
                    asked = time.monotonic()
                    receipt = system.switch(target)
                    self.assertEqual((receipt["to"], receipt["end"]), (target, "done"), receipt)
                    self.assertLess(abs(receipt["wall_ns"] - clock.shown_ns()), 60 * 10 ** 9)
                    self.assertLess((receipt["ended_ns"] - receipt["asked_ns"]) / 1e9, time.monotonic() - asked + 1)
                else:
                    time.sleep(random.random() * 0.02)
            took = time.monotonic() - began
            done = system.task("reference")["cycles"] - cycles
            self.assertEqual(system.pids(), pids, "nobody was taken for hung or dead")
            self.assertLess(done, 100 * (took + 1), "no release came because of the wall clock")
            self.assertGreater(done, 100 * (took - 1) / 2, "none stayed away because of it, on a machine that is busy")
            kinds = {event["kind"] for event in system.events() if event["at_ns"] / 1e9 > began}
            self.assertFalse(kinds & {"rtpu-ended", "rtpu-started", "manager", "hang"}, kinds)
        print(f"jumps: {ROUNDS}", file=sys.stderr)


if __name__ == "__main__":
    unittest.main()
