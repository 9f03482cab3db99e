# SPDX-License-Identifier: Apache-2.0
"""The lesson about processes, command by command as its README shows them."""
import pathlib
import re
import shlex
import subprocess
import unittest

from system import CHIMERA, System, await_that

LESSON = pathlib.Path(__file__).resolve().parents[2] / "examples/09_processes"


def commands():
    blocks = re.findall(r"```sh\n(.*?)```", (LESSON / "README.md").read_text(), re.S)
    return [line for block in blocks for line in block.splitlines()]


class Lesson(unittest.TestCase):
    def test_every_command_of_the_lesson_does_what_it_says(self):
        first, *others = commands()
        self.assertEqual(first, "chimera run processes.yaml")
        with System((LESSON / "processes.yaml").read_text(), name="processes") as system:
            said = {}
            for command in others:
                if command == 'kill -KILL "$(chimera status --pid plan)"':
                    self.kill_the_plan(system)
                    continue
                words = shlex.split(command)[1:]
                done = subprocess.run([str(CHIMERA), *words], env=system.environment, capture_output=True, text=True,
                                      timeout=30, stdin=subprocess.DEVNULL, cwd=LESSON)
                self.assertEqual(done.returncode, 0, command + ": " + done.stdout + done.stderr)
                said[words[0]] = done.stdout
            self.assertIn("plan", said["status"])
            self.assertIn("plan ended by signal 9 (SIGKILL)", said["events"])
            self.assertIn("plan is restarted, 1 of at most 3 times", said["events"])
            self.assertIn("q_ref", said["why"])
            self.assertIn("plan died at 1.000 s", said["run"])

    def kill_the_plan(self, system):
        before, unit = system.task("arm"), system.rtpu("plan")
        pid = subprocess.run([str(CHIMERA), "status", "--pid", "plan"], env=system.environment, capture_output=True,
                             text=True, timeout=30, check=True).stdout
        self.assertEqual(pid, f"{unit['pid']}\n")
        self.assertTrue(system.kill(int(pid)))
        await_that(lambda: system.rtpu("plan")["incarnation"] > unit["incarnation"], 10, "a restart")
        system.await_state("trajectory", "ON")
        after = await_that(lambda: (t := system.task("arm"))["cycles"] > before["cycles"] + 10 and t, 5, "cycles")
        self.assertEqual((after["state"], after["incarnation"], after["faults"]), ("ON", before["incarnation"], 0))


if __name__ == "__main__":
    unittest.main(verbosity=1)
