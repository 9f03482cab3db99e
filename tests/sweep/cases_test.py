# SPDX-License-Identifier: Apache-2.0
"""`chimera test DIR`: its files, its verdicts, its report for a build machine, and its refusals."""
import json
import unittest
import xml.etree.ElementTree

from place import Place

GOOD = """description: small.yaml
cases:
  doubles: {for: 50 ms, expect: [y >= 2 N.m, 'max |y| <= 2 N.m'], strict: true}
  follows:
    for: 50 ms
    set: {k: 3 N.m/rad}
    at: ['25 ms: set x 2 rad']
    expect: ['settling y >= 6 N.m within 40 ms', 'min y >= 3 N.m']
    seed: 7
    preemptive: true
"""

BAD = """cases:
  too_much: {for: 50 ms, expect: ['y <= 1 N.m', 'y <= 3 N.m']}
  dies: {for: 50 ms, set: {crash.how: kill}, strict: true}
  flagged: {for: 50 ms, at: ['20 ms: flag up'], strict: true}
  misspelt: {for: 50 ms, expect: [yy <= 3]}
"""


class Cases(Place):
    def test_a_folder_with_all_below_it(self):
        self.write("deep/down/any.cases.yaml", GOOD.replace("small.yaml", "../../small.yaml"))
        self.write("built/CMakeCache.txt", "")
        self.write("built/x.cases.yaml", "broken")
        self.write(".hidden/x.cases.yaml", "broken")
        for words in ((".",), ("deep", "deep/down"), ("deep/down/any.cases.yaml",), (".", "--jobs", "1")):
            with self.subTest(words):
                prefix = "./" if words[0] == "." else ""
                self.assertEqual(self.chimera("test", *words),
                                 (0, f"{prefix}deep/down/any.cases.yaml\n  ok     doubles\n  ok     follows\n"
                                     "2 cases in 1 file: 2 passed, 0 failed\n", ""))

    def test_names_the_expectation_that_fails(self):
        self.write("small.cases.yaml", BAD)
        code, out, err = self.chimera("test", ".", "--junit", "report.xml")
        self.assertEqual((code, err), (1, ""))
        self.assertEqual(out, "./small.cases.yaml\n"
                              "  FAILS  too_much\n           y <= 1 N.m (y is 2 N.m)\n"
                              "  FAILS  dies\n           ended by signal 9 (SIGKILL) in crash.cycle\n"
                              "  FAILS  flagged\n           strict: the illegal-configuration flag is up\n"
                              "  FAILS  misspelt\n           'yy <= 3': no state variable 'yy'; did you mean 'y'?\n"
                              "4 cases in 1 file: 0 passed, 4 failed\n")
        self.judge_junit(xml.etree.ElementTree.parse(self.path / "report.xml").getroot())
        code, out, _ = self.chimera("test", ".", "--case", "too_much", "--json")
        told = json.loads(out)
        self.assertEqual((code, told["passed"], told["failed"], len(told["files"][0]["cases"])), (1, 0, 1, 1))
        self.assertEqual([e["holds"] for e in told["files"][0]["cases"][0]["expectations"]], [False, True])

    def judge_junit(self, root):
        """Jenkins (junit-plugin) and GitLab read these names: suites and cases with counts, times, and reasons."""
        self.assertEqual(root.tag, "testsuites")
        suite = root.find("testsuite")
        self.assertEqual({k: suite.get(k) for k in ("name", "tests", "failures", "errors", "skipped")},
                         {"name": "small", "tests": "4", "failures": "2", "errors": "2", "skipped": "0"})
        cases = suite.findall("testcase")
        self.assertEqual([case.get("name") for case in cases], ["too_much", "dies", "flagged", "misspelt"])
        for case in cases:
            self.assertEqual((case.get("classname"), case.get("file")), ("small", "./small.cases.yaml"))
            self.assertGreaterEqual(float(case.get("time")), 0)
        failure, error = cases[0].find("failure"), cases[1].find("error")
        self.assertEqual(failure.get("message"), "y <= 1 N.m (y is 2 N.m)")
        self.assertEqual(failure.text, "y <= 1 N.m (y is 2 N.m)\n")
        self.assertEqual(error.get("message"), "ended by signal 9 (SIGKILL) in crash.cycle")
        self.assertIn("holds: y <= 3 N.m (y is 2 N.m)\n", cases[0].find("system-out").text)

    def test_a_case_runs_in_the_folder_of_its_description(self):
        self.write("a/small.yaml", (self.path / "small.yaml").read_text().replace("armed: /", "armed: here"))
        self.write("a/here", "")
        self.write("a/small.cases.yaml", "cases:\n  dies: {for: 50 ms, set: {crash.how: kill}, strict: true}\n")
        self.assertIn("ended by signal 9", self.chimera("test", "a")[1])
        (self.path / "a/here").unlink()
        self.assertEqual(self.chimera("test", "a")[0], 0)

    def test_refuses_a_file_that_is_no_test(self):
        none = ("error: there are no tests: no file NAME.cases.yaml here or below; docs/formats/cases.md says what one "
                "says\n")
        self.assertEqual(self.chimera("test", "."), (1, "", ".: " + none))
        self.write("gain/x", "")
        self.assertEqual(self.chimera("test", "gain/"), (1, "", "gain/: " + none))
        self.assertRegex(self.chimera("test", "gain")[1], "^gain: passes", "a bare word is the component")
        self.write("small.cases.yaml", "cases:\n  a: {fro: 5 s, expect: [y <= 3]}\n  b: {for: 5 s}\n  c: {for: 0 s, "
                                       "strict: maybe}\n")
        code, out, err = self.chimera("test", ".")
        self.assertEqual((code, out), (1, ""))
        for said in (":2:7: error: case 'a' has no key 'fro'", "did you mean 'for'?",
                     ":2:3: error: case 'a': the key 'for' is missing", ":3:3: error: case 'b': the key 'expect' is",
                     ":4:12: error: 'for' of case 'c' must be longer than 0", ":4:25: error: 'strict' of case 'c'"):
            self.assertIn(said, err)
        self.write("small.cases.yaml", GOOD)
        for words, code, said in (
                ((".", "--case", "double"), 1, "error: --case: no case 'double'; did you mean 'doubles'?\n"),
                ((".", "--junit", "/nowhere/r.xml"), 1,
                 "/nowhere/r.xml: error: cannot be written: No such file or directory\n"),
                ((".", "gain"), 2, "chimera test: components and folders are two calls\n"),
                ((".", "--seed", "3"), 2, "chimera test: --setup, --inputs, --names, --seed and --cycles belong to a "
                                          "component; a case has keys of its own\n"),
                (("gain", "--junit", "r.xml"), 2, "chimera test: --case, --junit, --jobs and --limit belong to a "
                                                  "folder with NAME.cases.yaml\n")):
            with self.subTest(words):
                self.assertEqual(self.chimera("test", *words), (code, "", said))


if __name__ == "__main__":
    unittest.main()
