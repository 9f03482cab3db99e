# SPDX-License-Identifier: Apache-2.0
"""A standby takes over in real processes. Decisions, with and without a manager: tests/stepped/standby_test.cc."""
import signal
import sys
import unittest

from descriptions import DEVICE_STANDBY, STANDBY
from system import System, await_that, duration


class Standby(unittest.TestCase):
    def switch_back(self, system):
        receipt = system.call("switch", configuration="run")
        self.assertEqual((receipt["end"], receipt["reason"]), ("done", None))
        system.await_value("seen", 2)

    def test_from_a_process_that_dies(self):
        with System(STANDBY) as system:
            system.await_value("seen", 2)
            self.assertTrue(system.kill(system.pids()["first"]))
            system.await_state("spare", "ON")
            system.await_value("seen", 3)
            system.await_state("main", "OFF")  # its process is restarted, and it stays OFF
            self.assertEqual(system.call("status")["configuration"], "run with spare for main")
            self.assertIn("took over from 'main'", str(system.texts("note")))
            receipt = await_that(lambda: system.call("receipts")["receipts"], "the receipt")[0]
            self.assertEqual(receipt["asked_by"],
                             {"reaction": "standby_for", "lost": "main", "by": "death", "task": "spare"})
            self.assertEqual([receipt[key] for key in ("number", "from", "to", "end")], [1, "run", "run", "done"])
            variable, = receipt["variables"]
            self.assertEqual([variable[key] for key in ("variable", "from", "to", "step", "unit")],
                             ["wanted", "main", "spare", 1, "m/s"])
            self.assertEqual({task["task"] for task in receipt["tasks"]}, {"spare", "main"})
            duration("under the flag in a takeover", receipt["flag_ns"] / 1e9)
            print(f"cycles lost in a takeover: {sum(task['lost'] for task in receipt['tasks'])}", file=sys.stderr)
            self.switch_back(system)
            self.assertEqual(system.call("status")["configuration"], "run")

    def test_a_primary_that_is_silent_is_killed_before_it_is_replaced(self):
        with System(STANDBY.replace("standby_for: main", "standby_for: {task: main, stale_after: 1 s}")) as system:
            system.await_value("seen", 2)
            pid = system.pids()["first"]
            self.assertTrue(system.kill(pid, signal.SIGSTOP))
            system.await_state("spare", "ON")
            self.assertFalse(system.kill(pid, signal.SIGCONT), "it is dead")
            system.await_value("seen", 3)
            words = "published nothing for as long as `stale_after` of its standby says"
            await_that(lambda: [e for e in system.events() if e["text"].startswith(words) and
                                e["text"].endswith(": its rtpu is ended")], "the event")
            system.await_state("main", "OFF")  # of its successor
            system.await_state("reference", "ON")
            self.assertEqual(system.value("seen"), 3)
            self.switch_back(system)

    def test_a_standby_opens_the_device_that_the_kernel_closed(self):
        with System(DEVICE_STANDBY) as system:
            system.await_value("seen", 1)
            self.assertTrue(system.kill(system.pids()["first"]))
            system.await_value("seen", 2)
            await_that(lambda: system.rtpu("first")["phase"] == "serving", "the rtpu of the primary")
            self.assertEqual((system.state("hand"), system.state("drill")), ("NOT-CREATED", "ON"))
            self.assertNotIn("another user", str(system.events()))


if __name__ == "__main__":
    unittest.main()
