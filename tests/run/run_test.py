# SPDX-License-Identifier: Apache-2.0
"""What `chimera run` prints and answers when it runs an application by processes."""
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "processes"))
from system import CHIMERA, System, await_that  # noqa: E402

OUTPUTS = "count dt now deadline cycles dropped illegal".split()


def counter(task, rtpu):
    alias = ", ".join(f"{name}: {task}_{name}" for name in OUTPUTS)
    return f"  {task}: {{component: t_counter, rtpu: {rtpu}, rate: 100 Hz, alias: {{{alias}}}}}\n"


TWO = ("subsystem: subject\nrtpus: {first: {cpu: 0}, second: {cpu: 0}}\ntasks:\n" +
       counter("one", "first") + counter("two", "second"))

LATE = """
subsystem: subject
tasks:
  calm: {component: t_source, rate: 100 Hz, alias: {x: xc, expired: ec}}
  late: {component: t_source, rate: 100 Hz, deadline: 5 ms, on_miss: REACTION, alias: {x: xl, expired: el},
         constants: {spend: 7000000 ns}}
configurations: {all: [calm, late]}
"""


def run(text, *arguments, **more):
    """What a run that ends by itself said, and its exit code."""
    with System(text, ("--priority", "0", *arguments), wait=False, **more) as system:
        code = system.process.wait(30)
        said = system.said()
        system.await_nothing_left()
        assert not system.socket.exists(), "a socket is left behind"
        return code, said


