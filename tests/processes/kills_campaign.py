# SPDX-License-Identifier: Apache-2.0
"""Any of the processes of a subsystem, any number of them, killed at any moment: nothing is left behind, and a reader
never sees half of a value. A part of the campaigns `process_ending` and `process_faults`."""
import fcntl
import os
import pathlib
import random
import socket
import time
import unittest

from campaign import ROUNDS, begin, counted
from system import CHAIN, RTPUS, System, await_that, processes_of

# The producer spends half of its time in the middle of a publication.
WHOLE = RTPUS + """
tasks:
  whole: {component: t_whole, rtpu: second, rate: 1 kHz, constants: {spend: 500000 ns}}
  judge: {component: t_judge, rtpu: first, rate: 1 kHz}
configurations: {all: [whole, judge]}
start: all
"""


class Kills(unittest.TestCase):
    def setUp(self):
        begin()

    def wave(self, system):
        """Kills a random choice of the processes in random order; the keeper in one wave of ten."""
        keeper = system.process.pid
        living = [pid for pid in processes_of(system.marker) if pid != keeper or random.random() < 0.1]
        for pid in random.sample(living, random.randrange(0, len(living) + 1)):
            counted("kills", system.kill(pid))
            if random.random() < 0.3:
                time.sleep(random.random() * 0.01)

    def judge_end(self, system):
        """Neither a process nor a lock is left, and at most a socket on which no process listens."""
        system.await_nothing_left()
        folder = system.socket.parent
        if not folder.exists():  # killed before it was made
            return
        inode = os.stat(folder).st_ino
        locks = pathlib.Path("/proc/locks").read_text().splitlines()
        self.assertEqual([line for line in locks if f":{inode} " in line], [])
        self.assertLessEqual(set(os.listdir(folder)), {system.socket.name})
        with socket.socket(socket.AF_UNIX) as asking, self.assertRaises(OSError):
            asking.connect(str(system.socket))
        held = os.open(folder, os.O_RDONLY)
        fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)  # raises when a process has it
        os.close(held)

    def test_random_kills_of_any_mix_of_processes_leave_nothing_behind(self):
        shared = set(os.listdir("/dev/shm"))
        for _ in range(ROUNDS):
            with System(CHAIN, wait=random.random() < 0.5) as system:
                for _ in range(random.randrange(1, 8)):
                    time.sleep(random.random() * 0.1)
                    self.wave(system)
                if system.process.poll() is None:
                    system.process.terminate()
                system.wait()
                self.judge_end(system)
        self.assertEqual({name for name in set(os.listdir("/dev/shm")) - shared if "chimera" in name}, set())

    def test_row_8_a_reader_of_a_killed_producer_sees_only_whole_values_and_never_older_ones(self):
        for _ in range(ROUNDS):
            with System(WHOLE) as system:
                before = system.task("judge")
                for _ in range(3):  # as often as an rtpu is restarted in 10 s
                    time.sleep(random.random() * 0.02)
                    unit = system.rtpu("second")
                    counted("kills", system.kill(unit["pid"]))
                    system.await_restart("second", unit)
                    seen = system.value("seen")
                    await_that(lambda: system.value("seen") > seen + 5, "values of the next incarnation")
                for name in ("torn", "backward", "invalid"):
                    self.assertEqual(system.value(name), 0, name)
                after = system.task("judge")
                self.assertEqual((after["state"], after["incarnation"]), ("ON", before["incarnation"]))


if __name__ == "__main__":
    unittest.main(verbosity=1)
