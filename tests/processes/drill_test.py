# SPDX-License-Identifier: Apache-2.0
"""A drill on real processes: the arm of the lesson comes to rest and says so, and the flag is down again afterwards."""
import json
import pathlib
import unittest

from system import System, await_that

LESSON = pathlib.Path(__file__).resolve().parents[2] / "examples/09_processes/processes.yaml"


class Drill(unittest.TestCase):
    def await_flag_down(self, system):
        await_that(lambda: not system.call("status")["flag"]["up"], "the flag to be down")

    def test_an_arm_that_moves_comes_to_rest_and_says_so(self):
        with System(LESSON.read_text(), name="processes") as system:
            system.await_state("trajectory", "ON")
            answer = json.loads(system.chimera("drill", "--yes", "--json").stdout)
            self.assertTrue(answer["safe"])
            self.assertEqual([(t["task"], t["verdict"]) for t in answer["tasks"]], [("arm", "safe")])
            self.assertGreater(answer["tasks"][0]["after_ns"], 0)
            self.assertLessEqual(answer["tasks"][0]["after_ns"], answer["flag_ns"])
            self.await_flag_down(system)
            self.assertRegex(system.chimera("drill", "--yes").stdout,
                             r"\[processes\] arm: safe [0-9.e+-]+ ms after the flag\n"
                             r"\[processes\] flag up for [0-9.e+-]+ ms\n")
            told = system.texts("drill")
            self.assertEqual(told[0], "the drill raised the flag")
            self.assertRegex(told[1], r"^safe [0-9.]+ ms after the flag$")

    def test_asks_before_it_begins(self):
        with System(LESSON.read_text(), name="processes") as system:
            done = system.chimera("drill", code=2)
            self.assertEqual(done.stdout, "")
            self.assertIn("drill: not agreed to; `--yes` does not ask", done.stderr)
            self.assertEqual(system.events(0, "drill"), [])


if __name__ == "__main__":
    unittest.main(verbosity=1)
