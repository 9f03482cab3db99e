# SPDX-License-Identifier: Apache-2.0
"""Each request for a switch leaves one receipt in the file, with a number and no gap, whoever is killed; the switches
that happened are the ones of the receipts. CHIMERA_ROUNDS: kills of the manager."""
import json
import os
import pathlib
import pwd
import random
import signal
import subprocess
import sys
import threading
import time
import unittest

import jsonschema

from switch_test import SETS, TEXT
from system import CHIMERA, Client, Refused, System, await_that

ROUNDS = int(os.environ.get("CHIMERA_ROUNDS", "4"))
SEED = int(os.environ.get("CHIMERA_SEED", str(random.SystemRandom().randrange(1 << 32))))
SCHEMA = json.loads((pathlib.Path(__file__).resolve().parents[2] / "docs/formats/run.schema.json").read_text())
JUDGE = jsonschema.Draft7Validator({"$ref": "#/definitions/receipt", "definitions": SCHEMA["definitions"]})
ME = pwd.getpwuid(os.getuid()).pw_name


class Asking(threading.Thread):
    """One request on a connection of its own; `told` is its answer, or what was raised."""

    def __init__(self, system, method, **parameters):
        super().__init__()
        self.system, self.request, self.told = system, (method, parameters), None
        self.start()

    def run(self):
        try:
            client = Client(self.system.socket, 30)
            self.told = client.call(self.request[0], **self.request[1])
            client.close()
        except (Refused, OSError, ConnectionError) as error:
            self.told = error

    def answer(self):
        self.join(30)
        return self.told


