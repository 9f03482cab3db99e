# SPDX-License-Identifier: Apache-2.0
"""A fault of one rtpu has only its declared effects on others. The manager dies, too. Decisions about deaths:
tests/stepped/deaths_test.cc."""
import pathlib
import shutil
import signal
import subprocess
import tempfile
import unittest

from system import BUILD, CHIMERA, HANG, RTPUS, Client, System, await_that, duration

# No other task needs `victim`; `steady` must not notice its faults.
APPLICATION = RTPUS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  victim:
    component: t_crash
    rtpu: second
    rate: 200 Hz
    alias: {y: y_victim}
    constants: {where: cycle, how: HOW}
    resources: {armed: ARMED}
  beside: {component: t_source, rtpu: second, rate: 100 Hz}
configurations:
  all: [steady, victim, beside]
start: all
"""

WAYS = {"segv": "signal 11 (SIGSEGV)", "abort": "signal 6 (SIGABRT)", "bus": "signal 7 (SIGBUS)",
        "fpe": "signal 8 (SIGFPE)", "ill": "signal 4 (SIGILL)", "kill": "signal 9 (SIGKILL)",
        "stack": "signal 11 (SIGSEGV)", "exit": "42"}


def one_rtpu_for_each_way():
    rtpus = "".join(f"  {way}: {{cpu: 1, policy: edf}}\n" for way in WAYS)
    tasks = "".join(f"  v_{way}: {{component: t_crash, rtpu: {way}, rate: 200 Hz, alias: {{y: y_{way}}}, "
                    f"constants: {{where: cycle, how: {way}}}, resources: {{armed: ARMED-{way}}}}}\n" for way in WAYS)
    names = ", ".join(["steady", *(f"v_{way}" for way in WAYS)])
    return (f"subsystem: subject\nrtpus:\n  first: {{cpu: 0, policy: edf}}\n{rtpus}tasks:\n"
            f"  steady: {{component: t_counter, rtpu: first, rate: 200 Hz}}\n{tasks}"
            f"configurations: {{all: [{names}]}}\nstart: all\n")


class Faults(unittest.TestCase):
    def steady_goes_on(self, system, before):
        after = system.await_cycles("steady")
        self.assertEqual((after["state"], after["incarnation"], after["faults"]), ("ON", before["incarnation"], 0))

    def test_row_5_a_dead_rtpu_is_reported_with_its_cause_and_restarted_with_its_tasks(self):
        with System(one_rtpu_for_each_way()) as system:
            before = system.task("steady")
            for way, words in WAYS.items():
                unit, armed = system.rtpu(way), system.armed.with_name(f"{system.armed.name}-{way}")
                armed.write_text("")
                event = system.await_event(0, "rtpu-ended", rtpu=way)
                armed.unlink()
                self.assertIn(words, event["text"])
                self.assertIn(f"v_{way}.cycle", event["text"])
                system.await_restart(way, unit)
                system.await_state(f"v_{way}", "ON")
            self.steady_goes_on(system, before)

    def test_an_rtpu_comes_back_with_the_code_that_was_verified_if_the_file_is_another(self):
        for what in ("removed", "not finished", "built anew"):
            with self.subTest(what), tempfile.TemporaryDirectory() as folder:
                for name in ("t_source.so", "t_source.component.json"):
                    shutil.copy(BUILD / "components" / name, folder)
                path = f"{folder}:{BUILD / 'components'}"
                text = APPLICATION.replace("HOW", "none")
                with System(text, environment={"CHIMERA_PATH": path}) as system:
                    file, unit = pathlib.Path(folder, "t_source.so"), system.rtpu("second")
                    if what == "removed":
                        file.unlink()
                    elif what == "not finished":  # in place, as a linker writes
                        file.write_bytes(file.read_bytes()[:1000])
                    else:
                        shutil.copy(BUILD / "components" / "t_counter.so", file)
                    system.kill(unit["pid"])
                    system.await_restart("second", unit)
                    system.await_state("beside", "ON")

    def test_row_6_an_rtpu_that_scribbles_over_its_memory_spoils_only_its_own(self):
        with System(APPLICATION.replace("HOW", "scribble")) as system:
            before, unit, count = system.task("steady"), system.rtpu("second"), system.value("count")
            system.arm()
            system.await_restart("second", unit)
            system.disarm()
            system.await_state("victim", "ON")
            self.steady_goes_on(system, before)
            self.assertGreater(system.value("count"), count)
            self.assertTrue(system.call("hello")["manager"]["pid"])

    def test_rows_6_and_11_the_next_manager_knows_the_tasks_of_an_rtpu_that_scribbled(self):
        with System(APPLICATION.replace("HOW", "scribble")) as system:
            before, unit, manager = system.task("steady"), system.rtpu("second"), system.pids()["manager"]
            self.assertTrue(system.kill(manager, signal.SIGSTOP))
            system.arm()
            await_that(lambda: unit["pid"] not in system.left_over(), "the end of the rtpu")
            system.disarm()
            system.kill(manager)  # unless its keeper did: it kills a manager that is stopped
            system.disconnect()
            system.await_restart("second", unit)
            system.await_state("victim", "ON")
            system.await_state("beside", "ON")
            self.steady_goes_on(system, before)
            self.assertIn("memory cannot be read", str(system.texts("fault")))

    def test_row_11_the_manager_may_die(self):
        with System(APPLICATION.replace("HOW", "segv")) as system:
            before = {t["task"]: t["incarnation"] for t in system.call("status")["tasks"]}
            for kills in (1, 2):
                manager, since = system.pids()["manager"], system.call("status")["now_ns"]
                self.assertTrue(system.kill(manager))
                system.disconnect()
                after = system.call("status")
                duration("until another manager answers", (after["now_ns"] - since) / 1e9)
                self.assertEqual({t["task"]: t["incarnation"] for t in after["tasks"]}, before)
                for task in before:
                    system.await_state(task, "ON")
                self.assertEqual(system.call("hello")["manager"]["starts"], kills + 1)
                system.await_cycles("steady")
            numbers = [e["number"] for e in system.events()]
            self.assertEqual(numbers, sorted(set(numbers)))

    def test_a_command_whose_connection_was_reset_is_sent_again_and_done_once(self):
        """docs/formats/control.md, "Limits": a request of which nothing was read can safely be sent again."""
        recorder = "{component: t_recorder, constants: {label: b}, alias: {x: level, y: z},"
        text = APPLICATION.replace("{component: t_source,", recorder)
        with System(text.replace("configurations:", "operator: {level: 1}\nconfigurations:")) as system:
            manager, client = system.pids()["manager"], Client(system.socket)
            self.assertTrue(client.call("hello"))
            self.assertTrue(system.kill(manager, signal.SIGSTOP))
            client.socket.sendall(b'{"jsonrpc":"2.0","id":2,"method":"signal",'
                                  b'"params":{"signal":"reinit","tasks":["beside"]}}\n')
            system.kill(manager)  # unless its keeper did: it kills a manager that is stopped
            with self.assertRaises(ConnectionResetError):
                client.line()
            client.close()
            system.disconnect()
            system.signal("reinit", "beside")
            self.assertEqual([method for _, method, _ in system.lines()].count("reinit"), 1)

    def test_a_scope_keeps_its_rows_when_the_manager_dies_and_reports_its_end(self):
        with System(APPLICATION.replace("HOW", "segv")) as system:
            system.await_cycles("steady", 20)
            words = ("scope", "count", "--trigger", "cycles < 10", "--pre", "10 ms", "--for", "600 s")
            with subprocess.Popen([str(CHIMERA), *words], env=system.environment, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True) as scope:
                self.assertTrue(any("recording the pre-trigger" in line for line in scope.stderr), "no subscription")
                system.await_cycles("steady", 50)
                system.signal("off", "steady")
                system.signal("on", "steady")  # the trigger: it counts from 0 again
                system.await_cycles("steady", 100)
                self.assertTrue(system.kill(system.pids()["manager"]))
                out, said = scope.communicate(timeout=HANG)
            self.assertEqual(scope.returncode, 1, said)
            self.assertIn("the recording ended early: the connection to the subsystem was lost\n", said)
            self.assertGreater(len(out.splitlines()), 10)

    def test_a_command_waits_for_a_manager_that_is_being_restarted(self):
        with System(APPLICATION.replace("HOW", "segv")) as system:
            system.kill(system.pids()["manager"])
            client = Client(system.socket)
            client.call("signal", signal="off", tasks=["victim"])
            client.close()
            self.assertEqual(system.state("victim"), "OFF")


if __name__ == "__main__":
    unittest.main(verbosity=1)
