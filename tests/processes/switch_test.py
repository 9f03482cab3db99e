# SPDX-License-Identifier: Apache-2.0
"""A switch of configurations over real processes: all or nothing, one receipt each, whoever dies meanwhile. A bounded
count here; more of them are the campaign `process_switch`. CHIMERA_ROUNDS: switches beside kills."""
import os
import random
import sys
import threading
import time
import unittest

from plan_page import PlanPage
from system import Client, Refused, System, UNITS, await_that

ROUNDS = int(os.environ.get("CHIMERA_ROUNDS", "2"))
SEED = int(os.environ.get("CHIMERA_SEED", str(random.SystemRandom().randrange(1 << 32))))

# One variable, `wanted`, by a task of the first unit or by one of the second; read in both.
TEXT = UNITS + """
tasks:
  reference:
    {component: signal_generator, rtpu: first, rate: 100 Hz, alias: {y: vref},
     constants: {amplitude: 0 m/s, offset: 1 m/s}}
  slow: {component: gain, rtpu: first, rate: 100 Hz, alias: {x: vref, y: wanted}, constants: {k: 2}}
  fast:
    {component: gain, rtpu: second, rate: 100 Hz, alias: {x: vref, y: wanted}, constants: {k: 4},
     max_step: {y: 3 m/s}}
  steep:
    {component: gain, rtpu: second, rate: 100 Hz, alias: {x: vref, y: wanted}, constants: {k: 40},
     max_step: {y: 3 m/s}}
  here: {component: gain, rtpu: first, rate: 50 Hz, alias: {x: wanted, y: seen_here}, constants: {k: 1}}
  there: {component: gain, rtpu: second, rate: 50 Hz, alias: {x: wanted, y: seen_there}, constants: {k: 1}}
configurations:
  gentle: [reference, slow, here, there]
  quick: [reference, fast, here, there]
  wild: [reference, steep, here, there]
start: gentle
"""
SETS = {"gentle": {"reference", "slow", "here", "there"}, "quick": {"reference", "fast", "here", "there"}}
VALUE = {"gentle": 2, "quick": 4}


# The same with a thread for each task of the second unit, or of both.
MIXED = TEXT.replace("second: {cpu: 1, policy: edf}", "second: {cpu: 1, policy: edf, executor: preemptive}")
PREEMPTIVE = MIXED.replace("first: {cpu: 0, policy: edf}", "first: {cpu: 0, policy: edf, executor: preemptive}")


