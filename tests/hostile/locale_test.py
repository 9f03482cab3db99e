# SPDX-License-Identifier: Apache-2.0
"""A component that sets the locale of its process changes no number that the product reads or writes."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "processes"))
from system import BUILD, CHIMERA, HANG, QUIET  # noqa: E402

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
URDF = SOURCE / "library/urdf_model/puma560.urdf"
TEXT = """subsystem: subject
rtpus: {main: {cpu: 0, policy: edf, executor: EXECUTOR}}
tasks:
  FIRST
  played: {component: csv_player, rate: 100 Hz, alias: {out: [x]}, constants: {is_interpolated: true},
           resources: {file: played.csv}}
  held: {component: limit, rate: 100 Hz, constants: {low: -9.5 rad, high: 9.5 rad}}
  log: {component: csv_log, rate: 100 Hz, alias: {in: [x, y]}, resources: {file: log.csv}}
  LAST
"""
SETS = "turns: {component: t_locale}"
MODELS = {"urdf_model": "chain: {component: urdf_model, resources: {model: URDF}}",
          "mujoco_robot": "arm: {component: mujoco_robot, rate: 1 kHz, resources: {model: URDF}}\n"
                          "operator: {q_ref: [0.25 rad, 0 rad, 0 rad, 0 rad, 0 rad, 0 rad]}"}


class Locale(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="chimera-locale-"))
        self.addCleanup(shutil.rmtree, self.folder, True)
        made = shutil.which("localedef") and subprocess.run(
            ["localedef", "-i", "de_DE", "-f", "UTF-8", str(self.folder / "de_DE.UTF-8")], capture_output=True)
        self.has_locale = bool(made) and made.returncode == 0

    def run_with(self, first, last, *words, executor="executive"):
        """(standard output, the recording, the picture) of one run in a folder of its own."""
        place = pathlib.Path(tempfile.mkdtemp(dir=self.folder))
        (place / "played.csv").write_text("t(s),x(rad)\n0,0.25\n1,1.75\n")
        text = TEXT.replace("FIRST", first).replace("LAST", last).replace("URDF", str(URDF))
        (place / "subject.yaml").write_text(text.replace("EXECUTOR", executor))
        environment = dict(os.environ, XDG_RUNTIME_DIR=str(place), ASAN_OPTIONS=QUIET)
        if self.has_locale:
            environment.update(LOCPATH=str(self.folder), LC_ALL="de_DE.UTF-8")
        done = subprocess.run([str(CHIMERA), "run", "subject.yaml", "--for", "500 ms", *words], cwd=place,
                              env=environment, capture_output=True, text=True, timeout=HANG)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        if "turns" in first + last and self.has_locale:
            self.assertIn("the locale is de_DE.UTF-8", done.stdout)
        self.assertNotRegex(done.stdout, r"\d,\d")
        picture = place / "picture.svg"
        return done.stdout, (place / "log.csv").read_text(), picture.read_text() if picture.exists() else ""

    def test_virtual_runs_are_the_same_to_the_byte(self):
        words = ("--virtual", "--watch", "y", "--every", "10 ms", "--svg", "picture.svg")
        _, log, picture = self.run_with("", "", *words)
        self.assertRegex(log, r"\n0\.\d+,0\.\d+,")
        for first, last in ((SETS, ""), ("", SETS)):
            self.assertEqual(self.run_with(first, last, *words)[1:], (log, picture))

    def test_recordings_of_real_runs_have_a_decimal_point(self):
        for words, executor in ((("--priority", "0"), "executive"), (("--priority", "0"), "preemptive"),
                                (("--priority", "0", "--isolation", "none"), "executive")):
            with self.subTest(words=words, executor=executor):
                head, *rows = self.run_with(SETS, "", *words, executor=executor)[1].splitlines()
                self.assertEqual(head, "t(s),x(rad),y(rad)")
                self.assertTrue(rows)
                for row in rows:
                    self.assertRegex(row, r"^\d[^,]*,[01]\.?\d*,([01]\.?\d*)?$")

    def test_models_are_read(self):
        for component, task in MODELS.items():
            if not (BUILD / f"components/{component}.so").exists():
                continue
            for words in (("--virtual",), ("--priority", "0")):
                with self.subTest(component=component, words=words):
                    self.run_with(SETS, task, *words)


if __name__ == "__main__":
    unittest.main()
