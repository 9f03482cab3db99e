# SPDX-License-Identifier: Apache-2.0
"""A standby takes over in real processes, with and without a manager. The campaign `process_standby` kills at random."""
import signal
import sys
import unittest

from descriptions import DEVICE_STANDBY, STANDBY
from system import RTPUS, Refused, System, await_that, duration

# The reader in the second rtpu reports that what comes from the first is too old.
STALE = RTPUS + """
tasks:
  live:
    {component: signal_generator, rtpu: first, rate: 100 Hz, alias: {y: x},
     constants: {amplitude: 0 m/s, offset: 1 m/s}}
  reader: {component: t_ages, rtpu: second, rate: 100 Hz, stale_after: 100 ms}
configurations: {all: [live, reader]}
start: all
"""


class Standby(unittest.TestCase):
    def takeovers(self, system, n):
        """The receipts of takeovers, once there are n."""
        def filed():
            return [each for each in system.call("receipts")["receipts"] if each["way"] == "takeover"]
        await_that(lambda: len(filed()) >= n, f"{n} receipts of takeovers")
        return filed()

    def take_over(self, system, *who):
        pids = system.pids()
        for name in who:
            self.assertTrue(system.kill(pids[name]))
        system.await_state("spare", "ON")
        system.await_value("seen", 3)

    def switch_back(self, system):
        receipt = system.call("switch", configuration="run")
        self.assertEqual((receipt["end"], receipt["reason"]), ("done", None))
        system.await_value("seen", 2)

    def test_from_a_process_that_dies(self):
        with System(STANDBY) as system:
            system.await_value("seen", 2)
            self.take_over(system, "first")
            system.await_state("main", "OFF")  # its process is restarted, and it stays OFF
            self.assertEqual(system.call("status")["configuration"], "run with spare for main")
            self.assertIn("took over from 'main'", str(system.texts("note")))
            receipt, = self.takeovers(system, 1)
            self.assertEqual(receipt["asked_by"],
                             {"reaction": "standby_for", "lost": "main", "by": "death", "task": "spare"})
            self.assertEqual([receipt[key] for key in ("number", "from", "to", "end")], [1, "run", "run", "done"])
            variable, = receipt["variables"]
            self.assertEqual([variable[key] for key in ("variable", "from", "to", "step", "unit")],
                             ["wanted", "main", "spare", 1, "m/s"])
            self.assertEqual({task["task"] for task in receipt["tasks"]}, {"spare", "main"})
            duration("under the flag in a takeover", receipt["flag_ns"] / 1e9)
            print(f"cycles lost in a takeover: {sum(task['lost'] for task in receipt['tasks'])}", file=sys.stderr)
            with self.assertRaises(Refused):
                system.signal("on", "main")
            self.switch_back(system)
            self.assertEqual(system.call("status")["configuration"], "run")

    def test_with_what_it_reads(self):
        """The producer of the standby's input dies with the primary, and comes back; the primary does not."""
        with System(STANDBY.replace("signal_generator, rtpu: second", "signal_generator, rtpu: first")) as system:
            system.await_value("seen", 2)
            self.take_over(system, "first")
            system.await_state("reference", "ON")
            system.await_state("main", "OFF")
            await_that(lambda: not system.call("status")["flag"]["up"], "the flag to be down")

    def test_while_the_manager_is_dead(self):
        with System(STANDBY) as system:
            system.await_value("seen", 2)
            self.take_over(system, "manager", "first")
            system.await_state("main", "OFF")
            receipt, = self.takeovers(system, 1)  # by the next manager
            self.assertEqual((receipt["number"], receipt["end"]), (1, "done"))

    def test_the_primary_stands_in_for_its_standby(self):
        with System(STANDBY) as system:
            self.take_over(system, "first")
            system.await_state("main", "OFF")
            self.assertTrue(system.kill(system.pids()["second"]))
            system.await_state("main", "ON")
            system.await_state("user", "ON")
            self.assertEqual([(each["number"], each["asked_by"]["task"]) for each in self.takeovers(system, 2)],
                             [(1, "spare"), (2, "main")])
            system.await_value("seen", 2)
            system.await_state("spare", "OFF")

    def test_a_hot_one_cycles_unread(self):
        with System(STANDBY.replace("standby_for: main", "standby_for: {task: main, hot: true}")) as system:
            system.await_value("seen", 2)
            system.await_cycles("spare")
            self.assertEqual(system.state("spare"), "OFF")
            self.assertEqual(system.call("status")["configuration"], "run")
            self.take_over(system, "manager", "first")
            system.await_state("main", "OFF")
            self.switch_back(system)
            system.await_cycles("spare")
            self.assertEqual(system.state("spare"), "OFF")

    def test_a_primary_that_is_silent_is_killed_before_it_is_replaced(self):
        with System(STANDBY.replace("standby_for: main", "standby_for: {task: main, stale_after: 1 s}")) as system:
            system.await_value("seen", 2)
            pid = system.pids()["first"]
            self.assertTrue(system.kill(pid, signal.SIGSTOP))
            system.await_state("spare", "ON")
            self.assertFalse(system.kill(pid, signal.SIGCONT), "it is dead")
            system.await_value("seen", 3)
            words = "published nothing for as long as `stale_after` of its standby says"
            await_that(lambda: [e for e in system.events() if e["text"].startswith(words) and
                                e["text"].endswith(": its real-time unit is ended")], "the event")
            system.await_state("main", "OFF")  # of its successor
            system.await_state("reference", "ON")
            self.assertEqual(system.value("seen"), 3)
            self.switch_back(system)

    def test_a_standby_opens_the_device_that_the_kernel_closed(self):
        with System(DEVICE_STANDBY) as system:
            system.await_value("seen", 1)
            self.assertTrue(system.kill(system.pids()["first"]))
            system.await_value("seen", 2)
            await_that(lambda: system.rtpu("first")["phase"] == "serving", "the rtpu of the primary")
            self.assertEqual((system.state("hand"), system.state("drill")), ("NOT-CREATED", "ON"))
            self.assertNotIn("another user", str(system.events()))

    def test_an_input_that_is_too_old_is_not_valid(self):
        """Its producer is stopped and goes on, and is killed and comes back."""
        with System(STALE) as system:
            def valid():
                values = system.call("get", variables=["valid", "age"])["values"]
                return values["valid"]["value"], values["age"]["value"] >= 0
            await_that(lambda: valid() == (True, True), "a value")
            pid = system.pids()["first"]
            self.assertTrue(system.kill(pid, signal.SIGSTOP))
            await_that(lambda: valid() == (False, False), "a value that is too old")
            self.assertTrue(system.kill(pid, signal.SIGCONT))
            await_that(lambda: valid() == (True, True), "a value of the one that goes on")
            self.assertTrue(system.kill(pid))
            system.await_state("live", "ON")
            await_that(lambda: valid() == (True, True), "a value of the one that came back")
            self.assertEqual(system.state("reader"), "ON")


if __name__ == "__main__":
    unittest.main()