class Receipts(unittest.TestCase):
    maxDiff = None

    def file(self, system):
        return system.state_home / "chimera/subject/receipts.jsonl"

    def filed(self, system):
        path = self.file(system)
        lines = path.read_text().splitlines() if path.is_file() else []
        receipts = [json.loads(line) for line in lines]
        for receipt in receipts:
            self.assertEqual([error.message for error in JUDGE.iter_errors(receipt)], [], receipt)
        return receipts

    def on(self, system):
        return {task["task"] for task in system.call("status")["tasks"] if task["state"] == "ON"}

    def stop(self, system, unit):
        self.assertTrue(system.kill(system.pids()[unit], signal.SIGSTOP))

    def go_on(self, system, unit):
        self.assertTrue(system.kill(system.pids()[unit], signal.SIGCONT))

    def test_done_aborted_and_refused_are_filed_alike(self):
        with System(TEXT) as system:
            answers = [system.call("switch", configuration=name) for name in ("quick", "wild", "gentle")]
            system.signal("kill", "fast")
            with self.assertRaises(Refused):
                system.call("switch", configuration="quick")
            self.assertEqual(system.call("switch", configuration="gentle")["end"], "nothing-to-do")
            filed = self.filed(system)
            self.assertEqual(filed[:3], answers, "who is answered finds it in the file")
            self.assertEqual([receipt["number"] for receipt in filed], [1, 2, 3, 4])
            self.assertEqual([receipt["end"] for receipt in filed], ["done", "aborted", "done", "refused"])
            self.assertEqual([receipt["from"] for receipt in filed], ["gentle", "quick", "quick", "gentle"])
            self.assertEqual(filed[3]["why"], "task 'fast' is not there: spawn it first")
            for receipt in filed:
                self.assertEqual(receipt["asked_by"], {"role": "configure", "user": ME})
                self.assertLess(abs(receipt["wall_ns"] / 1e9 - time.time()), 60)
            self.assertEqual([v["unit"] for v in filed[0]["variables"]], ["m/s"])
            self.assertGreater(filed[0]["took_ns"]["arming"], 0)
            told = system.call("receipts")
            self.assertEqual((told["receipts"], told["unfiled"], told["fault"]), (filed, 0, None))
            self.assertEqual(told["file"], str(self.file(system)))
            self.assertEqual(system.call("receipts", last=2)["receipts"], filed[2:])

    def test_they_are_read_when_nothing_runs_and_numbers_begin_anew_in_each_run(self):
        with System(TEXT) as system:
            def chimera(*words):
                done = subprocess.run([CHIMERA, *words], env=system.environment, cwd=system.place, text=True,
                                      capture_output=True, timeout=30)
                self.assertEqual(done.returncode, 0, done.stderr)
                return done.stdout

            system.call("switch", configuration="quick")
            self.assertIn("quick  done ", chimera("receipts"))
            system.call("end")
            system.disconnect()
            self.assertEqual(system.process.wait(15), 0)
            self.assertIn("quick  done ", chimera("receipts"))
            self.assertEqual(json.loads(chimera("receipts", "subject", "--json"))["receipts"], self.filed(system))
            system.process = subprocess.Popen([str(CHIMERA), "run", str(system.file), "--priority", "0"],
                                              env=system.environment, cwd=system.place, stdin=subprocess.DEVNULL,
                                              stdout=system.output, stderr=system.output)
            system.await_started()
            system.call("switch", configuration="quick")
            first, second = self.filed(system)
            self.assertEqual((first["number"], second["number"]), (1, 1))
            self.assertNotEqual(first["origin_ns"], second["origin_ns"])
            self.assertEqual(system.call("receipts")["receipts"], [first, second])

    def test_a_second_one_is_refused_by_name_and_the_first_can_be_cancelled(self):
        with System(TEXT) as system:
            with self.assertRaises(Refused) as nothing:
                system.call("cancel")
            self.assertEqual(nothing.exception.data["kind"], "no-switch")
            self.stop(system, "second")
            first = Asking(system, "switch", configuration="quick")
            await_that(lambda: system.call("plan", configuration="wild")["reason"] == "under-way", 5, "the first one")
            with self.assertRaises(Refused) as second:
                system.call("switch", configuration="wild")
            self.assertRegex(str(second.exception), "switch to 'wild' is refused: switch 1 to 'quick', asked for by "
                             rf"configure:{ME}, is under way: arming, until \d\d:\d\d:\d\d$")
            cancel = Asking(system, "cancel")
            await_that(lambda: "aborted" in system.call("plan", configuration="wild")["why"], 5, "the cancellation")
            self.go_on(system, "second")
            self.assertEqual(first.answer(), cancel.answer())
            self.assertEqual(first.told["why"], f"cancelled by configure:{ME}")
            self.assertEqual(self.on(system), SETS["gentle"])
            self.assertEqual(sorted(receipt["number"] for receipt in self.filed(system)), [1, 2])
            self.assertEqual(system.call("switch", configuration="quick")["end"], "done")

    def test_a_dry_run_says_what_would_be_done_and_changes_nothing(self):
        with System(TEXT) as system:
            plan = system.call("plan", configuration="quick")
            self.assertEqual(plan, {
                "from": "gentle", "to": "quick", "end": "possible", "reason": None, "why": None, "remedy": None,
                "way": "fast", "slow_because": [], "slow_why": None, "expected_ns": plan["expected_ns"],
                "late_off": None, "arrives": ["fast"], "leaves": ["slow"], "stays": plan["stays"],
                "variables": [{"variable": "wanted", "from": "slow", "to": "fast"}]})
            self.assertEqual(set(plan["stays"]), {"reference", "here", "there"})
            self.assertEqual(system.call("plan", configuration="gentle")["end"], "nothing-to-do")
            system.signal("kill", "fast")
            refused = system.call("plan", configuration="quick")
            self.assertEqual((refused["end"], refused["reason"], refused["remedy"]),
                             ("refused", "not-created", "`chimera spawn fast`"))
            self.assertEqual(self.on(system), SETS["gentle"])
            self.assertEqual(self.filed(system), [])

    def test_a_file_that_takes_nothing_is_told_and_stops_nobody(self):
        with System(TEXT) as system:
            self.file(system).mkdir(parents=True)
            for target in ("quick", "gentle"):
                self.assertEqual(system.call("switch", configuration=target)["end"], "done")
            told = system.call("receipts")
            self.assertEqual((len(told["receipts"]), told["unfiled"]), (2, 2))
            self.assertEqual(told["fault"], f"{self.file(system)}: cannot be opened: Is a directory")
            notes = [event["text"] for event in system.events() if event["kind"] == "note"]
            self.assertEqual(notes, [f"receipts are not filed: {told['fault']}; they are kept and tried again"])
            self.assertTrue(system.kill(system.pids()["manager"]))  # what is not filed is handed on
            await_that(lambda: system.call("receipts")["unfiled"] == 2, 10, "the successor")
            self.file(system).rmdir()
            system.call("switch", configuration="quick")
            await_that(lambda: system.call("receipts")["unfiled"] == 0, 10, "the file")
            self.assertEqual([receipt["number"] for receipt in self.filed(system)], [1, 2, 3])

    def test_whenever_the_manager_is_killed_each_switch_has_one_receipt(self):
        random.seed(SEED)
        print(f"seed {SEED}", file=sys.stderr)
        answers = []
        with System(TEXT) as system:
            for _ in range(ROUNDS):
                manager = system.pids()["manager"]
                asked = []
                for target in ("quick", "gentle", "wild", "quick"):
                    asked.append(Asking(system, "switch", configuration=target))
                    time.sleep(random.random() * 0.03)
                self.assertTrue(system.kill(manager))
                answers += [one.answer() for one in asked]

                def has_ended():
                    return system.call("plan", configuration="gentle")["reason"] is None
                await_that(has_ended, 20, "the end of the switch")
            target = "gentle" if self.on(system) == SETS["quick"] else "quick"
            answers.append(system.call("switch", configuration=target))
            await_that(lambda: system.call("receipts")["unfiled"] == 0, 10, "the file")
            filed = self.filed(system)
            now = self.on(system)
        numbers = sorted(receipt["number"] for receipt in filed)
        self.assertEqual(numbers, list(range(1, len(filed) + 1)))
        for answer in answers:
            if isinstance(answer, dict) and answer["end"] != "nothing-to-do":
                self.assertIn(answer, filed)
        there = "gentle"  # from one done switch to the next: none is missing
        for receipt in sorted(filed, key=lambda receipt: receipt["number"]):
            if receipt["end"] == "done":
                self.assertEqual(receipt["from"], there, receipt)
                there = receipt["to"]
        self.assertEqual(now, SETS[there])
        print(f"receipts: {len(filed)}", file=sys.stderr)


if __name__ == "__main__":
    unittest.main()
