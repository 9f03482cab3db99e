# SPDX-License-Identifier: Apache-2.0
"""The counting frame on made-up results: nothing that went wrong may pass for passed."""
import contextlib
import csv
import functools
import io
import json
import os
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

import common
import fuzz
import results
import stress
import test as frame
from results import FAILED, PASSED, SKIPPED, Case

GTEST = """<testsuites><testsuite name="S">
<testcase name="Passes" classname="S" status="run" result="completed"/>
{more}</testsuite></testsuites>"""
FAILURE = '<testcase name="Fails" classname="S" status="run" result="completed"><failure message="x != y"/></testcase>'
SKIP = ('<testcase name="Skips" classname="S" status="run" result="skipped">'
        '<skipped message="a.cc:7&#x0A;not judged: host stalled"/></testcase>')


def ctest(status, inner=""):
    return f'<testsuite><testcase name="t" status="{status}">{inner}</testcase></testsuite>'


def read(junit, gtest=None):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "ctest.xml").write_text(junit)
        if gtest is not None:
            (folder / "t.xml").write_text(gtest)
        return [(case.name, case.outcome, case.said) for case in results.read(folder / "ctest.xml", folder)]


class Results(unittest.TestCase):
    def test_cases_of_a_gtest_program_are_counted_each(self):
        found = read(ctest("fail"), GTEST.format(more=FAILURE + SKIP))
        self.assertEqual(found, [("S.Passes", PASSED, ""), ("S.Fails", FAILED, "x != y"),
                                 ("S.Skips", SKIPPED, "not judged: host stalled")])

    def test_a_program_that_died_after_its_report_failed(self):
        found = read(ctest("fail", '<failure message="SEGFAULT"/><system-out>leak</system-out>'), GTEST.format(more=""))
        self.assertEqual(found[1], ("t", FAILED, "t: SEGFAULT\nleak"))

    def test_a_program_that_died_without_a_report_failed(self):
        self.assertEqual(read(ctest("fail", '<failure message="Timeout"/>')), [("t", FAILED, "t: Timeout\n")])

    def test_a_program_without_tests_failed(self):
        self.assertEqual(read(ctest("run"), "<testsuites/>"), [("t", FAILED, "t ran no test")])

    def test_an_unreadable_report_failed(self):
        self.assertEqual(read(ctest("run"), "<testsui")[0][1], FAILED)

    def test_a_program_that_was_not_found_failed(self):
        self.assertEqual(read(ctest("notrun", '<skipped message="Unable to find executable"/>'))[0][1], FAILED)

    def test_a_script_that_skips_gives_its_last_line_as_reason(self):
        found = read(ctest("notrun", '<skipped message="SKIP_RETURN_CODE=77"/><system-out>a\nno rights\n</system-out>'))
        self.assertEqual(found, [("t", SKIPPED, "no rights")])


def finish(cases, ci="true", allowed=""):
    """(exit code, last line) of the frame."""
    said = io.StringIO()
    with mock.patch.object(frame, "allowed_skips", allowed.split), mock.patch.dict(os.environ, {"CI": ci}), \
            contextlib.redirect_stdout(said):
        code = frame.finish(cases)
    return code, said.getvalue().splitlines()[-1]


