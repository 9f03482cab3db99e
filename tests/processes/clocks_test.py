# SPDX-License-Identifier: Apache-2.0
"""Fault row 17: the wall clock jumps, and only stamps notice. The campaign `process_clocks` has more jumps."""
import mmap
import random
import struct
import tempfile
import time
import unittest

from campaign import ROUNDS, begin, counted
from descriptions import SWITCH
from system import BUILD, QUIET, System

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
        begin()
        clock, n = WallClock(), max(ROUNDS, 8)
        with System(SWITCH, environment=clock.environment) as system:
            pids, since = system.pids(), system.next_event()
            for jump in range(n):
                clock.jump(random.choice((HOUR_NS, -HOUR_NS, 10 ** 9, -10 ** 9, random.randrange(-10 ** 6, 10 ** 6))))
                system.await_cycles("reference", 5)
                if jump % 4 == 3:
                    target = "quick" if jump % 8 == 3 else "gentle"
                    receipt = system.call("switch", configuration=target)
                    self.assertEqual((receipt["to"], receipt["end"]), (target, "done"), receipt)
                    self.assertLess(abs(receipt["wall_ns"] - clock.shown_ns()), HOUR_NS / 2, "the stamp has the jump")
            self.assertEqual(system.pids(), pids, "no process was taken for hung or dead")
            kinds = {event["kind"] for event in system.events(since)}
            self.assertFalse(kinds & {"rtpu-ended", "rtpu-restarted", "manager-started", "hang"}, kinds)
        counted("jumps", n)


if __name__ == "__main__":
    unittest.main()
