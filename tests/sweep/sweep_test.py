# SPDX-License-Identifier: Apache-2.0
"""`chimera sweep`: its table, its files, and its refusals."""
import csv
import json
import os
import pathlib
import unittest
import xml.etree.ElementTree

from place import Place


class Sweep(Place):
    def sweep(self, *words):
        return self.chimera("sweep", "small.yaml", "--for", "50 ms", *words)

    def test_all_combinations_are_in_one_table_for_any_number_of_jobs(self):
        words = ("--over", "k = 1, 2 N.m/rad", "--over", "x = [1:1:3] rad", "--measure", "y", "--measure", "max |y|",
                 "--expect", "y <= 5 N.m", "--csv", "t.csv", "--svg", "t.svg")
        code, out, err = self.sweep(*words, "--jobs", "1")
        self.assertEqual((code, err), (1, ""), "one run does not hold")
        self.assertEqual(out, "k [N.m/rad]  x [rad]  y [N.m]  max |y| [N.m]  y <= 5 N.m\n"
                              "          1        1        1              1       holds\n"
                              "          1        2        2              2       holds\n"
                              "          1        3        3              3       holds\n"
                              "          2        1        2              2       holds\n"
                              "          2        2        4              4       holds\n"
                              "          2        3        6              6       FAILS\n")
        rows = list(csv.reader((self.path / "t.csv").read_text().splitlines()))
        self.assertEqual(rows[0], ["k [N.m/rad]", "x [rad]", "y [N.m]", "max |y| [N.m]", "y <= 5 N.m",
                                   "failure"])
        self.assertEqual(rows[6], ["2", "3", "6.0", "6.0", "FAILS", ""])
        drawn = xml.etree.ElementTree.parse(self.path / "t.svg").getroot()
        texts = [e.text for e in drawn.iter("{http://www.w3.org/2000/svg}text")]
        self.assertIn("k [N.m/rad]", texts)
        self.assertIn("y, x = 3 rad", texts)
        files = [(self.path / name).read_bytes() for name in ("t.csv", "t.svg")]
        self.assertEqual(self.sweep(*words, "--jobs", "5"), (code, out, err))
        self.assertEqual(files, [(self.path / name).read_bytes() for name in ("t.csv", "t.svg")])

    def test_the_value_moves_the_trajectory_and_measures_say_how(self):
        code, out, _ = self.sweep("--over", "k = 1, 3 N.m/rad", "--at", "25 ms: set x 5 rad", "--json",
                                  *sum((("--measure", m) for m in ("min y", "max y", "mean y", "rms y",
                                                                   "settling y >= 4 N.m")), ()))
        self.assertEqual(code, 0)
        runs = json.loads(out)["runs"]
        told = [{name: round(v["value"], 6) for name, v in run["values"].items()} for run in runs]
        self.assertEqual(told[0], {"min y": 1, "max y": 5, "mean y": 2.6, "rms y": round(10.6 ** 0.5, 6),
                                   "settling y >= 4 N.m": 0.04})
        self.assertEqual(told[1]["max y"], 15)
        self.assertEqual(runs[1]["set"], {"k": "3 N.m/rad"})

    def test_a_run_that_dies_or_is_refused_is_a_row(self):
        code, out, err = self.sweep("--over", "crash.how = nothing, kill, abort", "--measure", "y")
        self.assertEqual((code, err), (1, ""))
        lines = out.splitlines()
        self.assertRegex(lines[1], r"^ +nothing +2$")
        self.assertRegex(lines[2], r"^ +kill +-  FAILED: ended by signal 9 \(SIGKILL\) in crash.cycle")
        self.assertRegex(lines[3], r"^ +abort +-  FAILED: ended by ")
        code, out, _ = self.sweep("--over", "k = 1 N.m/rad, 2 furlongs", "--measure", "y")
        self.assertEqual(code, 1)
        self.assertRegex(out, r"\n *1 N\.m/rad +1\n *2 furlongs +-  FAILED: small\.yaml:\d+:\d+: error: "
                              r"k = 2 furlongs: ")
        code, out, _ = self.sweep("--over", "crash.how = nothing, hang", "--measure", "y", "--limit", "2 s")
        self.assertEqual(code, 1)
        self.assertRegex(out, r"\n +hang +-  FAILED: did not end within 2 s in crash.cycle\n$")

    def test_elements_and_magnitudes_of_a_list(self):
        arm = pathlib.Path(os.environ["CHIMERA_SOURCE"]).resolve() / "examples/01_puma_pid/puma_pid.yaml"
        words = ("sweep", str(arm), "--over", "payload_mass = 0, 2 kg", "--for", "0.1 s", "--json")
        code, out, _ = self.chimera(*words, "--measure", "tau", "--measure", "min tau[1]", "--measure", "max |tau[1]|")
        self.assertEqual(code, 0, out)
        for run in json.loads(out)["runs"]:
            values = {name: v["value"] for name, v in run["values"].items()}
            self.assertEqual(list(values), [f"tau[{i}]" for i in range(6)] + ["min tau[1]", "max |tau[1]|"])
            self.assertGreaterEqual(values["max |tau[1]|"], abs(values["min tau[1]"]))
        code, out, _ = self.chimera(*words, "--measure", "tau[6]")
        self.assertEqual(code, 1)
        self.assertIn("'tau[6]': no element 'tau[6]': there are tau[0] to tau[5]",
                      json.loads(out)["runs"][0]["failure"])

    def test_refuses_before_anything_runs(self):
        y = ("--measure", "y")
        for words, code, said in (
                (("--over", "k =", *y), 1, "error: --over 'k =': a value is missing\n"),
                (("--over", "kk = 1", *y), 1, "small.yaml: error: --over 'kk = 1': the file has no operator variable "
                                              "or constant 'kk'; did you mean 'k'?\n"),
                (("--over", "y = 1", *y), 1, "small.yaml:4:3: error: --over 'y = 1': 'y' is produced by task 'gain'; "
                                             "operator variables and constants of the file can be set\n"),
                (("--over", "k = [0:1:99999]", "--over", "x = [0:1:9999]", *y), 1,
                 "error: these lists make 1000000000 runs, all combinations; at most 100000: take wider steps, or "
                 "fewer lists\n"),
                (("--over", "k = 1", "--over", "k = 2", *y), 1,
                 "small.yaml: error: --over 'k = 2': 'k' is set twice\n"),
                (("--over", "k = 1", "--measure", "max yy"), 1, "error: 'max yy': no state variable 'yy'; did you mean "
                                                                "'y'?\n"),
                (("--over", "k = 1", "--measure", "maxx y"), 1, "error: 'maxx y': no measure 'maxx'; did you mean "
                                                                "'max'? There are end, min, max, mean, rms, "
                                                                "settling\n"),
                (("--over", "k = 1", *y, "--csv", "/nowhere/t.csv"), 1,
                 "/nowhere/t.csv: error: cannot be written: No such file or directory\n"),
                (("--over", "k = 1"), 2, "chimera sweep: name what to look at: --measure 'max |error|', or --expect "
                                         "'error <= 2 mrad'\n")):
            with self.subTest(words):
                self.assertEqual(self.sweep(*words), (code, "", said))


if __name__ == "__main__":
    unittest.main()
