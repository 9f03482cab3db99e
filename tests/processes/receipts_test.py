# SPDX-License-Identifier: Apache-2.0
"""Each request for a switch leaves one receipt in the file, with a number and no gap."""
import json
import os
import pathlib
import pwd
import signal
import unittest

import jsonschema

from descriptions import SETS, SWITCH
from system import Refused, System, await_that

SCHEMA = json.loads((pathlib.Path(__file__).resolve().parents[2] / "docs/formats/run.schema.json").read_text())
JUDGE = jsonschema.Draft7Validator({"$ref": "#/definitions/receipt", "definitions": SCHEMA["definitions"]})
ME = pwd.getpwuid(os.getuid()).pw_name


class Receipts(unittest.TestCase):
    maxDiff = None

    def judged(self, system):
        """The receipts in the file, each of which is within the schema."""
        for receipt in system.filed():
            self.assertEqual([error.message for error in JUDGE.iter_errors(receipt)], [], receipt)
        return system.filed()

    def test_done_aborted_and_refused_are_filed_alike(self):
        with System(SWITCH) as system:
            answers = [system.call("switch", configuration=name) for name in ("quick", "wild", "gentle")]
            system.signal("kill", "fast")
            with self.assertRaises(Refused):
                system.call("switch", configuration="quick")
            self.assertEqual(system.call("switch", configuration="gentle")["end"], "nothing-to-do")
            filed = self.judged(system)
            self.assertEqual(filed[:3], answers, "who is answered finds it in the file")
            self.assertEqual([receipt["number"] for receipt in filed], [1, 2, 3, 4])
            self.assertEqual([receipt["end"] for receipt in filed], ["done", "aborted", "done", "refused"])
            self.assertEqual([receipt["from"] for receipt in filed], ["gentle", "quick", "quick", "gentle"])
            self.assertEqual(filed[3]["why"], "task 'fast' is not there: spawn it first")
            for receipt in filed:
                self.assertEqual(receipt["asked_by"], {"role": "configure", "user": ME})
            self.assertEqual([v["unit"] for v in filed[0]["variables"]], ["m/s"])
            self.assertGreater(filed[0]["took_ns"]["arming"], 0)
            told = system.call("receipts")
            self.assertEqual((told["receipts"], told["unfiled"], told["fault"]), (filed, 0, None))
            self.assertEqual(told["file"], str(system.receipt_file))
            self.assertEqual(system.call("receipts", last=2)["receipts"], filed[2:])

    def test_they_are_read_when_nothing_runs_and_numbers_begin_anew_in_each_run(self):
        with System(SWITCH) as system:
            system.call("switch", configuration="quick")
            self.assertIn("quick  done ", system.chimera("receipts").stdout)
            system.call("end")
            system.disconnect()
            self.assertEqual(system.wait(), 0)
            self.assertIn("quick  done ", system.chimera("receipts").stdout)
            self.assertEqual(json.loads(system.chimera("receipts", "subject", "--json").stdout)["receipts"], self.judged(system))
            system.start(("--priority", "0"), {})
            system.await_started()
            system.call("switch", configuration="quick")
            first, second = self.judged(system)
            self.assertEqual((first["number"], second["number"]), (1, 1))
            self.assertNotEqual(first["origin_ns"], second["origin_ns"])
            self.assertEqual(system.call("receipts")["receipts"], [first, second])

    def test_a_second_one_is_refused_by_name_and_the_first_can_be_cancelled(self):
        with System(SWITCH) as system:
            with self.assertRaises(Refused) as nothing:
                system.call("cancel")
            self.assertEqual(nothing.exception.data["kind"], "no-switch")
            self.assertTrue(system.kill(system.pids()["second"], signal.SIGSTOP))
            first = system.ask("switch", configuration="quick")
            await_that(lambda: system.call("plan", configuration="wild")["reason"] == "under-way", "the first one")
            with self.assertRaises(Refused) as second:
                system.call("switch", configuration="wild")
            self.assertRegex(str(second.exception), "switch to 'wild' is refused: switch 1 to 'quick', asked for by "
                             rf"configure:{ME}, is under way: arming, until \d\d:\d\d:\d\d$")
            cancel = system.ask("cancel")
            await_that(lambda: "aborted" in system.call("plan", configuration="wild")["why"], "the cancellation")
            system.kill(system.rtpu("second")["pid"], signal.SIGCONT)
            self.assertEqual(first.answer(), cancel.answer())
            self.assertEqual(first.answered["why"], f"cancelled by configure:{ME}")
            self.assertEqual(system.on(), SETS["gentle"])
            self.assertEqual(sorted(receipt["number"] for receipt in self.judged(system)), [1, 2])
            self.assertEqual(system.call("switch", configuration="quick")["end"], "done")

    def test_a_dry_run_says_what_would_be_done_and_changes_nothing(self):
        with System(SWITCH) as system:
            plan = system.call("plan", configuration="quick")
            self.assertEqual(plan, {
                "from": "gentle", "to": "quick", "end": "possible", "reason": None, "why": None, "remedy": None,
                "way": "fast", "slow_because": [], "slow_why": None, "expected_ns": plan["expected_ns"],
                "arrives": ["fast"], "leaves": ["slow"], "stays": plan["stays"],
                "variables": [{"variable": "wanted", "from": "slow", "to": "fast"}]})
            self.assertEqual(set(plan["stays"]), {"reference", "here", "there"})
            self.assertEqual(system.call("plan", configuration="gentle")["end"], "nothing-to-do")
            system.signal("kill", "fast")
            refused = system.call("plan", configuration="quick")
            self.assertEqual((refused["end"], refused["reason"], refused["remedy"]),
                             ("refused", "not-created", "`chimera spawn fast`"))
            self.assertEqual(system.on(), SETS["gentle"])
            self.assertEqual(self.judged(system), [])

    def test_a_file_that_takes_nothing_is_told_and_stops_nobody(self):
        with System(SWITCH) as system:
            system.receipt_file.mkdir(parents=True)
            for target in ("quick", "gentle"):
                self.assertEqual(system.call("switch", configuration=target)["end"], "done")
            told = system.call("receipts")
            self.assertEqual((len(told["receipts"]), told["unfiled"]), (2, 2))
            self.assertEqual(told["fault"], f"{system.receipt_file}: cannot be opened: Is a directory")
            self.assertEqual(system.texts("note"), [f"receipts are not filed: {told['fault']}; they are kept and tried again"])
            self.assertTrue(system.kill(system.pids()["manager"]))  # what is not filed is handed on
            await_that(lambda: system.call("receipts")["unfiled"] == 2, "the successor")
            system.receipt_file.rmdir()
            system.call("switch", configuration="quick")
            await_that(lambda: system.call("receipts")["unfiled"] == 0, "the file")
            self.assertEqual([receipt["number"] for receipt in self.judged(system)], [1, 2, 3])


if __name__ == "__main__":
    unittest.main()
