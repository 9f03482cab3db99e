# SPDX-License-Identifier: Apache-2.0
"""Two tasks of two units open one device that takes one user: they take turns with it, in a switch and as primary and
standby, whoever dies. CHIMERA_ROUNDS: switches and takeovers beside kills."""
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
  hand: {component: t_lock, rtpu: first, rate: 100 Hz, resources: {device: device.lock}, constants: {value: 1}}
  drill:
    {component: t_lock, rtpu: second, rate: 100 Hz, resources: {device: device.lock}, constants: {value: 2, late: 3}}
  user: {component: gain, rtpu: second, rate: 100 Hz, alias: {x: y, y: seen}, constants: {k: 1}}
"""
SWITCH = TEXT + "configurations: {with_hand: [hand, user], with_drill: [drill, user]}\nstart: with_hand\n"
STANDBY = TEXT.replace("late: 3}", "late: 3}, standby_for: hand") + "configurations: {run: [hand, user]}\n"
SEEN = {"with_hand": 1, "with_drill": 2}
STEPS = 4  # off, kill, spawn, on
STATES = {"with_hand": ["ON", "NOT-CREATED"], "with_drill": ["NOT-CREATED", "ON"]}


class Resource(unittest.TestCase):
    def states(self, system):
        return [system.state(name) for name in ("hand", "drill")]

    def await_states(self, system, states):
        await_that(lambda: self.states(system) == states, 15, f"{states}, there is {self.states(system)}")

    def await_seen(self, system, value):
        await_that(lambda: system.call("get", variables=["seen"])["values"]["seen"]["value"] == value, 10,
                   f"the reader to see {value}")

    def no_second_user(self, system):
        self.assertNotIn("another user", str([event["text"] for event in system.events()]))

    def test_a_switch_closes_it_before_it_is_opened(self):
        for text in (SWITCH, SWITCH.replace("policy: edf}", "policy: edf, executor: preemptive}")):
            with System(text) as system:
                self.await_states(system, ["ON", "NOT-CREATED"])
                foreseen = system.call("plan", configuration="with_drill")
                self.assertEqual((foreseen["end"], foreseen["way"], foreseen["slow_because"], foreseen["slow_why"]),
                                 ("possible", "slow", ["resource"],
                                  "task 'drill' is NOT-CREATED: task 'hand' has its resource"))
                for target in ("with_drill", "with_hand", "with_drill"):
                    receipt = system.call("switch", configuration=target)
                    self.assertEqual((receipt["end"], receipt["slow_because"]), ("done", ["resource"]), receipt)
                    self.assertGreater(receipt["flag_ns"], 0)
                    self.assertEqual(self.states(system), STATES[target])
                    self.await_seen(system, SEEN[target])
                self.no_second_user(system)
                with self.assertRaises(Refused) as refused:
                    system.signal("spawn", "hand")
                self.assertIn("hand has the resource 'device.lock' of drill, which is ON", str(refused.exception))
                self.assertIn("chimera switch with_hand", str(refused.exception))

    def test_the_start_waits_for_a_device(self):
        with System(SWITCH.replace("constants: {value: 1}", "constants: {value: 1, late: 20}")) as system:
            self.await_states(system, ["ON", "NOT-CREATED"])

    def test_a_standby_opens_it_when_the_primary_is_dead(self):
        with System(STANDBY) as system:
            self.await_states(system, ["ON", "NOT-CREATED"])
            self.await_seen(system, 1)
            self.assertTrue(system.kill(system.pids()["first"]))
            self.await_states(system, ["NOT-CREATED", "ON"])
            self.await_seen(system, 2)
            time.sleep(0.3)  # the unit of the primary is back by now
            self.assertEqual(self.states(system), ["NOT-CREATED", "ON"])
            self.assertEqual(system.call("switch", configuration="run")["end"], "done")
            self.await_seen(system, 1)
            self.no_second_user(system)

    def test_a_standby_opens_it_when_the_primary_is_in_error(self):
        with System(STANDBY.replace("constants: {value: 1}", "constants: {value: 1, fails_at: 30}")) as system:
            self.await_states(system, ["NOT-CREATED", "ON"])
            self.await_seen(system, 2)
            self.no_second_user(system)

    def settled(self, system):
        """The configuration in force, when no switch is under way and the reader sees its value; else None."""
        states = {task["task"]: task["state"] for task in system.call("status")["tasks"]}
        seen = system.call("get", variables=["seen"])["values"]["seen"]["value"]
        if system.call("plan", configuration="with_hand")["reason"] == "under-way" or states["user"] != "ON":
            return None
        return next((name for name, its in STATES.items()
                     if its == [states["hand"], states["drill"]] and seen == SEEN[name]), None)

    def test_whoever_dies_one_of_them_has_it(self):
        random.seed(SEED)
        print(f"seed {SEED}", file=sys.stderr)
        with System(SWITCH) as system:
            now = "with_hand"
            self.await_states(system, STATES[now])
            now = "with_drill"
            self.assertEqual(system.call("switch", configuration=now)["end"], "done")
            page = PlanPage(system)
            for number in range(ROUNDS):
                target = "with_drill" if now == "with_hand" else "with_hand"
                who = random.choice(["first", "second", "manager"])
                hit = system.kill_in_a_switch(who, target, page, (number + SEED) % STEPS, random.choice((0, 0.01)))
                print(f"kills: 1 ({who}, {hit})", file=sys.stderr)
                now = await_that(lambda: self.settled(system), 20, f"one of them, {who} killed in a switch to {target}")
                if ROUNDS > 1:
                    time.sleep(4)  # three deaths in 10 s and a unit is given up
            self.no_second_user(system)


if __name__ == "__main__":
    unittest.main()