class Switch(unittest.TestCase):
    def on(self, system):
        return {task["task"] for task in system.call("status")["tasks"] if task["state"] == "ON"}

    def await_values(self, system, value):
        def both():
            values = system.call("get", variables=["seen_here", "seen_there"])["values"]
            return [values[name]["value"] for name in ("seen_here", "seen_there")] == [value, value]
        await_that(both, 5, f"both readers to see {value}")

    def test_there_and_back(self):
        for text in (TEXT, MIXED, PREEMPTIVE):
            with self.subTest(preemptive=text.count("executor: preemptive")):
                self.go_there_and_back(text)

    def go_there_and_back(self, text):
        with System(text) as system:
            numbers, ways = [], []
            for target in ("quick", "gentle") * 5:
                receipt = system.call("switch", configuration=target)
                self.assertEqual((receipt["to"], receipt["end"], receipt["reason"]), (target, "done", None))
                self.assertEqual(receipt["asked_by"]["role"], "configure")
                moves = {task["task"]: task["move"] for task in receipt["tasks"]}
                self.assertEqual(sorted(moves.values()), ["arrives", "leaves", "stays", "stays", "stays"])
                self.assertEqual([v["step_of_on"] for v in receipt["variables"]], [2])
                self.assertEqual(self.on(system), SETS[target])
                self.await_values(system, VALUE[target])
                numbers.append(receipt["number"])
                ways.append(receipt["way"])
                self.assertIn(receipt["slow_because"], ([], ["no-gap"]), "of an `on` that the machine held up")
            self.assertIn("fast", ways)
            self.assertEqual(numbers, list(range(1, 11)))
            again = system.call("switch", configuration="gentle")
            self.assertEqual(again, {"to": "gentle", "end": "nothing-to-do"})
            flags = [event for event in system.events() if event["kind"] == "flag" and "up" in event["text"]]
            started = system.call("status")["started_ns"]
            if "slow" not in ways:
                self.assertEqual([event for event in flags if event["at_ns"] > started], [])

    def test_tasks_instead_of_a_configuration(self):
        with System(TEXT) as system:
            receipt = system.call("switch", on=["fast"])
            self.assertEqual((receipt["from"], receipt["to"], receipt["end"]), ("gentle", "quick", "done"))
            self.assertEqual(self.on(system), SETS["quick"])
            receipt = system.call("switch", off=["there"])
            self.assertEqual((receipt["from"], receipt["to"], receipt["end"]), ("quick", None, "done"))
            self.assertEqual(self.on(system), SETS["quick"] - {"there"})
            self.assertEqual(system.call("switch", off=["there"]), {"to": None, "end": "nothing-to-do"})
            for parameters, why in (({"off": ["fast"]}, "wanted would have no producer, and there is a choice: 'slow' "
                                                        "or 'steep'"),
                                    ({"off": ["reference"]}, "vref would have no producer"),
                                    ({"on": ["slow", "steep"]}, "wanted would have two producers: slow and steep")):
                with self.assertRaises(Refused) as refused:
                    system.call("switch", **parameters)
                self.assertEqual((refused.exception.data["kind"], str(refused.exception)), ("set", why))
            receipt = system.call("switch", on=["slow", "there"])
            self.assertEqual((receipt["from"], receipt["to"], receipt["end"]), (None, "gentle", "done"))

    def test_what_would_step_too_far_changes_nothing(self):
        with System(TEXT) as system:
            system.call("switch", configuration="quick")
            receipt = system.call("switch", configuration="wild")
            self.assertEqual((receipt["end"], receipt["reason"]), ("aborted", "step-too-large"))
            self.assertIn("'wanted' too far: by 36 m/s, limit 3 m/s", receipt["why"])
            self.assertEqual(self.on(system), SETS["quick"])
            self.await_values(system, 4)

    def test_what_is_refused_is_told_by_name(self):
        with System(TEXT) as system:
            with self.assertRaises(Refused) as unknown:
                system.call("switch", configuration="quic")
            self.assertEqual(unknown.exception.data["nearest"], "quick")
            system.signal("kill", "fast")
            with self.assertRaises(Refused) as missing:
                system.call("switch", configuration="quick")
            self.assertEqual(missing.exception.data["kind"], "not-created")
            self.assertEqual(missing.exception.data["where"], "fast")
            self.assertEqual(missing.exception.data["remedy"], "`chimera spawn fast`")
            system.signal("spawn", "fast")
            self.assertEqual(system.call("switch", configuration="quick")["end"], "done")

    def test_what_might_miss_a_deadline_goes_the_slow_way(self):
        text = TEXT.replace("constants: {k: 2}}", "constants: {k: 2}, budget: 8 ms}").replace("configurations:", """\
  late:
    {component: gain, rtpu: first, rate: 100 Hz, offset: 9 ms, budget: 8 ms, alias: {x: vref, y: wanted},
     constants: {k: 2}}
configurations:
  after: [reference, late, here, there]""")
        with System(text) as system:
            foreseen = system.call("plan", configuration="after")
            self.assertEqual((foreseen["way"], foreseen["slow_because"]), ("slow", ["not-schedulable"]))
            self.assertGreater(foreseen["expected_ns"], 0)
            done = system.call("switch", configuration="after")
            self.assertEqual((done["end"], done["way"]), ("done", "slow"), done)
            self.assertIn("the transition from 'gentle' to 'after' is not schedulable on CPU", done["slow_why"])
            self.assertGreater(done["flag_ns"], 0)
            self.assertEqual(self.on(system), {"here", "late", "reference", "there"})
            self.assertFalse(system.call("status")["flag"]["up"])
            done = system.call("switch", configuration="quick")  # there is room for both
            self.assertEqual((done["end"], done["way"], done["flag_ns"]), ("done", "fast", 0))

    def test_whoever_dies_the_next_switch_works(self):
        """A real-time unit, the manager, or two of them are killed at each phase of a switch."""
        random.seed(SEED)
        print(f"seed {SEED}", file=sys.stderr)
        rounds = Rounds(self)
        with System(random.choice((TEXT, MIXED, PREEMPTIVE))) as system:
            await_that(lambda: system.call("switch", configuration="quick")["end"] == "done", 10, "a switch")
            page = PlanPage(system)
            for number in range(ROUNDS):
                rounds.go(system, page, PHASES[(number + SEED) % len(PHASES)])
        print(", ".join(f"{n} {phase}" for phase, n in rounds.hit.items()), file=sys.stderr)
        print(f"kills: {rounds.kills}", file=sys.stderr)


