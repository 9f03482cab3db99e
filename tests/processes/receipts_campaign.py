# SPDX-License-Identifier: Apache-2.0
"""The manager is killed at random instants of requests: each request for a switch has one receipt in the file, with a
number and no gap; a task that asks is heard by the next manager. The campaign `process_receipts`."""
import random
import threading
import time
import unittest

import requests_test
from campaign import ROUNDS, begin, counted
from descriptions import SETS, SWITCH
from system import Refused, System, await_that


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

    def test_a_request_of_a_task_waits_for_the_next_manager(self):
        sets = requests_test.SETS
        with System(requests_test.TEXT) as system:
            present = "low"
            for _ in range(ROUNDS):
                target = "high" if present == "low" else "low"
                pid, delay = system.pids()["manager"], random.random() * 0.03
                killer = threading.Thread(target=lambda: (time.sleep(delay), system.kill(pid)))
                killer.start()
                wish = {"low": 1, "high": 2}[target]
                try:
                    system.client.call("set", values={"wish": wish})
                except (Refused, OSError):  # killed before it read the request
                    system.disconnect()
                killer.join()
                await_that(lambda: system.pids()["manager"] != pid, "another manager")
                system.call("set", values={"wish": wish})
                await_that(lambda: system.on() == sets[target], lambda: f"{target}: {system.told()}")
                present = target
                time.sleep(4)  # three deaths in 10 s and the manager is given up


if __name__ == "__main__":
    unittest.main()