class Finish(unittest.TestCase):
    def test_all_passed(self):
        self.assertEqual(finish([Case("a", PASSED)]), (0, "1 passed, 0 failed, 0 skipped"))

    def test_one_failed(self):
        self.assertEqual(finish([Case("a", PASSED), Case("b", FAILED)]), (1, "1 passed, 1 failed, 0 skipped"))

    def test_nothing_ran(self):
        self.assertEqual(finish([]), (1, "0 passed, 0 failed, 0 skipped"))

    def test_an_unforeseen_skip_is_red_on_the_build_machine(self):
        self.assertEqual(finish([Case("a", PASSED), Case("S.b", SKIPPED)]), (1, "1 passed, 1 failed, 0 skipped"))

    def test_a_listed_skip_is_not(self):
        cases = [Case("a", PASSED), Case("S.b", SKIPPED)]
        self.assertEqual(finish(cases, allowed="S.*"), (0, "1 passed, 0 failed, 1 skipped"))

    def test_people_may_skip(self):
        cases = [Case("a", PASSED), Case("S.b", SKIPPED)]
        self.assertEqual(finish(cases, ci=""), (0, "1 passed, 0 failed, 1 skipped"))

    def test_a_flaky_case_is_printed_and_counted_and_not_red(self):
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            code = frame.finish([Case("a", PASSED, flaky="x != y"), Case("b", PASSED)])
        self.assertEqual(code, 0)
        self.assertEqual(said.getvalue(), "flaky: a\n    x != y\n2 passed, 0 failed, 0 skipped, 1 flaky\n")

    def test_a_duration_is_printed_and_recorded(self):
        said = io.StringIO()
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(said):
            record = pathlib.Path(folder) / "durations.jsonl"
            with mock.patch.object(frame, "DURATIONS", record):
                frame.timed("units", 3601, 7)
            entry = json.loads(record.read_text())
        self.assertEqual(said.getvalue(), "   units      60:01  7 tests\n")
        self.assertEqual((entry["part"], entry["seconds"]), ("units", 3601))


class Again(unittest.TestCase):
    """Tests that touch real scheduling run again; the others never."""

    def again(self, *tries, labels="process"):
        """Result of these tries of the program p, each a list of cases, and the number of its runs."""
        for cases in tries:
            for case in cases:
                case.program = "p"
        left = list(tries[1:])
        with mock.patch.object(frame, "tests_of", lambda _: [("p", [labels])]), \
                mock.patch.object(frame, "ctest", lambda *_: left.pop(0)), contextlib.redirect_stdout(io.StringIO()):
            cases = frame.ctest_again("debug", labels, tries[0])
        return sorted((case.name, case.outcome, case.flaky) for case in cases), len(tries) - len(left)

    def test_a_test_that_passes_later_is_flaky_with_its_first_words(self):
        found = self.again([Case("a", PASSED), Case("b", FAILED, "late")], [Case("a", PASSED), Case("b", PASSED)])
        self.assertEqual(found, ([("a", PASSED, ""), ("b", PASSED, "late")], 2))

    def test_a_third_try_is_the_last(self):
        fails = lambda: [Case("b", FAILED, "wrong")]
        self.assertEqual(self.again(fails(), fails(), fails(), fails()), ([("b", FAILED, "")], 3))
        self.assertEqual(self.again(fails(), fails(), [Case("b", PASSED)])[0], [("b", PASSED, "wrong")])

    def test_a_program_that_died_once_is_flaky(self):
        found = self.again([Case("a", PASSED), Case("p", FAILED, "SEGFAULT")], [Case("a", PASSED)])
        self.assertEqual(found[0], [("a", PASSED, ""), ("p", PASSED, "SEGFAULT")])

    def test_a_case_that_is_not_reached_again_stays_failed(self):
        found = self.again([Case("b", FAILED, "wrong")], [Case("p", FAILED, "died")], [Case("p", FAILED, "died")])
        self.assertEqual([(name, outcome) for name, outcome, _ in found[0]], [("b", FAILED), ("p", FAILED)])

    def test_a_unit_test_does_not_run_again(self):
        self.assertEqual(self.again([Case("b", FAILED, "wrong")], [Case("b", PASSED)], labels="unit"),
                         ([("b", FAILED, "")], 1))


