# SPDX-License-Identifier: Apache-2.0
"""What a fault of one real-time unit does to the others: nothing but what is declared. Bounded counts here; the same
with more of them is the campaign `process_faults`. CHIMERA_ROUNDS says how often each is repeated."""
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from system import BUILD, CHIMERA, UNITS, Client, Refused, System, await_that

ROUNDS = int(os.environ.get("CHIMERA_ROUNDS", "1"))

# `steady` and `reader` must never notice what happens to `victim`, which nobody needs.
APPLICATION = UNITS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  victim:
    component: t_crash
    rtpu: second
    rate: 200 Hz
    alias: {y: y_victim}
    constants: {where: WHERE, how: HOW}
    resources: {armed: ARMED}
  beside: {component: t_source, rtpu: second, rate: 100 Hz}
configurations:
  all: [steady, victim, beside]
start: all
"""

THROWER = UNITS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  thrower:
    component: t_thrower
    rtpu: second
    rate: 200 Hz
    alias: {count: n}
    constants: {where: WHERE, how: HOW, at: AT, times: 1, recovers: RECOVERS}
configurations:
  all: [steady, thrower]
start: all
"""


def filled(text, **words):
    for word, value in words.items():
        text = text.replace(word.upper(), str(value))
    return text


# The producer is in the middle of what it writes for half of the time.
WHOLE = UNITS + """
tasks:
  whole: {component: t_whole, rtpu: second, rate: 1 kHz, constants: {spend: 500000 ns}}
  judge: {component: t_judge, rtpu: first, rate: 1 kHz}
configurations: {all: [whole, judge]}
start: all
"""


