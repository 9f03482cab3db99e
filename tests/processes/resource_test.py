# SPDX-License-Identifier: Apache-2.0
"""Two tasks of two rtpus open one device that accepts one user: they take turns with it, in a switch and as primary and
standby."""
import unittest

from descriptions import DEVICE_SEEN, DEVICE_SETS, DEVICE_STANDBY, DEVICE_SWITCH, preemptive
from system import Refused, System, await_that


class Resource(unittest.TestCase):
    def states(self, system):
        return [system.state(name) for name in ("hand", "drill")]

    def await_states(self, system, states):
        await_that(lambda: self.states(system) == states, lambda: f"{states}: {system.told()}")

    def no_second_user(self, system):
        self.assertNotIn("another user", str(system.events()))

    def test_a_switch_closes_it_before_it_is_opened(self):
        for text in (DEVICE_SWITCH, preemptive(DEVICE_SWITCH)):
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
                    self.assertEqual(system.on(), DEVICE_SETS[target])
                    system.await_value("seen", DEVICE_SEEN[target]["seen"])
                self.no_second_user(system)
                with self.assertRaises(Refused) as refused:
                    system.signal("spawn", "hand")
                self.assertIn("hand has the resource 'device.lock' of drill, which is ON", str(refused.exception))
                self.assertIn("chimera switch with_hand", str(refused.exception))

    def test_the_start_waits_for_a_device(self):
        with System(DEVICE_SWITCH.replace("constants: {value: 1}", "constants: {value: 1, late: 20}")) as system:
            self.await_states(system, ["ON", "NOT-CREATED"])

    def test_a_standby_opens_it_when_the_primary_is_dead(self):
        with System(DEVICE_STANDBY) as system:
            self.await_states(system, ["ON", "NOT-CREATED"])
            system.await_value("seen", 1)
            self.assertTrue(system.kill(system.pids()["first"]))
            self.await_states(system, ["NOT-CREATED", "ON"])
            system.await_value("seen", 2)
            await_that(lambda: system.rtpu("first")["phase"] == "serving", "the rtpu of the primary")
            self.assertEqual(self.states(system), ["NOT-CREATED", "ON"])
            self.assertEqual(system.call("switch", configuration="run")["end"], "done")
            system.await_value("seen", 1)
            self.no_second_user(system)

    def test_a_standby_opens_it_when_the_primary_is_in_error(self):
        with System(DEVICE_STANDBY.replace("constants: {value: 1}", "constants: {value: 1, fails_at: 30}")) as system:
            self.await_states(system, ["NOT-CREATED", "ON"])
            system.await_value("seen", 2)
            self.no_second_user(system)


if __name__ == "__main__":
    unittest.main()
