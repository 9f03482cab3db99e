# SPDX-License-Identifier: Apache-2.0
"""One or two processes are killed, the second at any moment of the takeover from the first; the process of the primary
is stopped and resumed: one of primary and standby is ON. The campaign `process_standby`."""
import random
import signal
import time
import unittest

from campaign import ROUNDS, begin, counted
from descriptions import DEVICE_STANDBY, STANDBY
from system import System, await_that

REST = 5.2  # s between two deaths of a process: three in 10 s and it is given up


class Standby(unittest.TestCase):
    def setUp(self):
        begin()

    def states(self, system):
        return {task["task"]: task["state"] for task in system.call("status")["tasks"]}

    def test_one_of_them_is_on_after_kills(self):
        last = {}
        with System(STANDBY) as system:
            for _ in range(ROUNDS):
                victims = []
                while not victims:
                    free = [who for who in ("first", "second", "manager") if time.monotonic() - last.get(who, 0) > REST]
                    victims = random.sample(free, min(len(free), random.choice((1, 2, 2))))
                    time.sleep(0.05)
                pids, pause = system.pids(), random.choice((0, 0.0005, 0.002, 0.01))
                for name in victims:
                    counted("kills", system.kill(pids[name]))
                    last[name] = time.monotonic()
                    time.sleep(random.random() * pause)
                system.disconnect()
                self.await_one_on(system, f"killed {victims}")

    def await_one_on(self, system, what):
        """The states are those before and after the value is read: a manager may not know of a death yet."""
        def holds():
            states, seen = self.states(system), system.value("seen")
            on = [name for name in ("main", "spare") if states[name] == "ON"]
            return (len(on) == 1 and states["user"] == states["reference"] == "ON" and states == self.states(system) and
                    seen == (2 if on == ["main"] else 3))
        await_that(holds, lambda: f"one of them to be ON ({what}): {system.told()}")

    def test_a_primary_that_is_silent_is_killed_before_it_is_replaced(self):
        text = STANDBY.replace("standby_for: main", "standby_for: {task: main, stale_after: 1 s}")
        with System(text) as system:
            for _ in range(ROUNDS):
                system.await_value("seen", 2)
                pid = system.pids()["first"]
                self.assertTrue(system.kill(pid, signal.SIGSTOP))
                time.sleep(random.random() * 0.08)
                self.assertTrue(system.kill(pid, signal.SIGCONT))
                system.await_cycles("main")  # resumed in time, it goes on
                self.assertTrue(system.kill(pid, signal.SIGSTOP))
                system.await_state("spare", "ON")
                self.assertFalse(system.kill(pid, signal.SIGCONT), "it is dead")
                counted("kills")
                system.await_value("seen", 3)
                system.await_state("main", "OFF")  # of its successor
                system.await_state("reference", "ON")
                self.assertEqual(system.call("switch", configuration="run")["end"], "done")
                time.sleep(REST)

    def test_a_standby_opens_the_device_of_a_primary_that_is_dead(self):
        with System(DEVICE_STANDBY) as system:
            for _ in range(ROUNDS):
                system.await_value("seen", 1)
                self.assertTrue(system.kill(system.pids()["first"]))
                counted("kills")
                system.await_value("seen", 2)
                await_that(lambda: system.rtpu("first")["phase"] == "serving", "its rtpu")
                self.assertEqual((system.state("hand"), system.state("drill")), ("NOT-CREATED", "ON"))
                self.assertEqual(system.call("switch", configuration="run")["end"], "done")
                time.sleep(REST)


if __name__ == "__main__":
    unittest.main()