class Shares(unittest.TestCase):
    def test_a_share_without_tests_failed(self):
        with mock.patch.object(frame, "ctest", lambda *_, **__: []):
            self.assertEqual([case.outcome for case in frame.run_share(frame.SHARES[0], ["debug"])], [FAILED])

    def unlabelled(self, tree, label):
        listing = {"tests": [{"name": "t", "properties": [{"name": "LABELS", "value": [label]}]}]}
        with mock.patch.object(frame.subprocess, "run", lambda *_, **__: mock.Mock(stdout=json.dumps(listing))):
            return [case.outcome for case in frame.unlabelled(tree)]

    def test_a_label_that_no_share_runs_in_that_tree_failed(self):
        self.assertEqual(self.unlabelled("debug", "unit"), [])
        self.assertEqual(self.unlabelled("release", "unit"), [FAILED])
        self.assertEqual(self.unlabelled("release", "symbol"), [])

    def test_quick_names_the_parts_that_it_leaves_out(self):
        said = frame.left_out()
        self.assertIn("process (debug)", said)
        self.assertNotIn("unit (debug)", said)

    def test_the_text_for_contributors_names_the_shares(self):
        said = (common.ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
        self.assertIn("one share: " + ", ".join(share.name for share in frame.SHARES) + "\n", said)


class Fuzz(unittest.TestCase):
    STATS = "#9 cov: 12 ft: 3\nstat::number_of_executed_units: 900\n"
    CRASH = STATS + "SUMMARY: libFuzzer: deadly signal"

    def campaign(self, plain, planted):
        """(exit code, last line) when every target ends so: (exit code, output)."""
        said = io.StringIO()
        with mock.patch.object(fuzz, "fuzz", lambda program, *_: planted if "planted" in program.name else plain), \
                mock.patch.object(sys, "argv", ["fuzz.py", "--seconds", "0"]), contextlib.redirect_stdout(said):
            return fuzz.main(), json.loads(said.getvalue().splitlines()[-1])

    def test_counts_the_executions_without_planted_defects(self):
        targets = len(fuzz.sources())
        self.assertEqual(self.campaign((0, self.STATS), (77, self.CRASH)),
                         (0, {"name": "fuzz", "n": 900 * targets, "faults": 0}))

    def test_a_crash_is_a_fault(self):
        code, report = self.campaign((77, self.CRASH), (77, self.CRASH))
        self.assertEqual((code, report["faults"]), (1, len(fuzz.sources())))

    def test_a_run_without_executions_is_a_fault(self):
        self.assertTrue(fuzz.judge(0, ""))

    def test_a_planted_defect_that_is_not_found_is_a_fault(self):
        self.assertEqual(self.campaign((0, self.STATS), (0, self.STATS))[0], 1)
        self.assertTrue(fuzz.judge_planted(1, "cannot open the corpus"))

    def test_every_target_has_a_corpus(self):
        self.assertTrue(fuzz.sources())
        self.assertEqual([source.name for source in fuzz.sources() if not any(fuzz.corpus_of(source).iterdir())], [])


class Stress(unittest.TestCase):
    def test_a_target_without_a_tree_is_in_the_release_tree(self):
        found = {campaign.name: campaign for campaign in stress.campaigns()}
        self.assertEqual((found["labels"].tree, found["labels"].target), ("release", "labels_stress"))
        self.assertEqual((found["fuzz"].tree, found["fuzz"].target), ("fuzz", "fuzz_targets"))
        self.assertIn(str(common.BUILD / "fuzz"), found["fuzz"].command)

    def test_a_campaign_adds_a_line_to_its_file(self):
        command = ["sh", "-c", 'echo \'{"n": 9, "faults": 0}\'']
        with tempfile.TemporaryDirectory() as folder:
            write = functools.partial(common.record, folder=pathlib.Path(folder))
            with mock.patch.object(common, "record", write), contextlib.redirect_stdout(io.StringIO()):
                self.assertEqual(stress.run(stress.Campaign("c", "release", "t", command), 1), 0)
            [line] = csv.reader((pathlib.Path(folder) / "campaigns.csv").read_text().splitlines())
        with open(common.RESULTS / "campaigns.csv", encoding="utf-8") as committed:
            found = dict(zip(next(csv.reader(committed)), line, strict=True))
        self.assertEqual((found["campaign"], found["n"], found["faults"]), ("c", "9", "0"))

    def test_the_page_has_a_row_for_every_campaign(self):
        page = (common.ROOT / "docs" / "reliability.md").read_text(encoding="utf-8")
        self.assertEqual([c.name for c in stress.campaigns() if f"| `{c.name}` |" not in page], [])

    def test_minutes_and_names_come_in_any_order(self):
        self.assertEqual(stress.parse(["kill", "5", "stop"]), (5.0, ["kill", "stop"]))
        self.assertEqual(stress.parse(["kill"]), (10.0, ["kill"]))

    def test_the_last_json_line_is_the_report(self):
        self.assertEqual(stress.last_json('{"n": 1}\ntext\n{"n": 2}\n'), {"n": 2})
        with self.assertRaises(ValueError):
            stress.last_json("died")


if __name__ == "__main__":
    unittest.main()
