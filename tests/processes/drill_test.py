# SPDX-License-Identifier: Apache-2.0
"""A drill on real processes: the arm of the lesson comes to rest and says so, a task that cannot tell is no proof, and
the flag is down again afterwards."""
import json
import pathlib
import subprocess
import unittest

from system import CHIMERA, HANG, RTPUS, Refused, System, await_that

LESSON = pathlib.Path(__file__).resolve().parents[2] / "examples/09_processes/processes.yaml"
CANNOT_TELL = RTPUS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  log: {component: csv_log, rtpu: first, rate: 50 Hz, alias: {in: [count]}, resources: {file: rows.csv}}
  winch:
    component: t_crash
    rtpu: second
    rate: 100 Hz
    constants: {where: cycle, how: hang}
    resources: {armed: ARMED}
configurations: {all: [steady, log, winch], idle: [steady, log]}
start: all
"""


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

    def test_what_cannot_tell_is_no_proof_and_a_log_is_not_asked(self):
        with System(CANNOT_TELL) as system:
            said = system.chimera("drill", "--yes", code=1).stdout
            self.assertIn("winch: cannot tell: its component has no safe_state output\n", said)
            self.assertNotIn("log", said)
            system.signal("off", "winch")
            self.assertIn("no task that is ON has hardware that could move\n",
                          system.chimera("drill", "--yes", code=1).stdout)
            self.await_flag_down(system)

    def test_asks_before_and_begins_with_the_flag_down(self):
        with System(CANNOT_TELL) as system:
            done = system.chimera("drill", code=2)
            self.assertEqual(done.stdout, "")
            self.assertIn("drill: not agreed to; `--yes` does not ask", done.stderr)
            self.assertEqual(system.events(0, "drill"), [])
            system.call("flag", up=True)
            with self.assertRaises(Refused) as refused:
                system.call("drill")
            self.assertEqual(refused.exception.data["kind"], "flag-up")
            self.assertEqual(system.call("status")["flag"]["by"], ["operator"])

    def test_a_manager_that_dies_takes_its_drill_with_it(self):
        with System(LESSON.read_text(), name="processes") as system:
            system.await_state("arm", "ON")
            manager = system.pids()["manager"]
            asked = subprocess.Popen([str(CHIMERA), "drill", "--yes"], env=system.environment, cwd=system.place,
                                     stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
            system.await_event(0, "drill", "raised the flag")
            system.kill(manager)
            asked.wait(HANG)
            await_that(lambda: system.pids()["manager"] != manager, "another manager")
            self.await_flag_down(system)


if __name__ == "__main__":
    unittest.main(verbosity=1)
