# SPDX-License-Identifier: Apache-2.0
"""A slow switch over real processes: two tasks of two units make the same constants, a third uses them and stays.
CHIMERA_ROUNDS: switches beside kills."""
import os
import random
import sys
import time
import unittest

from plan_page import PlanPage
from system import Refused, System, UNITS, await_that

ROUNDS = int(os.environ.get("CHIMERA_ROUNDS", "1"))
SEED = int(os.environ.get("CHIMERA_SEED", str(random.SystemRandom().randrange(1 << 32))))

TEXT = UNITS + """
tasks:
  light: {component: t_constants, rtpu: first, rate: 100 Hz, constants: {joints: 2, scale: 0.5 m}}
  heavy: {component: t_constants, rtpu: second, rate: 100 Hz, constants: {joints: 3, scale: 2 m}}
  user: {component: t_extent, rtpu: second, rate: 100 Hz}
  beside: {component: t_counter, rtpu: first, rate: 200 Hz}
operator: {q: 1 rad}
configurations:
  with_light: [light, user, beside]
  with_heavy: [heavy, user, beside]
start: with_light
"""
PREEMPTIVE = TEXT.replace("policy: edf}", "policy: edf, executor: preemptive}")
SETS = {"with_light": {"light", "user", "beside"}, "with_heavy": {"heavy", "user", "beside"}}
STEPS = 4  # check and reinit of the user, off of the one and on of the other
ARC = {"with_light": [0.5, 1], "with_heavy": [2, 4, 6]}


class SlowSwitch(unittest.TestCase):
    def on(self, system):
        return {task["task"] for task in system.call("status")["tasks"] if task["state"] == "ON"}

    def await_arc(self, system, name):
        def is_there():
            return system.call("get", variables=["arc"])["values"]["arc"]["value"] == ARC[name]
        await_that(is_there, 10, f"{ARC[name]}, there is {system.call('get', variables=['arc'])}")

    def test_constants_change_under_a_task_that_stays(self):
        for text in (TEXT, PREEMPTIVE):
            self.there_and_back(text)

    def there_and_back(self, text):
        with System(text) as system:
            self.await_arc(system, "with_light")
            foreseen = system.call("plan", configuration="with_heavy")
            self.assertEqual((foreseen["end"], foreseen["way"], foreseen["slow_because"]),
                             ("possible", "slow", ["constants"]))
            self.assertIn("of task 'user', which stays, changes", foreseen["slow_why"])
            for target in ("with_heavy", "with_light"):
                receipt = system.call("switch", configuration=target)
                self.assertEqual((receipt["end"], receipt["way"], receipt["reinitialised"], receipt["not_back"]),
                                 ("done", "slow", ["user"], None), receipt)
                self.assertGreater(receipt["flag_ns"], 0)
                self.assertEqual(self.on(system), SETS[target])
                self.assertFalse(system.call("status")["flag"]["up"])
                self.await_arc(system, target)

    def test_whoever_dies_it_ends_on_one_side(self):
        """A real-time unit or the manager is killed at each step of a slow switch."""
        random.seed(SEED)
        print(f"seed {SEED}", file=sys.stderr)
        with System(random.choice((TEXT, PREEMPTIVE))) as system:
            now = "with_heavy"
            self.assertEqual(system.call("switch", configuration=now)["end"], "done")
            page = PlanPage(system)
            for number in range(ROUNDS):
                target = "with_heavy" if now == "with_light" else "with_light"
                who = random.choice(["first", "second", "manager"])
                hit = system.kill_in_a_switch(who, target, page, (number + SEED) % STEPS, random.choice((0, 0.002)))
                print(f"kills: 1 ({who}, {hit})", file=sys.stderr)
                found = []

                def is_settled(found=found):
                    tasks = self.on(system)
                    found[:] = [name for name, its in SETS.items() if its == tasks]
                    return found != [] and not system.call("status")["flag"]["up"]
                await_that(is_settled, 20, f"a configuration (killed {who} in a switch to {target}); {self.on(system)}")
                now = found[0]
                self.await_arc(system, now)
                other = "with_heavy" if now == "with_light" else "with_light"

                def works(other=other):
                    try:
                        return system.call("switch", configuration=other)["end"] in ("done", "nothing-to-do")
                    except Refused:
                        return False
                await_that(works, 10, "the next switch")
                self.assertEqual(self.on(system), SETS[other])
                self.await_arc(system, other)
                now = other
                if ROUNDS > 1:
                    time.sleep(4)  # three deaths in 10 s and a unit is given up


if __name__ == "__main__":
    unittest.main()
