# SPDX-License-Identifier: Apache-2.0
"""Output and exit codes of `chimera run` when it runs an application in processes."""
import contextlib
import json
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "processes"))
from system import CHIMERA, HANG, System, await_that  # noqa: E402

OUTPUTS = "count dt now deadline cycles dropped illegal".split()


def counter(task, rtpu):
    alias = ", ".join(f"{name}: {task}_{name}" for name in OUTPUTS)
    return f"  {task}: {{component: t_counter, rtpu: {rtpu}, rate: 100 Hz, alias: {{{alias}}}}}\n"


ONE = "subsystem: subject\nrtpus: {first: {cpu: 0}}\ntasks:\n" + counter("one", "first")
TWO = ("subsystem: subject\nrtpus: {first: {cpu: 0}, second: {cpu: 0}}\ntasks:\n" +
       counter("one", "first") + counter("two", "second"))


def run(text, *arguments):
    """Exit code and output of a run that ends by itself."""
    with System(text, arguments, wait=False) as system:
        code = system.wait()
        said = system.said()
        system.await_nothing_left()
        assert not system.socket.exists(), "a socket is left behind"
        return code, said


class Run(unittest.TestCase):
    def test_prints_rights_watched_values_and_the_verdict(self):
        code, said = run(TWO, "--for", "2 s", "--watch", "one_count", "--every", "1 s",
                         "--expect", "two_count >= 1")
        self.assertEqual(code, 0, said)
        lines = said.splitlines()
        self.assertTrue(lines[0].startswith("subject: legal. 2 tasks"), said)
        warning = r"WARNING: not real time\n(  .*\n)+"
        self.assertRegex(said, r"\nfirst: " + warning + "second: " + warning + r"t 1\.000 s  one_count \d+\n")
        self.assertRegex(said, r"\nt 2\.000 s  one_count \d+\nran 2\.000 s\ntask ")
        self.assertRegex(said, r"\none   ON  +\d+ .*\ntwo   ON  +\d+ .*\n"
                               r"holds: two_count >= 1 \(two_count is \d+\)\n(not )?clean: .*\n$")

    def test_schedule_reads_a_saved_profile(self):
        with tempfile.TemporaryDirectory() as folder:
            file, saved, late = (pathlib.Path(folder) / name for name in ("two.yaml", "p.json", "late.json"))
            file.write_text(TWO)

            def chimera(*words, code=0):
                done = subprocess.run([CHIMERA, *words], capture_output=True, text=True, timeout=HANG)
                self.assertEqual(done.returncode, code, done.stderr)
                return done

            with System(TWO, ("--profile", str(saved))) as system:
                self.assertEqual(system.chimera("profile", "--save", late).stdout, f"{late}: written\n")
                refused = system.chimera("profile", "--save", "/nowhere/p.json", code=1)
                self.assertEqual((refused.stdout, refused.stderr),
                                 ("", "[subject]\n/nowhere/p.json: cannot be written: No such file or directory\n"))
                system.process.send_signal(signal.SIGINT)
                self.assertEqual(system.wait(), 0, system.said())
            for name in (saved, late):
                self.assertRegex(chimera("schedule", str(file), "--profile", str(name)).stdout,
                                 r"\n  one +first +low +\S+ [mun]?s profile +10 ms")
            self.assertEqual(sorted(path.name for path in pathlib.Path(folder).iterdir()),
                             ["late.json", "p.json", "two.yaml"])
            budgets = file.with_name("budgets.yaml")
            budgets.write_text(TWO.replace("rtpu: second", "rtpu: first").replace("rate:", "budget: 1 ms, rate:"))
            words = ("run", str(budgets), "--virtual", "--for", "1 s", "--profile")
            chimera(*words, str(saved))
            self.assertIn(" 1 ms profile ", chimera("schedule", str(budgets), "--profile", str(saved)).stdout)
            self.assertEqual(chimera(*words, "/nowhere/p.json", code=1).stderr,
                             "/nowhere/p.json: cannot be written: No such file or directory\n")

    def test_values_are_set_beside_the_file(self):
        """From the start, and at a stated time; the manager knows them, too."""
        text = ("subsystem: subject\nconstants: {k: 2 N.m/rad}\ntasks:\n  gain: {rate: 100 Hz}\n"
                "operator: {x: 1 rad}\n")
        words = ("--set", "x", "2 rad", "--set", "k", "3 N.m/rad", "--at", "1.2 s: set x 180 deg")
        with System(text, words) as system:
            self.assertEqual(system.value("x"), 2)
            system.await_event(0, "set", "x = 3.14159 rad")
            await_that(lambda: abs(system.value("y") - 9.42478) < 1e-4, "3 N.m/rad times 180 deg")
            self.assertEqual(system.call("save")["operator"], {"x": "3.141592653589793 rad"})

    def test_a_switch_is_done_in_one_process(self):
        text = ("subsystem: subject\ntasks:\n"
                "  slow: {component: gain, rate: 100 Hz, constants: {k: 2}}\n"
                "  fast: {component: gain, rate: 100 Hz, constants: {k: 3}, max_step: {y: 2 m}}\n"
                "operator: {x: 1 m}\nconfigurations: {gentle: [slow], quick: [fast]}\nstart: gentle\n")
        code, said = run(text, "--isolation", "none", "--for", "2 s", "--at", "0.1 s: switch quick",
                         "--at", "1.5 s: switch --off fast", "--expect", "y >= 3 m")
        self.assertEqual(code, 0, said)
        self.assertRegex(said, r"\nswitch \d+ at \d\.\d+ s from 'gentle' to 'quick' after \d+\.\d+ ms: 1 task arrives, "
                               r"1 leaves, \d+ cycles? lost; y moves by 1 m, limit 2 m\n")
        self.assertRegex(said, r"\nrefused at 1\.\d+ s: switch --off fast: no task would be ON\n")
        self.assertRegex(said, r"\nslow  OFF .*\nfast  ON ")

    def test_records_every_rtpu(self):
        words = ("--for", "1 s", "--trace", "trace.json", "--timeline", "10 ms")
        with System(TWO, words, wait=False) as system:
            self.assertEqual(system.wait(), 0, system.said())
            events = json.loads((system.place / "trace.json").read_text())["traceEvents"]
            self.assertEqual({event["pid"] for event in events if event.get("name") == "cycle"}, {1, 2})
            self.assertIn("\nfirst:\n", system.said())
            self.assertIn("\nsecond:\n", system.said())

    def test_one_process_runs_the_tasks_of_all_rtpus_in_one_loop(self):
        code, said = run(TWO, "--isolation", "none", "--for", "0.2 s")
        self.assertEqual(code, 0, said)
        self.assertRegex(said, r"\ntwo   ON ")
        self.assertIn("one process: all tasks in one loop, on the CPU and by the policy of 'first'", said)

    def test_a_second_run_of_that_name_is_refused(self):
        with System(TWO) as system:
            second = system.chimera("run", system.file, "--priority", "0", code=1,
                                    env=dict(system.environment, CHIMERA_TEST_MARK="none"))
            self.assertIn(f"a subsystem 'subject' runs already (process {system.process.pid}): end it", second.stderr)
            self.assertEqual(system.state("one"), "ON")

    def test_a_second_run_is_refused_for_its_name_before_its_cpu(self):
        with System(TWO) as system, socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as claim:
            with contextlib.suppress(OSError):  # another subsystem has the CPU
                claim.bind("\0chimera-cpu-0")
            second = system.chimera("run", system.file, code=1,
                                    env=dict(system.environment, CHIMERA_TEST_MARK="none"))
            self.assertIn("a subsystem 'subject' runs already", second.stderr)

    def test_measures_of_a_whole_run(self):
        code, said = run(TWO, "--for", "1 s", "--timeline", "10 ms", "--expect", "max one_count >= 1",
                         "--expect", "settling two_count >= 0 within 1 min", "--expect", "|one_count| >= 0",
                         "--expect", "min two_count < 0")
        self.assertEqual(code, 1, said)
        self.assertRegex(said, r"\nholds: \|one_count\| >= 0 \(one_count is \d+\)\n"
                               r"holds: max one_count >= 1 \(max one_count is \d+\)\n"
                               r"holds: settling two_count >= 0 within 1 min \(it holds from [\d.e-]+ s on\)\n"
                               r"FAILS: min two_count < 0 \(min two_count is \d+\)\n")


if __name__ == "__main__":
    unittest.main()