# When somebody is killed: in that phase, as much later as at most so many seconds.
PHASES = (("prepared", 0), ("prepared", 0.008), ("proposed", 0), ("proposed", 0.001), ("committed", 0),
          ("committed", 0.0015), ("committed", 0.004), ("committed", 0.02))


class Rounds:
    """Kills in the middle of switches. Who has died is let live a while: three deaths in 10 s and it is given up."""

    def __init__(self, test):
        self.test, self.kills, self.hit, self.last = test, 0, {}, {}

    def victims(self):
        while True:
            free = [who for who in ("first", "second", "manager") if time.monotonic() - self.last.get(who, 0) > 5.2]
            if free:
                break
            time.sleep(0.05)
        chosen = random.sample(free, min(len(free), random.choice((1, 1, 1, 2))))
        self.last.update({who: time.monotonic() for who in chosen})
        return chosen

    def go(self, system, page, phase):
        test = self.test
        before = next(name for name, tasks in SETS.items() if tasks == test.on(system))
        target = "quick" if before == "gentle" else "gentle"
        chosen = self.victims()
        pids = {who: pid for who, pid in system.pids().items() if who in chosen}
        last, told = page.plan()[0], []

        def ask():
            try:
                client = Client(system.socket, 30)
                told.append(client.call("switch", configuration=target))
                client.close()
            except (Refused, OSError, ConnectionError) as error:
                told.append(error)

        asking = threading.Thread(target=ask)
        later = random.random() * phase[1]
        asking.start()
        page.await_phase(last, phase[0])
        if later:
            time.sleep(later)
        hit = page.plan()[1] + (" and later" if later > 0.0015 else "")
        for pid in pids.values():
            test.assertTrue(system.kill(pid))
        self.kills += len(pids)
        self.hit[hit] = self.hit.get(hit, 0) + 1
        asking.join(30)
        test.assertFalse(asking.is_alive())
        for who, pid in pids.items():
            await_that(lambda who=who, pid=pid: system.pids().get(who) not in (None, pid), 20, f"a new {who}")
        self.judge(system, f"killed {chosen}, {hit}, in a switch from {before} to {target}, {told}",
                   None if "manager" not in chosen or len(chosen) > 1 else
                   {"done": target, "aborted": before}.get(told[0]["end"] if isinstance(told[0], dict) else None))

    def judge(self, system, what, expected):
        """One of the configurations is in force, that of the answer if there was one, and the next switch works."""
        test, found = self.test, []

        def is_settled():
            tasks = test.on(system)
            found[:] = [name for name, its in SETS.items() if its == tasks]
            return found != []
        await_that(is_settled, 20, f"a configuration ({what})")
        if expected is not None:
            test.assertEqual(found[0], expected, what)
        other = "quick" if found[0] == "gentle" else "gentle"

        def works():
            try:
                return system.call("switch", configuration=other)["end"] in ("done", "nothing-to-do")
            except Refused:
                return False
        await_that(works, 20, f"the next switch ({what})")
        test.assertEqual(test.on(system), SETS[other], what)
        test.await_values(system, VALUE[other])


if __name__ == "__main__":
    unittest.main()
