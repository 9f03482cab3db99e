# SPDX-License-Identifier: Apache-2.0
"""A slow switch over real processes: two tasks of two rtpus make the same constants, a third uses them and stays."""
import unittest

from descriptions import SLOW_SEEN, SLOW_SETS, SLOW_SWITCH, preemptive
from system import System


class SlowSwitch(unittest.TestCase):
    def test_constants_change_under_a_task_that_stays(self):
        for text in (SLOW_SWITCH, preemptive(SLOW_SWITCH)):
            self.there_and_back(text)

    def there_and_back(self, text):
        with System(text) as system:
            system.await_value("arc", SLOW_SEEN["with_light"]["arc"])
            foreseen = system.call("plan", configuration="with_heavy")
            self.assertEqual((foreseen["end"], foreseen["way"], foreseen["slow_because"]),
                             ("possible", "slow", ["constants"]))
            self.assertIn("of task 'user', which stays, changes", foreseen["slow_why"])
            for target in ("with_heavy", "with_light"):
                receipt = system.call("switch", configuration=target)
                self.assertEqual((receipt["end"], receipt["way"], receipt["reinitialised"], receipt["not_back"]),
                                 ("done", "slow", ["user"], None), receipt)
                self.assertGreater(receipt["flag_ns"], 0)
                self.assertEqual(system.on(), SLOW_SETS[target])
                self.assertFalse(system.call("status")["flag"]["up"])
                system.await_value("arc", SLOW_SEEN[target]["arc"])


if __name__ == "__main__":
    unittest.main()
