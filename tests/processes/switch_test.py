# SPDX-License-Identifier: Apache-2.0
"""Switches over real processes, by executives and by preemptive rtpus: fast, slow, and between two tasks with one
device; and their receipts in the file. What is decided about a switch: tests/stepped."""
import json
import pathlib
import signal
import unittest

import jsonschema

from descriptions import (DEVICE_SEEN, DEVICE_SETS, DEVICE_SWITCH, SEEN, SETS, SLOW_SEEN, SLOW_SETS, SLOW_SWITCH,
                          SWITCH, mixed, preemptive)
from system import System, await_that

SCHEMA = json.loads((pathlib.Path(__file__).resolve().parents[2] / "docs/formats/run.schema.json").read_text())
JUDGE = jsonschema.Draft7Validator({"$ref": "#/definitions/receipt", "definitions": SCHEMA["definitions"]})


class Switch(unittest.TestCase):
    def go_there_and_back(self, text, sets, seen, times=1):
        """Each switch is done, its receipt is in the file, and the readers see the other values."""
        before, after = sets
        with System(text) as system:
            for number, target in enumerate((after, before) * times, 1):
                receipt = system.call("switch", configuration=target)
                self.assertEqual((receipt["number"], receipt["to"], receipt["end"]), (number, target, "done"), receipt)
                self.assertEqual(system.on(), sets[target])
                for variable, value in seen[target].items():
                    system.await_value(variable, value)
                await_that(lambda: receipt in system.filed(), "the receipt in the file")
                self.assertEqual([error.message for error in JUDGE.iter_errors(receipt)], [], receipt)

    def test_there_and_back(self):
        for form in (str, mixed, preemptive):
            with self.subTest(form.__name__):
                self.go_there_and_back(form(SWITCH), SETS, SEEN, 3)

    def test_there_and_back_the_slow_way(self):
        for form in (str, preemptive):
            with self.subTest(form.__name__):
                self.go_there_and_back(form(SLOW_SWITCH), SLOW_SETS, SLOW_SEEN)

    def test_there_and_back_between_two_tasks_with_one_device(self):
        for form in (str, preemptive):
            with self.subTest(form.__name__):
                self.go_there_and_back(form(DEVICE_SWITCH), DEVICE_SETS, DEVICE_SEEN)

    def test_an_rtpu_that_is_stopped_holds_a_switch_up_until_it_is_cancelled(self):
        with System(SWITCH) as system:
            pid = system.pids()["second"]
            self.assertTrue(system.kill(pid, signal.SIGSTOP))
            first = system.ask("switch", configuration="quick")
            await_that(lambda: system.call("plan", configuration="wild")["reason"] == "under-way", "the switch")
            cancel = system.ask("cancel")
            await_that(lambda: "aborted" in str(system.call("plan", configuration="wild")["why"]), "the cancellation")
            system.kill(pid, signal.SIGCONT)  # or it was ended, since it did not run
            self.assertEqual(first.answer(), cancel.answer())
            self.assertEqual(first.answered["end"], "aborted")
            await_that(lambda: system.on() == SETS["gentle"], system.told)

    def test_receipts_that_cannot_be_filed_fail_the_run(self):
        with System(SWITCH) as system:
            for target in ("quick", "gentle"):
                self.assertEqual(system.call("switch", configuration=target)["end"], "done")
            await_that(lambda: len(system.filed()) == 2, "the file")
            system.receipt_file.unlink()
            system.receipt_file.mkdir()
            for target in ("quick", "gentle"):
                self.assertEqual(system.call("switch", configuration=target)["end"], "done")
            system.call("end")
            system.disconnect()
            self.assertEqual(system.wait(), 1)
            self.assertIn(f"FAILED: 2 receipts were not filed: {system.receipt_file}: ", system.said())

    def test_receipts_are_read_when_nothing_runs_and_numbers_begin_anew_in_each_run(self):
        with System(SWITCH) as system:
            system.call("switch", configuration="quick")
            self.assertIn("quick  done ", system.chimera("receipts").stdout)
            system.call("end")
            system.disconnect()
            self.assertEqual(system.wait(), 0)
            self.assertIn("quick  done ", system.chimera("receipts").stdout)
            self.assertEqual(json.loads(system.chimera("receipts", "subject", "--json").stdout)["receipts"],
                             system.filed())
            system.start(("--priority", "0"), {})
            system.await_started()
            system.call("switch", configuration="quick")
            first, second = system.filed()
            self.assertEqual((first["number"], second["number"]), (1, 1))
            self.assertNotEqual(first["origin_ns"], second["origin_ns"])
            told = system.call("receipts")
            self.assertEqual((told["receipts"], told["file"]), ([first, second], str(system.receipt_file)))


if __name__ == "__main__":
    unittest.main()
