# SPDX-License-Identifier: Apache-2.0
"""A drill on real processes: the arm of the lesson comes to rest and says so, what cannot tell is no proof, and the
flag is down again whatever happens."""
import json
import pathlib
import subprocess
import unittest

from system import CHIMERA, UNITS, Refused, System, await_that

LESSON = pathlib.Path(__file__).resolve().parents[2] / "examples/09_processes/processes.yaml"
CANNOT_TELL = UNITS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  log: {component: csv_log, rtpu: first, rate: 50 Hz, alias: {in: [count]}, resources: {file: LOG}}
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
    def chimera(self, system, *words):
        return subprocess.run([str(CHIMERA), *words], env=system.environment, cwd=system.place, capture_output=True,
                              text=True, timeout=60, stdin=subprocess.DEVNULL)

    def await_flag_down(self, system):
        await_that(lambda: not system.call("status")["flag"]["up"], 5, "the flag to be down")

    def test_an_arm_that_moves_comes_to_rest_and_says_so(self):
        with System(LESSON.read_text(), name="processes") as system:
            system.await_state("trajectory", "ON")
            done = self.chimera(system, "drill", "--yes", "--json")
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            answer = json.loads(done.stdout)
            self.assertTrue(answer["safe"])
            self.assertEqual([(t["task"], t["verdict"]) for t in answer["tasks"]], [("arm", "safe")])
            self.assertGreater(answer["tasks"][0]["after_ns"], 0)
            self.assertLessEqual(answer["tasks"][0]["after_ns"], answer["flag_ns"])
            self.await_flag_down(system)
            text = self.chimera(system, "drill", "--yes")
            self.assertRegex(text.stdout, r"\[processes\] arm: safe [0-9.e+-]+ ms after the flag\n"
                                          r"\[processes\] flag up for [0-9.e+-]+ ms\n")
            told = [e["text"] for e in system.events() if e["kind"] == "drill"]
            self.assertEqual(told[0], "the drill raised the flag")
            self.assertRegex(told[1], r"^safe [0-9.]+ ms after the flag$")

    def test_what_cannot_tell_is_no_proof_and_a_log_is_not_asked(self):
        with System(CANNOT_TELL.replace("LOG", "rows.csv")) as system:
            done = self.chimera(system, "drill", "--yes")
            self.assertEqual(done.returncode, 1)
            self.assertIn("winch: cannot tell: its component has no safe_state output\n", done.stdout)
            self.assertNotIn("log", done.stdout)
            system.signal("off", "winch")
            done = self.chimera(system, "drill", "--yes")
            self.assertEqual(done.returncode, 1)
            self.assertIn("no task that is ON has hardware that could move\n", done.stdout)
            self.await_flag_down(system)

    def test_asks_before_and_begins_with_the_flag_down(self):
        with System(CANNOT_TELL.replace("LOG", "rows.csv")) as system:
            done = self.chimera(system, "drill")
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn("drill: not agreed to; `--yes` does not ask", done.stderr)
            self.assertEqual([e for e in system.events() if e["kind"] == "drill"], [])
            system.call("flag", up=True)
            with self.assertRaises(Refused) as refused:
                system.call("drill")
            self.assertEqual(refused.exception.data["kind"], "flag-up")
            self.assertEqual(system.call("status")["flag"]["by"], ["operator"])

    def test_a_manager_that_dies_takes_its_drill_with_it(self):
        text = LESSON.read_text()
        with System(text, name="processes") as system:
            system.await_state("arm", "ON")
            pids = system.pids()
            asked = subprocess.Popen([str(CHIMERA), "drill", "--yes"], env=system.environment, cwd=system.place,
                                     stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
            system.kill(pids["manager"])
            asked.wait(30)
            await_that(lambda: system.pids()["manager"] != pids["manager"], 10, "another manager")
            self.await_flag_down(system)


if __name__ == "__main__":
    unittest.main(verbosity=1)
