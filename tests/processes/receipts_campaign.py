# SPDX-License-Identifier: Apache-2.0
"""The manager is killed at random instants of requests: each request for a switch has one receipt in the file, with a
number and no gap. The campaign `process_receipts`."""
import random
import time
import unittest

from campaign import ROUNDS, begin, counted
from descriptions import SETS, SWITCH
from system import System, await_that


class Receipts(unittest.TestCase):
    def setUp(self):
        begin()

    def test_each_switch_has_one_receipt(self):
        answers = []
        with System(SWITCH) as system:
            for _ in range(ROUNDS):
                manager, asked = system.pids()["manager"], []
                for target in ("quick", "gentle", "wild", "quick"):
                    asked.append(system.ask("switch", configuration=target))
                    time.sleep(random.random() * 0.03)
                self.assertTrue(system.kill(manager))
                answers += [one.answer() for one in asked]
                system.disconnect()
                await_that(lambda: system.call("plan", configuration="gentle")["reason"] is None, "the end of it")
            target = "gentle" if system.on() == SETS["quick"] else "quick"
            answers.append(system.call("switch", configuration=target))
            await_that(lambda: system.call("receipts")["unfiled"] == 0, "the file")
            filed, now = sorted(system.filed(), key=lambda receipt: receipt["number"]), system.on()
        self.assertEqual([receipt["number"] for receipt in filed], list(range(1, len(filed) + 1)))
        for answer in answers:
            if isinstance(answer, dict) and answer["end"] != "nothing-to-do":
                self.assertIn(answer, filed)
        there = "gentle"  # from one done switch to the next: none is missing
        for receipt in filed:
            if receipt["end"] == "done":
                self.assertEqual(receipt["from"], there, receipt)
                there = receipt["to"]
        self.assertEqual(now, SETS[there])
        counted("receipts", len(filed))


if __name__ == "__main__":
    unittest.main()
