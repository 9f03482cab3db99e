# SPDX-License-Identifier: Apache-2.0
"""A command reaches the subsystem that was started in its terminal or folder, or a subsystem by name."""
import subprocess
import unittest

from system import CHIMERA, HANG, TWO_RTPUS, System, await_that


class Naming(unittest.TestCase):
    def chimera(self, system, *words, elsewhere=True, folder="/"):
        """(exit code, standard output, standard error); `elsewhere`: of another session, as another terminal is."""
        done = system.chimera(*words, code=None, cwd=folder, start_new_session=elsewhere)
        return done.returncode, done.stdout, done.stderr

    def test_a_command_from_another_terminal_and_folder_wants_the_name(self):
        with System(TWO_RTPUS) as system:
            code, out, err = self.chimera(system, "off", "beside")
            self.assertEqual((code, out), (1, ""))
            keeper = system.call("hello")["keeper_pid"]
            self.assertEqual(err, f"'subject' was started in {system.place} (process {keeper}), not from this terminal "
                                  "or folder; if you mean it, type: chimera off beside --subsystem subject\n")
            self.assertEqual(system.state("beside"), "ON")
            self.assertEqual(self.chimera(system, *err.split("type: chimera ")[1].split()),
                             (0, "[subject] beside: ON -> OFF\n", ""), "what the refusal says to type works")
            self.assertEqual(self.chimera(system, "on", "beside", folder=system.place)[0], 0)
            self.assertEqual(self.chimera(system, "off", "beside", elsewhere=False)[0], 0)
            self.assertEqual(self.chimera(system, "get", "x")[2], "[subject]\n", "a question says what it found")

    def test_the_subsystem_of_this_folder_is_meant(self):
        with System(TWO_RTPUS) as system:
            folder = system.place / "other"
            folder.mkdir()
            (folder / "other.yaml").write_text(TWO_RTPUS.replace("subject", "other"))
            run = subprocess.Popen([str(CHIMERA), "run", "other.yaml", "--priority", "0"], env=system.environment,
                                   cwd=folder, start_new_session=True, stdout=subprocess.DEVNULL)
            try:
                await_that(lambda: "beside  ON " in self.chimera(system, "status", "--subsystem", "other")[1], "it")
                self.assertEqual(self.chimera(system, "off", "beside", folder=folder),
                                 (0, "[other] beside: ON -> OFF\n", ""))
                self.assertEqual(self.chimera(system, "off", "beside"),
                                 (1, "", "several subsystems run: other, subject; say --subsystem NAME\n"))
                self.assertEqual(system.state("beside"), "ON")
            finally:
                run.terminate()
                run.wait(HANG)


if __name__ == "__main__":
    unittest.main(verbosity=1)