class Run(unittest.TestCase):
    def test_tells_what_was_granted_what_it_sees_and_how_it_went(self):
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

    def test_a_restart_is_told_and_fails_a_strict_run(self):
        for strict in (False, True):
            with System(TWO, ("--strict",) if strict else ()) as system:
                self.assertTrue(system.kill(system.rtpu("first")["pid"]))
                await_that(lambda: system.rtpu("first")["restarts"] == 1 and system.state("one") == "ON", 10, "it")
                system.process.send_signal(signal.SIGINT)
                self.assertEqual(system.process.wait(30), 1 if strict else 0, system.said())
                said = system.said()
                self.assertRegex(said, r"\nfirst: the counts of its tasks begin at its restart at \d+\.\d+ s\n"
                                       r"not clean: .*1 restart of first")
                self.assertEqual("FAILED: not clean, and --strict makes that a failure\n" in said, strict, said)

    def test_with_every_unit_dead_the_flag_is_up(self):
        one = "subject\nrtpus: {first: {cpu: 0}}\ntasks:\n" + counter("one", "first")
        with System("subsystem: " + one) as system:
            self.assertEqual(system.call("status")["flag"], {"up": False, "by": []})
            for death in range(4):
                unit = await_that(lambda: (u := system.rtpu("first"))["alive"] and u["restarts"] == death and u)
                self.assertTrue(system.kill(unit["pid"]))
            await_that(lambda: system.rtpu("first")["given_up"], 10, "giving up")
            self.assertEqual(system.call("status")["flag"], {"up": True, "by": ["first"]})
            self.assertEqual(system.signal("clear", "one")["tasks"][0]["after"], "OFF")
            self.assertEqual(system.call("status")["flag"], {"up": False, "by": []})

    def test_a_unit_that_is_given_up_comes_back_by_what_status_says_and_is_no_success_before(self):
        with System(TWO) as system:
            def chimera(*words):
                return subprocess.run([CHIMERA, *words], env=system.environment, capture_output=True, text=True,
                                      timeout=60)

            for death in range(4):
                unit = await_that(lambda: (u := system.rtpu("first"))["alive"] and u["restarts"] == death and u)
                self.assertTrue(system.kill(unit["pid"]))
            await_that(lambda: system.rtpu("first")["given_up"], 10, "giving up")
            refused = chimera("on", "one")
            self.assertEqual((refused.returncode, refused.stderr),
                             (1, "[subject] one is in state ERROR, where on is not legal; type `chimera clear one`, "
                                 "then `chimera on one`\n"))
            said = chimera("status").stdout
            self.assertIn("first: GIVEN UP; last end: ended by signal 9 (SIGKILL)", said)
            way = re.search(r"to bring it back type `chimera (.*?)`, then `chimera (.*?)`\n", said)
            self.assertEqual(chimera("status", "--pid", "first").returncode, 1)
            for command in way.groups():
                done = chimera(*command.split())
                self.assertEqual(done.returncode, 0, f"{command}: {done.stdout}{done.stderr}")
            self.assertEqual(system.state("one"), "ON")
            self.assertEqual(chimera("on", "one").stdout, "[subject] one: ON already\n")
            for death in range(4, 9):
                alive = await_that(lambda: (u := system.rtpu("first"))["given_up"]
                                   or (u["alive"] and u["restarts"] == death) and u, 10, "it")
                if alive is True:
                    break
                self.assertTrue(system.kill(alive["pid"]))
            await_that(lambda: system.rtpu("first")["given_up"], 10, "giving up")
            system.process.send_signal(signal.SIGINT)
            self.assertEqual(system.process.wait(30), 1, system.said())
            self.assertIn("\nFAILED: first was given up: ", system.said())
            self.assertIn("\nFAILED: one was in ERROR at the end", system.said())

    def test_an_expectation_that_fails_is_no_success(self):
        code, said = run(TWO, "--for", "0.1 s", "--expect", "two_count < 0", "--json")
        self.assertEqual(code, 1, said)
        told = json.loads(said)
        self.assertEqual(told["ended"], "time")
        self.assertEqual(told["ran_ns"], 100_000_000)
        self.assertEqual([task["task"] for task in told["tasks"]], ["one", "two"])
        self.assertFalse(told["expectations"][0]["holds"])

    def test_a_profile_that_was_saved_is_what_schedule_reads(self):
        with tempfile.TemporaryDirectory() as folder:
            file, saved, late = (pathlib.Path(folder) / name for name in ("two.yaml", "p.json", "late.json"))
            file.write_text(TWO)

            def chimera(*words):
                return subprocess.run([CHIMERA, *words], capture_output=True, text=True, timeout=60)

            with System(TWO, ("--profile", str(saved)), wait=False) as system:
                system.await_started()
                done = subprocess.run([CHIMERA, "profile", "--save", str(late)], env=system.environment,
                                      capture_output=True, text=True, timeout=60)
                self.assertEqual((done.returncode, done.stdout), (0, f"{late}: written\n"), done.stderr)
                refused = subprocess.run([CHIMERA, "profile", "--save", "/nowhere/p.json"], env=system.environment,
                                         capture_output=True, text=True, timeout=60)
                self.assertEqual((refused.returncode, refused.stdout, refused.stderr),
                                 (1, "", "[subject]\n/nowhere/p.json: cannot be written: No such file or directory\n"))
                system.process.send_signal(signal.SIGINT)
                self.assertEqual(system.process.wait(30), 0, system.said())
            for name in (saved, late):
                done = chimera("schedule", str(file), "--profile", str(name))
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertRegex(done.stdout, r"\n  one +first +low +\S+ [mun]?s profile +10 ms")
            self.assertEqual(sorted(path.name for path in pathlib.Path(folder).iterdir()),
                             ["late.json", "p.json", "two.yaml"])
            budgets = file.with_name("budgets.yaml")
            budgets.write_text(TWO.replace("rtpu: second", "rtpu: first").replace("rate:", "budget: 1 ms, rate:"))
            done = chimera("run", str(budgets), "--virtual", "--for", "1 s", "--profile", str(saved))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(" 1 ms profile ", chimera("schedule", str(budgets), "--profile", str(saved)).stdout)
            done = chimera("run", str(budgets), "--virtual", "--for", "1 s", "--profile", "/nowhere/p.json")
            self.assertEqual((done.returncode, done.stdout, done.stderr),
                             (1, "", "/nowhere/p.json: cannot be written: No such file or directory\n"))

    def test_names_the_task_whose_reaction_it_was(self):
        code, said = run(LATE.replace("REACTION", "stop"), "--for", "5 s")
        self.assertEqual(code, 1, said)
        self.assertIn(", ended by the reaction `stop` of task 'late'\n", said)
        for executor in ("executive", "preemptive"):
            rtpu = f"rtpus: {{main: {{executor: {executor}}}}}\ntasks:"
            text = LATE.replace("REACTION", "flag").replace("tasks:", rtpu)
            with self.subTest(executor), System(text, ("--priority", "0")) as system:
                await_that(lambda: any("raised by task 'late'" in e["text"] for e in system.events()), 10, "a name")
                self.assertTrue(system.call("status")["flag"]["up"])
                system.signal("off", "late")
                await_that(lambda: not system.call("status")["flag"]["up"], 10, "a flag that goes with its task")

    def test_acts_at_stated_times(self):
        code, said = run(TWO, "--for", "0.3 s", "--at", "0.1 s: off one", "--at", "0.2 s: clear one",
                         "--at", "0.25 s: off one")
        self.assertEqual(code, 0, said)
        self.assertRegex(said, r"\none   OFF ")
        self.assertRegex(said, r"\nrefused at 0\.\d+ s: clear one: .*OFF")
        self.assertNotIn(": off one", said, "that it is OFF already is no refusal")

    def test_values_beside_those_of_the_file(self):
        """From the start, and at a stated time; the manager knows them, too."""
        text = ("subsystem: subject\nconstants: {k: 2 N.m/rad}\ntasks:\n  gain: {rate: 100 Hz}\n"
                "operator: {x: 1 rad}\n")
        words = ("--set", "x", "2 rad", "--set", "k", "3 N.m/rad", "--at", "1.2 s: set x 180 deg", "--watch", "y",
                 "--every", "1 s")
        for isolation in ("process", "none"):
            with self.subTest(isolation):
                code, said = run(text, *words, "--for", "2.5 s", "--isolation", isolation, "--expect", "y > 9.4 N.m")
                self.assertEqual(code, 0, said)
                self.assertIn("t 1.000 s  y 6 m2.kg/s2\nt 2.000 s  y 9.42478 m2.kg/s2\n", said)
        with System(text, ("--priority", "0", *words)) as system:
            self.assertEqual(system.call("get", variables=["x"])["values"]["x"]["value"], 2)
            await_that(lambda: any(e["kind"] == "set" and e["text"] == "x = 3.14159 rad" for e in system.events()), 10,
                       "the event")
            self.assertEqual(system.call("save")["operator"], {"x": "3.141592653589793 rad"})
        code, said = run(text, "--at", "1 s: set k 3 N.m/rad")
        self.assertEqual(code, 2, said)
        self.assertIn("'k' is a constant, which nothing changes while tasks run; for the whole run: --set k VALUE\n",
                      said)

    def test_a_switch_is_done_in_one_process_and_in_several(self):
        text = ("subsystem: subject\ntasks:\n"
                "  slow: {component: gain, rate: 100 Hz, constants: {k: 2}}\n"
                "  fast: {component: gain, rate: 100 Hz, constants: {k: 3}, max_step: {y: 2 m}}\n"
                "operator: {x: 1 m}\nconfigurations: {gentle: [slow], quick: [fast]}\nstart: gentle\n")
        words = ("--for", "2 s", "--at", "0.1 s: switch quick")
        code, said = run(text, *words, "--isolation", "none", "--expect", "y >= 3 m")
        self.assertEqual(code, 0, said)
        self.assertRegex(said, r"\nswitch \d+ at \d\.\d+ s from 'gentle' to 'quick' after \d+\.\d+ ms: 1 task arrives, "
                               r"1 leaves, \d+ cycles? lost; y moves by 1 m, limit 2 m\n")
        self.assertRegex(said, r"\nslow  OFF .*\nfast  ON ")
        code, said = run(text, "--for", "2 s", "--at", "1 s: switch quick", "--expect", "y >= 3 m")
        self.assertEqual(code, 0, said)
        self.assertRegex(said, r"\nswitch \d+ at \d+\.\d+ s from 'gentle' to 'quick' after \d+\.\d+ ms: "
                               r"1 task arrives, 1 leaves, \d+ cycles? lost; y moves by 1 m, limit 2 m\n")
        for words in (("--isolation", "none"), ()):  # by name, they are those of `quick`
            code, said = run(text, *words, "--for", "2 s", "--at", "1 s: switch --on fast",
                             "--at", "1.2 s: switch --off fast")
            self.assertEqual(code, 0, said)
            self.assertRegex(said, r"\nswitch \d+ at \d+\.\d+ s from 'gentle' to 'quick' after \d+\.\d+ ms: 1 task ")
            self.assertRegex(said, r"\nrefused at 1\.\d+ s: switch --off fast: no task would be ON\n")
        text = "rtpus: {main: {cpu: 0, executor: preemptive}}\n" + text
        code, said = run(text, "--for", "2 s", "--at", "1 s: switch quick", "--expect", "y >= 3 m")
        self.assertEqual(code, 0, said)
        self.assertRegex(said, r"\nswitch \d+ at \d+\.\d+ s from 'gentle' to 'quick' after \d+\.\d+ ms: "
                               r"1 task arrives, 1 leaves, \d+ cycles? lost; y moves by 1 m, limit 2 m\n")

    def test_records_what_every_rtpu_does(self):
        words = ("--priority", "0", "--for", "1 s", "--trace", "trace.json", "--timeline", "10 ms")
        with System(TWO, words, wait=False) as system:
            self.assertEqual(system.process.wait(30), 0, system.said())
            events = json.loads((system.place / "trace.json").read_text())["traceEvents"]
            self.assertEqual({event["pid"] for event in events if event.get("name") == "cycle"}, {1, 2})
            self.assertIn("\nfirst:\n", system.said())
            self.assertIn("\nsecond:\n", system.said())

    def test_refuses_before_anything_starts(self):
        code, said = run(TWO, "--watch", "one_cont")
        self.assertEqual(code, 2, said)
        self.assertIn(": error: no state variable 'one_cont'; did you mean 'one_count'?\n", said)

    def test_one_process_takes_the_tasks_of_all_rtpus_in_one_loop(self):
        code, said = run(TWO, "--isolation", "none", "--for", "0.2 s")
        self.assertEqual(code, 0, said)
        self.assertRegex(said, r"\ntwo   ON ")
        self.assertIn("one process: all tasks in one loop, on the CPU and by the policy of 'first'", said)

    def test_a_start_that_fails_is_refused_in_the_words_of_its_task(self):
        text = ("subsystem: subject\ntasks:\n"
                "  bad: {component: t_thrower, constants: {where: init}}\n")
        code, said = run(text, "--for", "1 s")
        self.assertEqual(code, 1, said)
        self.assertRegex(said, r"\nbad: error: .*thrown on demand\n")

    def test_ctrl_c_ends_it_in_order(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number), System(TWO, ("--priority", "0")) as system:
                await_that(lambda: "second: WARNING: not real time" in system.said(), what="the face")
                system.process.send_signal(number)
                self.assertEqual(system.process.wait(20), 0, system.said())
                self.assertRegex(system.said(), r"ran \d+\.\d+ s, ended by the operator\n")
                self.assertRegex(system.said(), r"\none   ON ")
                system.await_nothing_left()

    def test_a_second_run_of_that_name_is_refused(self):
        with System(TWO, ("--priority", "0")) as system:
            environment = dict(system.environment, CHIMERA_TEST_MARK="none")
            second = subprocess.run([system.process.args[0], "run", str(system.file), "--priority", "0"],
                                    env=environment, capture_output=True, text=True, timeout=30)
            self.assertEqual(second.returncode, 1)
            self.assertIn(f"a subsystem 'subject' runs already (process {system.process.pid}): end it", second.stderr)
            self.assertEqual(system.state("one"), "ON")

    def test_the_death_of_the_manager_or_the_face_ends_nothing(self):
        with System(TWO, ("--priority", "0", "--for", "1.5 s", "--watch", "one_count", "--every", "0.5 s")) as system:
            system.kill(system.pids()["manager"])
            self.assertEqual(system.process.wait(30), 0, system.said())
            self.assertEqual(len(re.findall(r"\nt \d\.\d00 s  one_count \d+", system.said())), 3, system.said())
        with System(TWO, ("--priority", "0")) as system:
            face = next(pid for pid in system.left_over()
                        if b"attend" in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes())
            system.kill(face)
            await_that(lambda: face not in system.left_over())
            time.sleep(0.1)
            self.assertEqual(system.state("one"), "ON")

    def test_nobody_outlives_the_keeper(self):
        with System(TWO, ("--priority", "0")) as system:
            system.process.kill()
            system.process.wait()
            system.await_nothing_left()


if __name__ == "__main__":
    unittest.main()
