# SPDX-License-Identifier: Apache-2.0
"""Any of the processes of a subsystem, any number of them, killed at any moment: nothing is left behind. A bounded
count here; more of them are part of the campaign `process_ending`. CHIMERA_ROUNDS: subsystems that are started."""
import fcntl
import os
import pathlib
import random
import socket
import sys
import time
import unittest

from system import CHAIN, System, await_that, processes_of

ROUNDS = int(os.environ.get("CHIMERA_ROUNDS", "3"))
SEED = int(os.environ.get("CHIMERA_SEED", str(random.SystemRandom().randrange(1 << 32))))


def locks_of(path):
    """Lines of /proc/locks about this file or folder."""
    inode = os.stat(path).st_ino
    return [line for line in pathlib.Path("/proc/locks").read_text().splitlines() if f":{inode} " in line]


class Kills(unittest.TestCase):
    kills = 0

    @classmethod
    def tearDownClass(cls):
        print(f"seed {SEED}\nkills: {cls.kills}", file=sys.stderr)

    def wave(self, system):
        """Kills a random choice of what lives, in random order; the keeper only now and then."""
        keeper = system.process.pid
        living = [pid for pid in processes_of(system.marker) if pid != keeper or random.random() < 0.1]
        for pid in random.sample(living, random.randrange(0, len(living) + 1)):
            Kills.kills += system.kill(pid)
            if random.random() < 0.3:
                time.sleep(random.random() * 0.01)

    def judge_end(self, system):
        """Of a subsystem that has ended, whoever was killed before."""
        system.await_nothing_left(20)
        folder = system.socket.parent
        if not folder.exists():  # killed before it got there
            return
        self.assertEqual(locks_of(folder), [])
        self.assertLessEqual(set(os.listdir(folder)), {system.socket.name})
        with socket.socket(socket.AF_UNIX) as asking, self.assertRaises(OSError):  # at most a stale socket
            asking.connect(str(system.socket))
        held = os.open(folder, os.O_RDONLY)
        fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)  # raises when anybody has it
        os.close(held)

    def test_random_kills_of_any_mix_of_processes_leave_nothing_behind(self):
        random.seed(SEED)
        shared = set(os.listdir("/dev/shm"))
        for _ in range(ROUNDS):
            with System(CHAIN, wait=random.random() < 0.5) as system:
                for _ in range(random.randrange(1, 8)):
                    time.sleep(random.random() * 0.1)
                    self.wave(system)
                if system.process.poll() is None:
                    system.process.terminate()
                await_that(lambda: system.process.poll() is not None, 15, "the end of the keeper")
                self.judge_end(system)
        self.assertGreater(Kills.kills, 0)
        self.assertEqual({name for name in set(os.listdir("/dev/shm")) - shared if "chimera" in name}, set())

    def test_a_keeper_that_outlives_its_children_gathers_no_descriptors(self):
        with System(CHAIN) as system:
            def descriptors():
                return len(os.listdir(f"/proc/{system.process.pid}/fd"))
            before = descriptors()
            for name in ("first", "manager", "second", "manager", "first"):
                was = system.pids()[name]
                Kills.kills += system.kill(was)
                system.disconnect()
                await_that(lambda: system.pids().get(name, was) != was, 10, f"another {name}")
                for task in "abc":
                    system.await_state(task, "ON")
            await_that(lambda: descriptors() <= before, 5, f"at most {before} descriptors")


if __name__ == "__main__":
    unittest.main(verbosity=1)
