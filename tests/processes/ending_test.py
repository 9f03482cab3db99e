# SPDX-License-Identifier: Apache-2.0
"""How a subsystem ends: in order, whoever ends it, and without leaving anything behind."""
import os
import random
import signal
import sys
import time
import unittest

from system import System, await_that

ROUNDS = int(os.environ.get("CHIMERA_ROUNDS", "1"))
SEED = int(os.environ.get("CHIMERA_SEED", str(random.SystemRandom().randrange(1 << 32))))

# A chain over two units: device -> a -> b -> c -> device, so that the order of the end is known.
CHAIN = """
subsystem: subject
rtpus:
  first: {cpu: 0, policy: edf}
  second: {cpu: 1, policy: edf}
tasks:
  a: {component: t_recorder, rtpu: first, rate: 100 Hz, alias: {x: x0, y: x1}, constants: {label: a}}
  b: {component: t_recorder, rtpu: second, rate: 100 Hz, alias: {x: x1, y: x2}, constants: {label: b}}
  c: {component: t_recorder, rtpu: first, rate: 100 Hz, alias: {x: x2, y: x3}, constants: {label: c}}
operator: {x0: 0}
configurations:
  all: [a, b, c]
start: all
"""


class Ending(unittest.TestCase):
    def judge(self, lines):
        """off of every task before its kill; consumers off before their producers."""
        at = {}
        for label, method, when in lines:
            at.setdefault((label, method), when)
        for label in "abc":
            self.assertIn((label, "off"), at, lines)
            self.assertIn((label, "kill"), at, lines)
            self.assertLess(at[label, "off"], at[label, "kill"])
        self.assertLess(at["c", "off"], at["b", "off"])
        self.assertLess(at["b", "off"], at["a", "off"])

    def test_row_29_signals_of_the_system_end_it_in_order_and_in_time(self):
        for word in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            for _ in range(ROUNDS):
                with self.subTest(word), System(CHAIN) as system:
                    time.sleep(random.random() * 0.05)
                    began = time.monotonic()
                    system.process.send_signal(word)
                    system.process.wait(10)
                    self.assertLess(time.monotonic() - began, 5)
                    system.await_nothing_left()
                    self.judge(system.lines())
                    self.assertFalse(system.socket.exists())

    def test_the_end_comes_without_a_manager_too(self):
        with System(CHAIN) as system:
            os.kill(system.pids()["manager"], signal.SIGSTOP)
            system.process.send_signal(signal.SIGTERM)
            system.process.wait(10)
            system.await_nothing_left()
            self.judge(system.lines())

    def test_when_the_keeper_is_killed_every_unit_ends_its_tasks(self):
        for _ in range(ROUNDS):
            with System(CHAIN) as system:
                system.process.kill()
                system.process.wait()
                system.await_nothing_left()
                self.judge(system.lines())

    def test_a_unit_whose_off_hangs_is_ended_all_the_same(self):
        with System(CHAIN.replace("{label: b}", "{label: b, slow: 60000000000 ns}")) as system:
            began = time.monotonic()
            system.process.send_signal(signal.SIGTERM)
            system.process.wait(20)
            self.assertLess(time.monotonic() - began, 15)
            system.await_nothing_left()

    def test_random_kills_leave_nothing_behind(self):
        random.seed(SEED)
        print(f"seed {SEED}", file=sys.stderr)
        kills = 0
        for _ in range(2 * ROUNDS):
            with System(CHAIN) as system:
                for _ in range(random.randrange(1, 6)):
                    try:
                        pids = system.pids()
                    except (OSError, StopIteration):
                        break
                    for name in random.sample(sorted(pids), random.randrange(1, len(pids) + 1)):
                        try:
                            os.kill(pids[name], signal.SIGKILL)
                            kills += 1
                        except ProcessLookupError:
                            pass
                    if system.process.poll() is not None or "keeper" not in pids:
                        break
                    time.sleep(random.random() * 0.05)
                    if not os.path.exists(f"/proc/{pids['keeper']}"):
                        break
                    system.process.poll()
                    if system.process.returncode is not None:
                        break
                system.process.terminate()
                await_that(lambda: system.process.poll() is not None, 15, "the end of the keeper")
                system.await_nothing_left(15)
        print(f"random kills: {kills}", file=sys.stderr)
        self.assertGreater(kills, 0)
        self.assertEqual([name for name in os.listdir("/dev/shm") if "chimera" in name], [])


if __name__ == "__main__":
    unittest.main(verbosity=1)
