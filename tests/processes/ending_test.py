# SPDX-License-Identifier: Apache-2.0
"""How a subsystem ends: in order, whichever process ends it, with nothing left behind."""
import signal
import subprocess
import unittest

from system import BUILD, CHAIN, System, await_that


class Ending(unittest.TestCase):
    def judge(self, system):
        """Nothing is left; off of every task came before its kill; consumers went off before their producers."""
        system.await_nothing_left()
        at = {}
        for label, method, when in system.lines():
            at.setdefault((label, method), when)
        for label in "abc":
            self.assertLess(at[label, "off"], at[label, "kill"])
        self.assertLess(at["c", "off"], at["b", "off"])
        self.assertLess(at["b", "off"], at["a", "off"])

    def test_row_29_signals_of_the_system_end_it_in_order(self):
        for word in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            with self.subTest(word), System(CHAIN) as system:
                await_that(lambda: "second: WARNING: not real time" in system.said(), "the printing process")
                system.process.send_signal(word)
                self.assertEqual(system.wait(), 0, system.said())
                self.judge(system)
                self.assertRegex(system.said(), r"ran \d+\.\d+ s, ended by the operator\n")
                self.assertFalse(system.socket.exists())

    def test_the_end_comes_without_a_manager_too(self):
        with System(CHAIN) as system:
            system.kill(system.pids()["manager"], signal.SIGSTOP)
            system.process.send_signal(signal.SIGTERM)
            system.wait()
            self.judge(system)

    def test_when_the_keeper_is_killed_every_rtpu_ends_its_tasks(self):
        with System(CHAIN) as system:
            await_that(lambda: "second: WARNING: not real time" in system.said(), "the printing process")
            system.process.kill()
            system.wait()
            self.judge(system)
            self.assertRegex(system.said(), r"ran \d+\.\d+ s, ended because its keeper died\n")

    def test_an_rtpu_whose_off_hangs_is_ended_all_the_same(self):
        with System(CHAIN.replace("{label: b}", "{label: b, slow: 3600000000000 ns}")) as system:
            system.process.send_signal(signal.SIGTERM)
            system.wait()
            system.await_nothing_left()

    def test_a_keeper_that_outlives_its_children_gathers_no_descriptors(self):
        with System(CHAIN) as system:
            before = system.descriptors(system.process.pid)
            for name in ("first", "manager", "second", "manager", "first"):
                was = system.pids()[name]
                self.assertTrue(system.kill(was))
                system.disconnect()
                await_that(lambda: system.pids().get(name, was) != was, f"another {name}")
                for task in "abc":
                    system.await_state(task, "ON")
            await_that(lambda: system.descriptors(system.process.pid) <= before, f"at most {before} descriptors")

    def test_programs_of_a_subsystem_are_not_for_people(self):
        for program in ("chimera-manager", "chimera-rtpu"):
            self.assertEqual(subprocess.run([BUILD / "bin" / program], capture_output=True).returncode, 2, program)


if __name__ == "__main__":
    unittest.main(verbosity=1)
