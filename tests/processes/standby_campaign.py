# SPDX-License-Identifier: Apache-2.0
"""One or two processes are killed, the second at any moment of the takeover from the first: one of primary and standby
is ON. The campaign `process_standby`."""
import random
import time
import unittest

from campaign import ROUNDS, begin, counted
from descriptions import STANDBY
from system import System, await_that

REST = 5.2  # s between two deaths of a process: three in 10 s and it is given up


class Standby(unittest.TestCase):
    def setUp(self):
        begin()

    def states(self, system):
        return {task["task"]: task["state"] for task in system.call("status")["tasks"]}

    def test_primary_or_standby_is_on_after_kills(self):
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


if __name__ == "__main__":
    unittest.main()
