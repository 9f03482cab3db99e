# SPDX-License-Identifier: Apache-2.0
"""A switch of configurations over real processes: all or nothing, one receipt each."""
import unittest

from descriptions import SEEN, SETS, SWITCH, mixed, preemptive
from system import Refused, System


class Switch(unittest.TestCase):
    def await_seen(self, system, name):
        for variable, value in SEEN[name].items():
            system.await_value(variable, value)

    def test_there_and_back(self):
        for text in (SWITCH, mixed(SWITCH), preemptive(SWITCH)):
            with self.subTest(preemptive=text.count("executor: preemptive")):
                self.go_there_and_back(text)

    def go_there_and_back(self, text):
        with System(text) as system:
            numbers = []
            for target in ("quick", "gentle") * 5:
                receipt = system.call("switch", configuration=target)
                self.assertEqual((receipt["to"], receipt["end"], receipt["reason"]), (target, "done", None))
                self.assertEqual(receipt["asked_by"]["role"], "configure")
                moves = {task["task"]: task["move"] for task in receipt["tasks"]}
                self.assertEqual(sorted(moves.values()), ["arrives", "leaves", "stays", "stays", "stays"])
                self.assertEqual([v["step_of_on"] for v in receipt["variables"]], [2])
                self.assertEqual(system.on(), SETS[target])
                self.await_seen(system, target)
                numbers.append(receipt["number"])
            self.assertEqual(numbers, list(range(1, 11)))
            again = system.call("switch", configuration="gentle")
            self.assertEqual(again, {"to": "gentle", "end": "nothing-to-do"})

    def test_tasks_instead_of_a_configuration(self):
        with System(SWITCH) as system:
            receipt = system.call("switch", on=["fast"])
            self.assertEqual((receipt["from"], receipt["to"], receipt["end"]), ("gentle", "quick", "done"))
            self.assertEqual(system.on(), SETS["quick"])
            receipt = system.call("switch", off=["there"])
            self.assertEqual((receipt["from"], receipt["to"], receipt["end"]), ("quick", None, "done"))
            self.assertEqual(system.on(), SETS["quick"] - {"there"})
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
        with System(SWITCH) as system:
            system.call("switch", configuration="quick")
            receipt = system.call("switch", configuration="wild")
            self.assertEqual((receipt["end"], receipt["reason"]), ("aborted", "step-too-large"))
            self.assertIn("'wanted' too far: by 36 m/s, limit 3 m/s", receipt["why"])
            self.assertEqual(system.on(), SETS["quick"])
            self.await_seen(system, "quick")

    def test_what_is_refused_is_told_by_name(self):
        with System(SWITCH) as system:
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
        text = SWITCH.replace("constants: {k: 2}}", "constants: {k: 2}, budget: 8 ms}").replace("configurations:", """\
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
            self.assertEqual(system.on(), {"here", "late", "reference", "there"})
            self.assertFalse(system.call("status")["flag"]["up"])
            done = system.call("switch", configuration="quick")  # there is room for both
            self.assertEqual((done["end"], done["way"], done["flag_ns"]), ("done", "fast", 0))


if __name__ == "__main__":
    unittest.main()