class Faults(unittest.TestCase):
    injections = {}

    def count(self, kind, n=1):
        Faults.injections[kind] = Faults.injections.get(kind, 0) + n

    @classmethod
    def tearDownClass(cls):
        for kind, n in sorted(cls.injections.items()):
            print(f"{kind}: {n} injections", file=sys.stderr)

    def steady_goes_on(self, system, before):
        after = await_that(lambda: (t := system.task("steady"))["cycles"] > before["cycles"] + 10 and t, 5, "cycles")
        self.assertEqual(after["state"], "ON")
        self.assertEqual(after["incarnation"], before["incarnation"])
        self.assertEqual(after["faults"], 0)

    def await_successor(self, system, unit):
        await_that(lambda: system.rtpu("second")["incarnation"] > unit["incarnation"], 5, "a new incarnation")

    def test_row_5_a_unit_that_dies_is_seen_with_its_cause_and_restarted_with_what_was_on(self):
        ways = {"segv": "signal 11 (SIGSEGV)", "abort": "signal 6 (SIGABRT)", "bus": "signal 7 (SIGBUS)",
                "fpe": "signal 8 (SIGFPE)", "ill": "signal 4 (SIGILL)", "kill": "signal 9 (SIGKILL)",
                "stack": "signal 11 (SIGSEGV)", "exit": "42"}
        for how, words in ways.items():
            with self.subTest(how), System(filled(APPLICATION, where="cycle", how=how)) as system:
                for _ in range(ROUNDS):
                    before, unit = system.task("steady"), system.rtpu("second")
                    system.arm()
                    self.await_successor(system, unit)
                    system.disarm()
                    self.count(f"row 5 {how}")
                    system.await_state("victim", "ON", 15)
                    system.await_state("beside", "ON", 15)
                    self.steady_goes_on(system, before)
                told = [e["text"] for e in system.events() if e["kind"] == "rtpu-ended"]
                self.assertTrue(told)
                for text in told:
                    self.assertIn(words, text)
                    self.assertIn("victim.cycle", text)

    def test_a_unit_comes_back_with_the_code_that_was_verified_whatever_becomes_of_the_file(self):
        for what in ("removed", "not finished", "built anew"):
            with self.subTest(what), tempfile.TemporaryDirectory() as folder:
                for name in ("t_source.so", "t_source.component.json"):
                    shutil.copy(BUILD / "components" / name, folder)
                path = f"{folder}:{BUILD / 'components'}"
                text = filled(APPLICATION, where="cycle", how="none")
                with System(text, environment={"CHIMERA_PATH": path}) as system:
                    file, unit = pathlib.Path(folder, "t_source.so"), system.rtpu("second")
                    if what == "removed":
                        file.unlink()
                    elif what == "not finished":  # in place, as a linker writes
                        file.write_bytes(file.read_bytes()[:1000])
                    else:
                        shutil.copy(BUILD / "components" / "t_counter.so", file)
                    system.kill(unit["pid"])
                    self.await_successor(system, unit)
                    system.await_state("beside", "ON", 15)
                    self.count("restarts with another file", 1)

    def test_a_unit_that_dies_too_often_is_given_up_until_a_person_says_clear(self):
        with System(filled(APPLICATION, where="cycle", how="segv")) as system:
            system.arm()
            await_that(lambda: any(e["kind"] == "rtpu-given-up" for e in system.events()), 20, "giving up")
            self.assertEqual(system.state("victim"), "ERROR")
            self.assertEqual(system.state("beside"), "ERROR")
            restarts = [e for e in system.events() if e["kind"] == "rtpu-restarted"]
            self.assertEqual(len(restarts), 3)
            system.disarm()
            system.signal("clear", "victim")
            system.await_state("victim", "OFF")
            system.signal("on", "victim")
            system.await_state("victim", "ON")
            self.count("row 5 given up", 4)

    def test_row_6_a_unit_that_scribbles_over_its_memory_spoils_only_its_own(self):
        with System(filled(APPLICATION, where="cycle", how="scribble")) as system:
            for _ in range(ROUNDS):
                before, unit = system.task("steady"), system.rtpu("second")
                count = system.call("get", variables=["count"])["values"]["count"]["value"]
                system.arm()
                self.await_successor(system, unit)
                system.disarm()
                self.count("row 6 scribble")
                system.await_state("victim", "ON", 15)
                self.steady_goes_on(system, before)
                self.assertGreater(system.call("get", variables=["count"])["values"]["count"]["value"], count)
                self.assertTrue(system.call("hello")["manager"]["pid"])

    def test_rows_6_and_11_what_was_on_in_a_unit_that_scribbled_is_known_to_the_next_manager(self):
        with System(filled(APPLICATION, where="cycle", how="scribble")) as system:
            for _ in range(ROUNDS):
                before, unit, manager = system.task("steady"), system.rtpu("second"), system.pids()["manager"]
                self.assertTrue(system.kill(manager, signal.SIGSTOP))
                system.arm()
                await_that(lambda: unit["pid"] not in system.left_over(), 10, "the end of the unit")
                system.disarm()
                system.kill(manager)  # unless its keeper did: it was stopped for 1.5 s
                system.disconnect()
                self.count("rows 6 and 11")
                self.await_successor(system, unit)
                system.await_state("victim", "ON", 15)
                system.await_state("beside", "ON", 15)
                self.steady_goes_on(system, before)
                told = [e["text"] for e in system.events() if e["kind"] == "fault"]
                self.assertTrue([text for text in told if "memory cannot be read" in text], told)

    def test_rows_1_and_2_an_error_in_any_method_stays_with_its_task(self):
        for where in ("init", "on", "cycle", "off", "reinit", "kill"):
            for how in (1, 2, 3):
                at = 20 if where == "cycle" else 0
                text = filled(THROWER, where=where, how=how, at=at, recovers="false")
                with self.subTest(where=where, how=how), System(text, wait=False) as system:
                    self.count(f"row 1-2 {where}")
                    if where in ("init", "on"):  # the start is refused, in the words of the task
                        self.assertEqual(system.process.wait(20), 1)
                        self.assertIn(f"thrower: error: {where}: ", system.said())
                        continue
                    await_that(lambda: system.socket.exists(), 10, "the socket")
                    await_that(lambda: system.call("status")["tasks"][0]["state"] != "NOT-CREATED", 10, "the start")
                    if where in ("off", "reinit", "kill"):
                        system.await_state("thrower", "ON")
                        try:
                            system.signal(where, "thrower")
                        except Refused:
                            pass  # the words are judged by the unit tests
                    expected = "NOT-CREATED" if where == "kill" else "ERROR"
                    system.await_state("thrower", expected)
                    self.assertEqual([r["incarnation"] for r in system.call("status")["rtpus"]], [1, 1])
                    self.assertTrue(any(e["kind"] == "fault" and e["task"] == "thrower" for e in system.events()))

    def test_row_7_not_a_number_is_never_published(self):
        with System(filled(APPLICATION, where="cycle", how="nan")) as system:
            system.arm()
            system.await_state("victim", "ERROR")
            reading = system.call("get", variables=["y_victim"])["values"]["y_victim"]
            self.assertIsNotNone(reading["value"])
            self.assertGreaterEqual(system.task("victim")["rejected"], 1)
            self.count("row 7")

    def test_row_8_a_reader_of_a_producer_that_is_killed_sees_only_what_is_whole_and_never_older(self):
        for _ in range(7 * ROUNDS):
            with System(WHOLE) as system:
                before = system.task("judge")
                for _ in range(3):  # as often as a unit is restarted
                    time.sleep(random.random() * 0.02)
                    unit = system.rtpu("second")
                    self.assertTrue(system.kill(unit["pid"]))
                    self.await_successor(system, unit)
                    seen = system.call("get", variables=["seen"])["values"]["seen"]["value"]
                    await_that(lambda: system.call("get", variables=["seen"])["values"]["seen"]["value"] > seen + 5, 10,
                               "news of the next incarnation")
                    self.count("row 8 producer killed")
                judged = {name: reading["value"] for name, reading in
                          system.call("get", variables=["torn", "backward", "invalid"])["values"].items()}
                self.assertEqual(judged, {"torn": 0, "backward": 0, "invalid": 0})
                after = system.task("judge")
                self.assertEqual((after["state"], after["incarnation"]), ("ON", before["incarnation"]))

    def test_row_10_a_unit_killed_at_any_step_from_spawn_to_off_comes_back_or_is_told(self):
        for where in ("init", "on", "off", "kill"):
            with self.subTest(where), System(filled(APPLICATION, where=where, how="kill")) as system:
                before = system.task("steady")
                system.signal("off", "victim")
                system.signal("kill", "victim") if where in ("init",) else None
                if where in ("off",):
                    system.signal("on", "victim")
                system.arm()
                word = {"init": "spawn"}.get(where, where)
                with self.assertRaises(Refused):
                    system.signal(word, "victim")
                system.disarm()
                self.count(f"row 10 {where}")
                await_that(lambda: system.rtpu("second")["phase"] == "serving" and
                           system.state("victim") in ("OFF", "ON", "NOT-CREATED"), 15, "recovery")
                system.await_state("beside", "ON", 15)
                self.steady_goes_on(system, before)

    def manager_killed(self, system):
        """How long nobody answered, in seconds, and how many cycles all tasks together dropped meanwhile."""
        before = {t["task"]: t for t in system.call("status")["tasks"]}
        began = time.monotonic()
        system.kill(system.pids()["manager"])
        system.disconnect()
        system.call("status")
        took = time.monotonic() - began
        self.count("row 11 manager killed")
        for task in before:
            system.await_state(task, "ON", 5)
        status = system.call("status")
        for task in status["tasks"]:
            self.assertEqual(task["incarnation"], before[task["task"]]["incarnation"])
        return took, sum(task["dropped"] - before[task["task"]]["dropped"] for task in status["tasks"])

    def test_row_11_the_manager_may_die_at_any_moment(self):
        with System(filled(APPLICATION, where="cycle", how="segv")) as system:
            kills = 0
            for _ in range(3 * ROUNDS):
                # A machine that stalls costs cycles and time as well: then it is tried again. A manager that is needed
                # costs some each time. One that has lived for a second is followed without a pause.
                for _ in range(5):
                    kills += 1
                    took, dropped = self.manager_killed(system)
                    if dropped == 0 and took < 1:
                        break
                    time.sleep(1.2)
                self.assertEqual(dropped, 0, "cycles dropped while the manager was away")
                self.assertLess(took, 1, "picked up again within a second")
            numbers = [e["number"] for e in system.events()]
            self.assertEqual(numbers, sorted(set(numbers)))
            self.assertEqual(system.call("hello")["manager"]["starts"], kills + 1)

    def test_a_command_whose_connection_was_reset_is_sent_again_and_done_once(self):
        """docs/formats/control.md, "Limits": a request of which nothing was read can safely be sent again."""
        recorder = "{component: t_recorder, constants: {label: b}, alias: {x: level, y: z},"
        text = APPLICATION.replace("{component: t_source,", recorder)
        with System(text.replace("configurations:", "operator: {level: 1}\nconfigurations:")) as system:
            for n in range(1, 3 * ROUNDS + 1):
                manager, client = system.pids()["manager"], Client(system.socket)
                self.assertTrue(client.call("hello"))
                self.assertTrue(system.kill(manager, signal.SIGSTOP))
                client.socket.sendall(b'{"jsonrpc":"2.0","id":2,"method":"signal",'
                                      b'"params":{"signal":"reinit","tasks":["beside"]}}\n')
                system.kill(manager)  # unless its keeper did: it was stopped for 1.5 s
                with self.assertRaises(ConnectionResetError):
                    client.line()
                client.close()
                system.disconnect()
                system.signal("reinit", "beside")
                self.assertEqual([method for _, method, _ in system.lines()].count("reinit"), n)
                self.count("command sent again")

    def test_a_scope_keeps_what_it_recorded_when_the_manager_dies_and_says_that_it_ended(self):
        with System(filled(APPLICATION, where="cycle", how="segv")) as system:
            words = [str(CHIMERA), "scope", "count", "--for", "20 s"]
            for pause in (0.5, 2, 6):  # on a busy machine it begins late, and records of the next manager
                with subprocess.Popen(words, env=system.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                      text=True) as scope:
                    time.sleep(pause)
                    self.assertTrue(system.kill(system.pids()["manager"]))
                    try:
                        out, said = scope.communicate(timeout=8)
                    except subprocess.TimeoutExpired:
                        scope.kill()
                        out, said = scope.communicate()
                if len(out.splitlines()) > 10 and scope.returncode >= 0:
                    break
            self.assertEqual(scope.returncode, 1, said)
            self.assertIn("the recording ended early: the connection to the subsystem was lost\n", said)
            self.assertGreater(len(out.splitlines()), 10)

    def test_a_command_waits_for_a_manager_that_is_being_restarted(self):
        with System(filled(APPLICATION, where="cycle", how="segv")) as system:
            manager = system.pids()["manager"]
            system.kill(manager)
            client = Client(system.socket)
            client.call("signal", signal="off", tasks=["victim"])
            client.close()
            self.assertEqual(system.state("victim"), "OFF")
            self.count("command without a manager")


if __name__ == "__main__":
    unittest.main(verbosity=1)
