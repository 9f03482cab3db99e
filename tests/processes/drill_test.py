# SPDX-License-Identifier: Apache-2.0
"""A drill asks before it begins. What it does: the lesson in lesson_test.py."""
import pathlib
import unittest

from system import System

LESSON = pathlib.Path(__file__).resolve().parents[2] / "examples/09_processes/processes.yaml"


class Drill(unittest.TestCase):
    def test_asks_before_it_begins(self):
        with System(LESSON.read_text(), name="processes") as system:
            done = system.chimera("drill", code=2)
            self.assertEqual(done.stdout, "")
            self.assertIn("drill: not agreed to; `--yes` does not ask", done.stderr)
            self.assertEqual(system.events(0, "drill"), [])


if __name__ == "__main__":
    unittest.main(verbosity=1)
