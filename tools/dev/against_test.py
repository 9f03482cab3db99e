# SPDX-License-Identifier: Apache-2.0
"""Comparing two commits: what is refused leaves nothing behind, and the numbers are those of the pairs."""
import contextlib
import csv
import functools
import io
import json
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest
from unittest import mock

import against
import bench
import common
import rows


def figure(row, what, value, **more):
    return {"row": row, "what": what, "figure": value, "unit": "ns", "ratio": None, "goal": "", "met": None, **more}


@contextlib.contextmanager
def checkout(rows_there=("row_07_a.cc",)):
    """A git checkout of one commit with these rows. Says nothing."""
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()), \
            contextlib.redirect_stderr(io.StringIO()):
        root = pathlib.Path(folder)
        (root / "bench").mkdir()
        for name in rows_there:
            (root / "bench" / name).write_text("// Needs: tool\n")
        git = ["git", "-C", folder, "-c", "user.name=a", "-c", "user.email=a@b"]
        for arguments in (["init", "--quiet"], ["add", "."], ["commit", "--quiet", "--message", "first"]):
            subprocess.run(git + arguments, check=True)
        yield root


class OtherCommit(unittest.TestCase):
    def refused(self, act):
        with self.assertRaises(against.Refused) as caught:
            act()
        return str(caught.exception), caught.exception.code

    def test_a_commit_that_does_not_exist_is_refused_with_the_remedy(self):
        with checkout() as root:
            said, code = self.refused(lambda: against.Other("nonsense", root))
            self.assertIn("no such commit here; `git log --oneline` lists them", said)
            self.assertEqual(code, 2)
            self.refused(lambda: against.Other("--all", root))
            self.assertFalse((root / "build").exists())

    def test_a_folder_without_git_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertIn("no git checkout", self.refused(lambda: against.Other("HEAD", pathlib.Path(folder)))[0])

    def test_a_row_that_it_does_not_have_is_refused_before_anything_is_unpacked(self):
        with checkout() as root:
            other = against.Other("HEAD", root)
            known = {7: ["a"], 9: ["b"]}
            said, code = self.refused(lambda: against.rows_of_both(other, [7, 9], known))
            self.assertIn("has no row 9; it has: 7. `./dev bench 9` measures it here alone.", said)
            self.assertEqual(code, 2)
            self.assertEqual(against.rows_of_both(other, [7], known), [7])
            self.assertEqual(against.rows_of_both(other, [], known), [7])
            self.refused(lambda: against.rows_of_both(other, [], {9: ["b"]}))
            self.assertFalse((root / "build").exists())

    def test_it_is_unpacked_once_and_git_does_not_know_of_it(self):
        with checkout() as root:
            other = against.Other("HEAD", root)
            other.unpack()
            self.assertEqual([path.name for path in (root / "build" / "against").iterdir()], [other.name])
            self.assertTrue((other.root / "bench" / "row_07_a.cc").exists())
            (other.root / "mark").touch()
            other.unpack()
            self.assertTrue((other.root / "mark").exists())
            trees = subprocess.run(["git", "-C", str(root), "worktree", "list"], capture_output=True, text=True).stdout
            self.assertEqual(len(trees.splitlines()), 1)

    def test_a_tree_that_does_not_build_is_removed_and_its_log_stays(self):
        with checkout() as root:
            other = against.Other("HEAD", root)
            other.unpack()
            self.assertIn("does not build on this machine", self.refused(lambda: other.build(["row_07_a"]))[0])
            self.assertEqual([path.name for path in (root / "build" / "against").iterdir()], [f"{other.name}.log"])

    def test_a_disk_without_room_is_a_sentence(self):
        arguments = types.SimpleNamespace(against="HEAD", rows=[7])
        with mock.patch.object(against, "prepare", side_effect=OSError(28, "No space left on device")):
            self.assertIn("No space left", self.refused(lambda: against.result(arguments, {}))[0])

    def test_programs_that_differ_are_named(self):
        with checkout() as here, checkout(("row_07_a.cc", "row_07_b.py", "row_08_c.cc")) as there:
            for root, text in ((here, "same"), (there, "other")):
                (root / "bench" / "row_07_a.cc").write_text('#include "bench/used.h"\n')
                (root / "bench" / "used.h").write_text('#include "bench/deep.h"\n')
                (root / "bench" / "deep.h").write_text(text)
                (root / "bench" / "unused.h").write_text(text)
            self.assertEqual(against.differing(here, there, [7]), ["deep.h", "row_07_b.py"])


class Rows(unittest.TestCase):
    def test_the_program_and_its_needs_are_built(self):
        with checkout(("row_07_a.cc", "row_07_b.py", "row_07_c_peer.cc")) as root:
            paths = rows.programs(rows.sources(root), [7])
            self.assertEqual([path.name for path in paths], ["row_07_a.cc", "row_07_b.py"])
            self.assertEqual(rows.targets(paths), ["row_07_a", "tool"])

    def test_every_need_of_this_checkout_is_found(self):
        paths = rows.programs(rows.sources(), [18])
        self.assertIn("component_gain_files", rows.targets(paths))


