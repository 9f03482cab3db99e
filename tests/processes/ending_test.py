# SPDX-License-Identifier: Apache-2.0
"""How a subsystem ends: in order, whoever ends it, and without leaving anything behind."""
import os
import random
import signal
import time
import unittest

from system import CHAIN, System

ROUNDS = int(os.environ.get("CHIMERA_ROUNDS", "1"))


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
            system.kill(system.pids()["manager"], signal.SIGSTOP)
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


if __name__ == "__main__":
    unittest.main(verbosity=1)
