# SPDX-License-Identifier: Apache-2.0
"""An rtpu, the manager, or two of them are killed in the middle of switches: fast ones, slow ones, and between two
tasks with one device. Afterwards one configuration is in force, that of the answer if there is one, and the next
switch works. A part of the campaign `process_switch`."""
import random
import time
import unittest

from campaign import ROUNDS, begin, counted
from descriptions import (DEVICE_SEEN, DEVICE_SETS, DEVICE_SWITCH, SEEN, SETS, SLOW_SEEN, SLOW_SETS, SLOW_SWITCH,
                          SWITCH, mixed, preemptive)
from plan_page import PlanPage
from system import Refused, System, await_that

# A kill comes when the switch is in that phase, and later by at most that many seconds.
PHASES = (("prepared", 0), ("prepared", 0.008), ("proposed", 0), ("proposed", 0.001), ("committed", 0),
          ("committed", 0.0015), ("committed", 0.004), ("committed", 0.02))
STEPS = 4  # of a slow switch: a kill comes after that many steps
REST = 5.2  # s between two deaths of a process: three in 10 s and it is given up


class Kills:
    def __init__(self, test, system, sets, seen):
        self.test, self.system, self.sets, self.seen, self.last = test, system, sets, seen, {}

    def victims(self):
        while True:
            free = [who for who in ("first", "second", "manager") if time.monotonic() - self.last.get(who, 0) > REST]
            if free:
                break
            time.sleep(0.05)
        chosen = random.sample(free, min(len(free), random.choice((1, 1, 1, 2))))
        self.last.update({who: time.monotonic() for who in chosen})
        return chosen

    def in_force(self):
        """The configuration whose tasks are ON, if the flag is down and no switch is under way."""
        tasks, target = self.system.on(), next(iter(self.sets))
        if self.system.call("status")["flag"]["up"] or \
                self.system.call("plan", configuration=target)["reason"] == "under-way":
            return None
        return next((name for name, its in self.sets.items() if its == tasks), None)

    def other(self, name):
        return next(one for one in self.sets if one != name)

    def go(self, page, await_moment):
        """One switch with kills, and one without."""
        system, before = self.system, await_that(self.in_force, "a configuration")
        target, chosen = self.other(before), self.victims()
        pids = {who: pid for who, pid in system.pids().items() if who in chosen}
        asking = system.ask("switch", configuration=target)
        await_moment(page)
        hit = f"{page.plan()[1]}, step {page.step()}"
        for pid in pids.values():
            counted("kills", system.kill(pid))
        answer = asking.answer()
        system.disconnect()
        for who, pid in pids.items():
            await_that(lambda: system.pids().get(who) not in (None, pid), f"a new {who}")
        what = f"killed {chosen}, {hit}, in a switch from {before} to {target}: {answer}"
        found = await_that(self.in_force, lambda: f"{what}: {system.told()}")
        if chosen == ["manager"] and isinstance(answer, dict):
            self.test.assertEqual(found, {"done": target, "aborted": before}.get(answer["end"], found), what)
        self.await_seen(found)
        await_that(lambda: self.switched(self.other(found)), lambda: f"the next switch ({what}): {system.told()}")
        self.test.assertEqual(system.on(), self.sets[self.other(found)], what)
        self.await_seen(self.other(found))

    def switched(self, target):
        try:
            return self.system.call("switch", configuration=target)["end"] in ("done", "nothing-to-do")
        except Refused:
            return False

    def await_seen(self, name):
        for variable, value in self.seen[name].items():
            self.system.await_value(variable, value)


class Switches(unittest.TestCase):
    def setUp(self):
        begin()

    def go(self, text, sets, seen, await_moment):
        with System(text) as system:
            kills = Kills(self, system, sets, seen)
            self.assertTrue(kills.switched(list(sets)[1]))
            page = PlanPage(system)
            last = page.plan()[0]
            for number in range(ROUNDS):
                kills.go(page, lambda page: await_moment(page, number, last))
                last = page.plan()[0]

    def test_kills_in_each_phase_of_a_fast_switch(self):
        def phase(page, number, last):
            name, later = PHASES[number % len(PHASES)]
            page.await_phase(last, name)
            time.sleep(random.random() * later)
        self.go(random.choice((SWITCH, mixed(SWITCH), preemptive(SWITCH))), SETS, SEEN, phase)

    def step(self, page, number, last):
        page.await_step(last, number % STEPS)
        time.sleep(random.choice((0, 0.002, 0.01)))

    def test_kills_at_each_step_of_a_slow_switch(self):
        self.go(random.choice((SLOW_SWITCH, preemptive(SLOW_SWITCH))), SLOW_SETS, SLOW_SEEN, self.step)

    def test_kills_at_each_step_of_a_switch_between_tasks_with_one_device(self):
        self.go(DEVICE_SWITCH, DEVICE_SETS, DEVICE_SEEN, self.step)


if __name__ == "__main__":
    unittest.main()