class Pairs(unittest.TestCase):
    def measure(self, pairs, run):
        here, there = pathlib.Path("here"), pathlib.Path("there")
        known = {7: [pathlib.Path("seven")], 9: [pathlib.Path("nine")]}
        with mock.patch.object(rows, "sources", lambda root: known), contextlib.redirect_stdout(io.StringIO()):
            return against.measure(here, there, [7, 9], pairs, run)

    def test_the_side_that_begins_alternates(self):
        ran = []

        def run(path, root):
            ran.append((path.name, root.name))
            return [figure(7, "a", 1.0)]

        self.measure(2, run)
        self.assertEqual(ran, [("seven", "here"), ("seven", "there"), ("nine", "here"), ("nine", "there"),
                               ("seven", "there"), ("seven", "here"), ("nine", "there"), ("nine", "here")])

    def test_a_row_that_fails_ends_it(self):
        with self.assertRaisesRegex(against.Refused, "seven of there failed in pair 1"):
            self.measure(2, lambda path, root: [figure(7, "a", 1.0)] if root.name == "here" else None)

    def test_ratios_are_taken_inside_the_pairs(self):
        pairs = [(10.0, 5.0), (40.0, 10.0), (6.0, 6.0), (30.0, 10.0), (1.0, 2.0)]
        measured = [(against.keyed([figure(7, "a", a, goal="ratio <= 2", met=a < 20)]),
                     against.keyed([figure(7, "a", b)])) for a, b in pairs]
        both, only_here, only_there = against.compare(measured)
        self.assertEqual((only_here, only_there), ([], []))
        found = both[0]
        self.assertEqual((found["here"], found["there"]), (10.0, 6.0))
        self.assertEqual((found["lower_quartile"], found["ratio"], found["upper_quartile"]), (1.0, 2.0, 3.0))
        self.assertEqual((found["pairs_above_1"], found["pairs"], found["pairs_met"]), (3, 5, 3))

    def test_figures_of_one_side_are_named_and_not_compared(self):
        measured = [(against.keyed([figure(7, "a", 1.0), figure(7, "new", 1.0)]),
                     against.keyed([figure(7, "old", 1.0), figure(7, "a", 1.0)]))]
        both, only_here, only_there = against.compare(measured)
        self.assertEqual([found["what"] for found in both], ["a"])
        self.assertEqual((only_here, only_there), ([(7, "new", 0)], [(7, "old", 0)]))

    def test_two_figures_of_one_name_are_matched_in_their_order(self):
        keys = against.keyed([figure(7, "a", 1.0), figure(7, "a", 2.0)])
        self.assertEqual(sorted(keys), [(7, "a", 0), (7, "a", 1)])

    def test_a_figure_without_a_ratio_is_shown_without_one(self):
        both = against.compare([(against.keyed([figure(7, "a", -1.0)]), against.keyed([figure(7, "a", None)]))])[0]
        self.assertIsNone(both[0]["ratio"])
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            against.table(both, "abc")
        self.assertIn("-1 ns", said.getvalue())


class Lines(unittest.TestCase):
    def said(self, *arguments):
        """(exit code, what was printed) of ./dev bench when the comparison found one figure."""
        both, here, there = against.compare([(against.keyed([figure(7, "a", 3.0), figure(7, "new", 1.0)]),
                                              against.keyed([figure(7, "a", 2.0)]))])
        found = {"against": "abc", "pairs": 1, "figures": both, "only_here": [key[:2] for key in here],
                 "only_there": [key[:2] for key in there], "differing_sources": ["row_07_a.cc"]}
        out = io.StringIO()
        with mock.patch.object(against, "result", lambda *_: found), contextlib.redirect_stdout(out), \
                mock.patch.object(sys, "argv", ["bench.py", "7", "--against", "abc", *arguments]):
            return bench.main(), out.getvalue()

    def test_json_is_one_object(self):
        code, said = self.said("--json")
        found = json.loads(said)
        self.assertEqual((code, found["figures"][0]["ratio"], found["only_here"]), (0, 1.5, [[7, "new"]]))
        self.assertIn("commit", found["machine"])

    def test_the_table_names_missing_figures(self):
        said = self.said()[1]
        self.assertIn("7    a     3 ns  2 ns  1.500  1.500 to 1.500  1 of 1", said)
        self.assertIn("only here: row 7, new\n", said)
        self.assertIn("are not the same in both: bench/row_07_a.cc\n", said)

    def test_record_adds_a_line_for_each_figure_of_both(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "pairs.csv"
            write = functools.partial(common.record, folder=pathlib.Path(folder))
            with mock.patch.object(common, "record", write):
                self.said()
                self.assertFalse(file.exists())
                self.said("--record")
            [line] = csv.reader(file.read_text().splitlines())
            with open(common.RESULTS / "pairs.csv", encoding="utf-8") as committed:
                columns = next(csv.reader(committed))
        found = dict(zip(columns, line, strict=True))
        self.assertEqual([found[key] for key in columns[1:2] + columns[3:]],
                         ["abc", "7", "a", "ns", "2", "3", "1.5", "1.5", "1.5", "1", ""])
        self.assertEqual(columns[5:9], ["unit", "before", "after", "ratio"])

    def test_a_refusal_is_one_sentence_and_its_code(self):
        said = io.StringIO()
        with mock.patch.object(against, "result", side_effect=against.Refused("no such commit", 2)), \
                mock.patch.object(sys, "argv", ["bench.py", "7", "--against", "abc"]), contextlib.redirect_stderr(said):
            self.assertEqual(bench.main(), 2)
        self.assertEqual(said.getvalue(), "./dev: no such commit\n")

    def test_the_command_line_is_judged_before_anything_is_built(self):
        for arguments in (["7", "--pairs", "0", "--against", "HEAD"], ["7", "--pairs", "3"], ["7", "--record"],
                          ["7", "--peers", "--against", "HEAD"], ["99", "--against", "HEAD"]):
            done = subprocess.run(["/usr/bin/python3", str(common.ROOT / "tools" / "dev" / "bench.py"), *arguments],
                                  capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout), (2, ""), arguments)


if __name__ == "__main__":
    unittest.main()
