# SPDX-License-Identifier: Apache-2.0
"""Which subsystem a command reaches: one of this terminal or folder, or one that is named."""
import json
import re
import subprocess
import unittest

from system import CHIMERA, HANG, TWO_RTPUS, System, await_that


class Naming(unittest.TestCase):
    def chimera(self, system, *words, elsewhere=True, folder="/"):
        """(exit code, standard output, standard error); `elsewhere`: of another session, as another terminal is."""
        done = system.chimera(*words, code=None, cwd=folder, start_new_session=elsewhere)
        return done.returncode, done.stdout, done.stderr

    def test_an_act_from_another_terminal_and_folder_wants_the_name(self):
        with System(TWO_RTPUS) as system:
            code, out, err = self.chimera(system, "off", "beside")
            self.assertEqual((code, out), (1, ""))
            keeper = system.call("hello")["keeper_pid"]
            self.assertEqual(err, f"'subject' was started in {system.place} (process {keeper}), not from this terminal "
                                  "or folder; if you mean it, type: chimera off beside --subsystem subject\n")
            self.assertEqual(system.state("beside"), "ON")
            self.assertEqual(self.chimera(system, "end")[0], 1)
            self.assertEqual(self.chimera(system, "status", "--pid", "first")[0], 1)
            self.assertEqual(self.chimera(system, *err.split("type: chimera ")[1].split()),
                             (0, "[subject] beside: ON -> OFF\n", ""), "what the refusal says to type works")

    def test_a_question_says_which_subsystem_it_found(self):
        with System(TWO_RTPUS) as system:
            code, out, err = self.chimera(system, "get", "x")
            self.assertEqual((code, err), (0, "[subject]\n"))
            self.assertTrue(out.startswith("x = "))
            self.assertTrue(self.chimera(system, "status")[1].startswith("subject: all, up "))
            self.assertEqual(json.loads(self.chimera(system, "get", "x", "--json")[1])["subsystem"], "subject")

    def test_its_folder_its_description_and_its_terminal_are_enough(self):
        with System(TWO_RTPUS) as system:
            for number, how in enumerate(({"folder": system.place}, {"elsewhere": False})):
                word = ("off", "on")[number]
                code, out, err = self.chimera(system, word, "beside", **how)
                self.assertEqual((code, err), (0, ""), out)
                self.assertTrue(out.startswith("[subject] beside: "), out)
            self.assertEqual(self.chimera(system, "status", "--pid", "first", elsewhere=False),
                             (0, f"{system.rtpu('first')['pid']}\n", ""))

    def test_of_several_the_one_of_this_folder_is_meant(self):
        with System(TWO_RTPUS) as system:
            folder = system.place / "other"
            folder.mkdir()
            other = folder / "other.yaml"
            other.write_text(TWO_RTPUS.replace("subject", "other"))
            run = subprocess.Popen([str(CHIMERA), "run", str(other), "--priority", "0"], env=system.environment,
                                   cwd=folder, start_new_session=True, stdout=subprocess.DEVNULL)
            try:
                await_that(lambda: re.search(r"^beside +ON ", self.chimera(system, "status", "--subsystem", "other")[1],
                                             re.M), "the start")
                self.assertEqual(self.chimera(system, "off", "beside", folder=folder),
                                 (0, "[other] beside: ON -> OFF\n", ""))
                self.assertEqual(self.chimera(system, "get", "x", folder=folder)[2], "[other]\n")
                said = self.chimera(system, "--subsystem", "subject", "status", folder=folder)[1]
                self.assertTrue(said.startswith("subject: "), said)
                said = self.chimera(system, "--json", "--subsystem=subject", "get", "x", folder=folder)[1]
                self.assertEqual(json.loads(said)["subsystem"], "subject")
                self.assertEqual(self.chimera(system, "off", "beside"),
                                 (1, "", "several subsystems run: other, subject; say --subsystem NAME\n"))
                self.assertEqual(system.state("beside"), "ON")
            finally:
                run.terminate()
                run.wait(HANG)


if __name__ == "__main__":
    unittest.main(verbosity=1)
