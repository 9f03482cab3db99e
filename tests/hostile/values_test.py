# SPDX-License-Identifier: Apache-2.0
"""Values that no component can use, in descriptions and commands: numbers that are not finite, texts with a byte 0."""
import pathlib
import stat
import subprocess
import sys
import tempfile
import unittest
from unittest.mock import ANY

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "processes"))
from system import CHIMERA, HANG, System  # noqa: E402

GAIN = """
subsystem: subject
operator: {VALUE}
tasks:
  amp: {component: gain, rate: 100 Hz, alias: {x: wanted, y: got}, constants: {k: 2}}
  rod: {component: t_constants, constants: {scale: 1 m}}
"""
WITHIN = GAIN.replace("VALUE", "wanted: 1 MV")

REMEDY = "write a finite number"


class Values(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="chimera-hostile-"))

    def chimera(self, *words, text=None, environment=None):
        """(exit code, standard output, standard error); `text` is the description that FILE stands for."""
        file = self.folder / "subject.yaml"
        if text is not None:
            file.write_text(text)
        done = subprocess.run([str(CHIMERA), *(str(file) if word == "FILE" else str(word) for word in words)],
                              env=environment, cwd=self.folder, capture_output=True, text=True, timeout=HANG,
                              stdin=subprocess.DEVNULL)
        return done.returncode, done.stdout, done.stderr

    def test_a_value_that_is_not_finite_in_the_unit_of_the_port_is_refused(self):
        for value in ("inf V", "-inf V", "inf"):
            code, _, said = self.chimera("check", "FILE", text=GAIN.replace("VALUE", f"wanted: {value}"))
            self.assertEqual(code, 1, value + said)
            self.assertIn("subject.yaml:3:20: error:", said)
            self.assertIn("finite", said)
            self.assertIn(REMEDY, said)
        text = ("subsystem: subject\noperator: {x: 1 V}\ntasks:\n  a: {component: limit, rate: 10 Hz, alias: {y: z}, "
                "constants: {low: -1 V, high: inf V}}\n")
        self.assertEqual(self.chimera("check", "FILE", text=text), (0, ANY, ""), "declared: no limit there")
        # The unit of the port limits a number: 1e308 m is a length, 1e308 km is none.
        code, _, said = self.chimera("check", "FILE", text=WITHIN.replace("scale: 1 m", "scale: 1e308 km"))
        self.assertEqual(code, 1, said)
        self.assertIn("subject.yaml:6:52: error: constant 'scale' of task 'rod': found '1e308 km', which is not "
                      "finite in \"m\"", said)
        self.assertIn(REMEDY, said)

    def test_every_way_in_refuses_it(self):
        far = "1e308 km"
        code, _, said = self.chimera("check", "FILE", "--set", "rod.scale", far, text=WITHIN)
        self.assertEqual(code, 1, said)
        self.assertIn("finite", said)
        code, _, said = self.chimera("run", "FILE", "--virtual", "--for", "1 s", "--at", "10 ms: set wanted inf V")
        self.assertNotEqual(code, 0, said)
        self.assertIn("finite", said)
        code, out, said = self.chimera("sweep", "FILE", "--over", f"rod.scale = 1 m, {far}", "--for", "100 ms",
                                       "--measure", "end got")
        self.assertEqual(code, 1, out + said)
        self.assertIn("finite", out + said)
        (self.folder / "subject.cases.yaml").write_text(
            "cases:\n  far: {for: 100 ms, set: {wanted: inf V}, expect: ['got > 0 V']}\n")
        code, out, said = self.chimera("test", self.folder)
        self.assertEqual(code, 1, out + said)
        self.assertIn("finite", out + said)

    def test_a_zero_byte_in_a_text_is_refused(self):
        for text in ('subsystem: subject\ntasks:\n  a: {component: t_resource, resources: {file: "a\\0b"}}\n',
                     'subsystem: subject\ntasks:\n  a: {component: "t_resource\\x00"}\n',
                     'subsystem: subject\ntasks:\n  a: {component: t_resource, "resour\\u0000ces": {}}\n'):
            code, _, said = self.chimera("check", "FILE", text=text)
            self.assertEqual(code, 1, said)
            self.assertRegex(said, r"subject.yaml:3:\d+: error: a text holds the byte 0")
            self.assertIn("leave it out", said)

    def test_a_running_subsystem(self):
        with System(WITHIN, ("--observe-group", "root")) as system:
            folder = system.runtime / "chimera"
            self.assertEqual(stat.S_IMODE(folder.stat().st_mode), 0o711)
            for value in ("inf V", "1e308 GV"):
                self.assertIn("finite", system.chimera("set", "wanted", value, code=1).stderr)
            self.assertEqual(system.value("wanted"), 1)
            system.call("end", code=0)
            system.wait()
            self.assertEqual(stat.S_IMODE(folder.stat().st_mode), 0o700, "as before, once no other user may connect")


if __name__ == "__main__":
    unittest.main()
