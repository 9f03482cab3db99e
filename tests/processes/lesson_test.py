# SPDX-License-Identifier: Apache-2.0
"""The lessons about processes, command by command as their READMEs show them."""
import pathlib
import re
import shlex
import socket
import unittest

from system import System, await_that

LESSONS = pathlib.Path(__file__).resolve().parents[2] / "examples"


def commands(lesson):
    """Of the `sh` blocks. A line that ends in a backslash goes on; what is behind a # is a remark."""
    blocks = re.findall(r"```sh\n(.*?)```", (LESSONS / lesson / "README.md").read_text(), re.S)
    lines = "".join(blocks).replace("\\\n", " ").splitlines()
    return [re.sub(r"\s+#.*", "", line) for line in lines]


class Typed(unittest.TestCase):
    """What is typed in a folder of examples/; `said`: the last output of each command, by its first word."""

    def begin(self, lesson):
        self.folder, self.said = LESSONS / lesson, {}

    def type(self, system, command):
        words = shlex.split(command)
        self.assertEqual(words[0], "chimera", command)
        done = system.chimera(*words[1:], code=None, cwd=self.folder)
        if done.returncode not in ((0, 1) if "reactions.yaml" in command else (0,)):
            self.fail(f"{command}: {done.stdout}{done.stderr}\n{system.told()}")
        self.said[words[1]] = done.stdout
        return done.stdout

    def kill(self, system, rtpu, how=9):
        """As `kill -KILL "$(chimera status --pid RTPU)"`; the status of the rtpu before."""
        before = system.rtpu(rtpu)
        self.assertEqual(self.type(system, f"chimera status --pid {rtpu}"), f"{before['pid']}\n")
        self.assertTrue(system.kill(before["pid"], how))
        return before


class Lessons(Typed):
    def play(self, lesson, name):
        """The commands beside the run in real time, except the virtual ones, which tests/examples has."""
        self.begin(lesson)
        text = (self.folder / f"{name}.yaml").read_text()
        text = text.replace("max_consecutive: 1\n", "max_consecutive: 100\n")  # a machine that is away is no fault
        with System(text, name=name) as system:
            tasks = system.on()
            for command in commands(lesson):
                if killed := re.fullmatch(r'kill -KILL "\$\(chimera status --pid (\w+)\)"', command):
                    system.await_restart(killed[1], self.kill(system, killed[1]))
                    await_that(lambda: len(system.on()) == len(tasks), system.told)
                elif not command.startswith("chimera run"):
                    self.type(system, command)

    def test_an_rtpu_that_is_killed_comes_back(self):
        self.play("09_processes", "processes")
        self.assertIn("plan ended by signal 9 (SIGKILL)", self.said["events"])
        self.assertIn("plan is restarted, 1 of at most 3 times", self.said["events"])

    def test_a_standby_takes_over_and_a_switch_leads_back(self):
        self.play("19_standby", "standby")
        self.assertIn("took over from 'pinvkin'", self.said["events"])
        self.assertRegex(self.said["switch"], r"1 task arrives, 1 leaves, \d+ cycles? lost\n.*q_ref moves "
                                              r"by [^ ]+ rad, limit 0.005 rad\n")
        self.assertIn("figure_3d", self.said["receipts"])


class SafeMachine(Typed):
    def description(self, name):
        text = (self.folder / f"{name}.yaml").read_text()
        assert "safe_after: 20 " in text or "safe_after" not in text, text
        text = text.replace("safe_after: 20 ", "safe_after: 50 ")  # a machine that is away for 100 ms is no hang
        return re.sub("|".join(self.ports), lambda port: self.ports[port[0]], text)

    def free_port(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as found:
            found.bind(("127.0.0.1", 0))
            return str(found.getsockname()[1])

    def shoot(self, how):
        """The drive that turns stands then; the machine comes back."""
        self.machine.await_state("drive", "ON")
        self.drive.await_value("told", [3.0])
        since, before = self.machine.next_event(), self.kill(self.machine, "servo", how)
        await_that(lambda: self.drive.value("told") == [0.0], self.machine.told)
        self.machine.await_event(since, "safe", "written")
        self.machine.await_restart("servo", before)

    def do(self, command):
        if command.startswith(("chimera run", "sleep")) and "--virtual" not in command:
            return
        if command.startswith("kill"):
            return self.shoot({"-KILL": 9, "-STOP": 19}[command.split()[1]])
        if "drill" in command:
            self.drive.await_value("told", [3.0])
        before = self.machine.rtpu("servo")
        self.type(self.drive if "--subsystem drive" in command else self.machine, command)
        if "--kill" in command:
            self.machine.await_restart("servo", before)
        if command == "chimera end --subsystem drive":
            await_that(lambda: self.machine.call("status")["flag"]["up"], "the flag, after three restarts")

    def test_every_command_of_the_lesson_does_what_it_says(self):
        self.begin("20_safe_machine")
        self.ports = {"5621": self.free_port(), "5622": self.free_port()}
        with System(self.description("drive"), name="drive") as self.drive, \
                System(self.description("machine"), name="machine") as self.machine:
            self.drive.await_value("told", [3.0])
            for command in commands("20_safe_machine"):
                self.do(command)
                if "--kill" in command:
                    self.assertRegex(self.said["drill"], r"killed, 1 of 1 safe frames written [0-9.]+ [mu]?s after")
                if command.startswith("chimera events") and "safe" in command:
                    self.assertIn("1 safe frame written", self.said["events"])
            self.assertIn("is silent: bring it back", self.said["events"])
            self.assertIn("flag UP", self.said["status"])
            self.assertIn("ended by the reaction `stop` of task 'brake'", self.said["run"])


if __name__ == "__main__":
    unittest.main(verbosity=1)
