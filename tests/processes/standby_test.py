# SPDX-License-Identifier: Apache-2.0
"""A standby takes over in real processes, whoever dies, with and without a manager. A bounded count here; more of them
are the campaign `process_standby`. CHIMERA_ROUNDS: kills at random."""
import os
import random
import signal
import sys
import time
import unittest

from system import Refused, System, UNITS, await_that

ROUNDS = int(os.environ.get("CHIMERA_ROUNDS", "1"))
SEED = int(os.environ.get("CHIMERA_SEED", str(random.SystemRandom().randrange(1 << 32))))

# `wanted` comes from a task of the first unit or from its standby in the second one; it is read in the second.
TEXT = UNITS + """
tasks:
  reference:
    {component: signal_generator, rtpu: second, rate: 100 Hz, alias: {y: vref},
     constants: {amplitude: 0 m/s, offset: 1 m/s}}
  main: {component: gain, rtpu: first, rate: 100 Hz, alias: {x: vref, y: wanted}, constants: {k: 2}}
  spare: {component: gain, rtpu: second, rate: 50 Hz, alias: {x: vref, y: wanted}, constants: {k: 3}, standby_for: main}
  user: {component: gain, rtpu: second, rate: 100 Hz, alias: {x: wanted, y: seen}, constants: {k: 1}}
configurations: {run: [reference, main, user]}
"""


# The reader in the second unit is told that what comes from the first is too old.
STALE = UNITS + """
tasks:
  live:
    {component: signal_generator, rtpu: first, rate: 100 Hz, alias: {y: x},
     constants: {amplitude: 0 m/s, offset: 1 m/s}}
  reader: {component: t_ages, rtpu: second, rate: 100 Hz, stale_after: 100 ms}
configurations: {all: [live, reader]}
start: all
"""


class Standby(unittest.TestCase):
    def await_seen(self, system, value):
        await_that(lambda: system.call("get", variables=["seen"])["values"]["seen"]["value"] == value, 5,
                   f"the reader to see {value}")

    def flags(self, system, since):
        return [event for event in system.events() if event["kind"] == "flag" and event["at_ns"] > since
                and "up" in event["text"]]

    def receipts(self, system, n):
        """The receipts of this run, when there are so many."""
        def filed():
            return [each for each in system.call("receipts")["receipts"] if each["way"] == "takeover"]
        await_that(lambda: len(filed()) >= n, 5, f"{n} receipts of takeovers")
        return filed()

    def take_over(self, system, *who):
        pids = system.pids()
        for name in who:
            self.assertTrue(system.kill(pids[name]))
        system.await_state("spare", "ON")
        self.await_seen(system, 3)

    def test_from_a_process_that_dies(self):
        """A machine that stalls costs cycles, and time under the flag, as well: then it is tried again."""
        costs = []
        while not costs or (costs[-1] != (0, 0, 0) and len(costs) < 5):
            costs.append(self.from_a_process_that_dies())
        self.assertEqual(costs[-1], (0, 0, 0), f"flags, nanoseconds under the flag, lost cycles: {costs}")

    def from_a_process_that_dies(self):
        with System(TEXT) as system:
            self.await_seen(system, 2)
            started = system.call("status")["started_ns"]
            self.take_over(system, "first")
            system.await_state("main", "OFF")  # its process is restarted, and it stays OFF
            self.assertEqual(system.call("status")["configuration"], "run with spare for main")
            self.assertIn("took over from 'main'", str([e["text"] for e in system.events() if e["kind"] == "note"]))
            receipt, = self.receipts(system, 1)
            self.assertEqual(receipt["asked_by"],
                             {"reaction": "standby_for", "lost": "main", "by": "death", "task": "spare"})
            self.assertEqual([receipt[key] for key in ("number", "from", "to", "end")], [1, "run", "run", "done"])
            variable, = receipt["variables"]
            self.assertEqual([variable[key] for key in ("variable", "from", "to", "step", "unit")],
                             ["wanted", "main", "spare", 1, "m/s"])
            self.assertEqual({task["task"] for task in receipt["tasks"]}, {"spare", "main"})
            cost = receipt["flag_ns"], sum(task["lost"] for task in receipt["tasks"])
            with self.assertRaises(Refused):
                system.signal("on", "main")
            receipt = system.call("switch", configuration="run")  # back, by a person
            self.assertEqual((receipt["from"], receipt["end"], receipt["reason"]), ("run", "done", None))
            self.await_seen(system, 2)
            self.assertEqual(system.call("status")["configuration"], "run")
            return len(self.flags(system, started)), *cost

    def test_with_what_it_reads(self):
        """The producer of the standby's input dies with the primary, and comes back where the primary does not."""
        with System(TEXT.replace("signal_generator, rtpu: second", "signal_generator, rtpu: first")) as system:
            self.await_seen(system, 2)
            self.take_over(system, "first")
            system.await_state("reference", "ON")
            system.await_state("main", "OFF")
            await_that(lambda: not system.call("status")["flag"]["up"], 10, "the flag to be down")

    def test_while_the_manager_is_dead(self):
        with System(TEXT) as system:
            self.await_seen(system, 2)
            self.take_over(system, "manager", "first")
            system.await_state("main", "OFF")
            receipt, = self.receipts(system, 1)  # by the next manager
            self.assertEqual((receipt["number"], receipt["end"]), (1, "done"))

    def test_the_primary_stands_in_for_its_standby(self):
        with System(TEXT) as system:
            self.take_over(system, "first")
            system.await_state("main", "OFF")
            self.assertTrue(system.kill(system.pids()["second"]))
            system.await_state("main", "ON")
            await_that(lambda: system.state("user") == "ON", 10, "the reader is back")
            self.assertEqual([(each["number"], each["asked_by"]["task"]) for each in self.receipts(system, 2)],
                             [(1, "spare"), (2, "main")])
            self.await_seen(system, 2)
            system.await_state("spare", "OFF")

    def test_a_hot_one_cycles_unread(self):
        """As above, a stall may raise the flag."""
        self.assertTrue(any(self.a_hot_one_cycles_unread() == 0 for _ in range(5)), "the flag was up each time")

    def a_hot_one_cycles_unread(self):
        with System(TEXT.replace("standby_for: main", "standby_for: {task: main, hot: true}")) as system:
            self.await_seen(system, 2)
            await_that(lambda: system.task("spare")["cycles"] > 10, 5, "its cycles")
            self.assertEqual(system.state("spare"), "OFF")
            self.assertEqual(system.call("status")["configuration"], "run")
            started = system.call("status")["started_ns"]
            self.take_over(system, "manager", "first")
            flags = len(self.flags(system, started))
            system.await_state("main", "OFF")
            receipt = system.call("switch", configuration="run")
            self.assertEqual((receipt["end"], receipt["reason"]), ("done", None))
            self.await_seen(system, 2)
            cycles = system.task("spare")["cycles"]
            await_that(lambda: system.task("spare")["cycles"] > cycles + 5, 5, "its cycles beside the one that is back")
            self.assertEqual(system.state("spare"), "OFF")
            return flags

    def test_a_primary_that_is_silent_is_killed_before_it_is_replaced(self):
        """Its process is stopped; when it resumes in time nothing happens, when it would later it is dead."""
        random.seed(SEED)
        print(f"seed {SEED}", file=sys.stderr)
        text = TEXT.replace("standby_for: main", "standby_for: {task: main, stale_after: 1 s}")
        with System(text) as system:
            self.await_seen(system, 2)
            for rounds in range(ROUNDS):
                pid, since = system.pids()["first"], system.call("events", since=0)["last"]
                self.assertTrue(system.kill(pid, signal.SIGSTOP))
                time.sleep(random.random() * 0.08)
                self.assertTrue(system.kill(pid, signal.SIGCONT))
                time.sleep(0.1)
                self.assertEqual((system.state("main"), system.state("spare")), ("ON", "OFF"))
                stopped = time.monotonic()
                self.assertTrue(system.kill(pid, signal.SIGSTOP))
                system.await_state("spare", "ON")
                self.assertGreater(time.monotonic() - stopped, 0.5)
                self.assertFalse(system.kill(pid, signal.SIGCONT), "it is dead")
                self.await_seen(system, 3)
                words = "published nothing for as long as `stale_after` of its standby says"
                await_that(lambda: [e for e in system.events(since + 1) if e["text"].startswith(words) and
                                    e["text"].endswith(": its real-time unit is ended")], 5, "the event")
                system.await_state("main", "OFF")  # of its successor
                await_that(lambda: system.state("reference") == "ON", 10, "the reference")
                self.assertEqual(system.call("get", variables=["seen"])["values"]["seen"]["value"], 3)
                self.assertEqual(system.call("switch", configuration="run")["end"], "done")
                self.await_seen(system, 2)
                time.sleep(4 if rounds + 1 < ROUNDS else 0)  # three deaths in 10 s and a unit is given up
        print(f"stops: {2 * ROUNDS}", file=sys.stderr)

    def test_an_input_that_is_too_old_is_not_valid(self):
        """Its producer is stopped and goes on, and is killed and comes back."""
        with System(STALE) as system:
            def valid():
                values = system.call("get", variables=["valid", "age"])["values"]
                return values["valid"]["value"], values["age"]["value"] >= 0
            await_that(lambda: valid() == (True, True), 5, "a value")
            pid = system.pids()["first"]
            self.assertTrue(system.kill(pid, signal.SIGSTOP))
            await_that(lambda: valid() == (False, False), 5, "a value that is too old")
            self.assertTrue(system.kill(pid, signal.SIGCONT))
            await_that(lambda: valid() == (True, True), 5, "a value of the one that goes on")
            self.assertTrue(system.kill(pid))
            system.await_state("live", "ON", 20)
            await_that(lambda: valid() == (True, True), 5, "a value of the one that came back")
            self.assertEqual(system.task("reader")["state"], "ON")

    def test_whoever_dies_one_of_them_is_on(self):
        """One or two of all are killed, the second at any moment of the take-over from the first."""
        random.seed(SEED)
        print(f"seed {SEED}", file=sys.stderr)
        kills, last = 0, {}
        with System(TEXT) as system:
            for _ in range(ROUNDS):
                victims = []
                while not victims:  # three deaths in 10 s and a unit is given up
                    free = [who for who in ("first", "second", "manager") if time.monotonic() - last.get(who, 0) > 5.2]
                    victims = random.sample(free, min(len(free), random.choice((1, 2, 2))))
                    time.sleep(0.05)
                pids, pause = system.pids(), random.choice((0, 0.0005, 0.002, 0.01))
                for name in victims:
                    kills += system.kill(pids[name])
                    last[name] = time.monotonic()
                    time.sleep(random.random() * pause)
                self.judge(system, f"killed {victims}")
        print(f"kills: {kills}", file=sys.stderr)

    def judge(self, system, what):
        def one_is_on():
            states = self.states(system)
            on = [name for name in ("main", "spare") if states[name] == "ON"]
            if len(on) == 2:  # a death of which the manager has not read yet is seen for a moment
                time.sleep(0.5)
                again = self.states(system)
                self.assertFalse(again["main"] == again["spare"] == "ON", what)
                return False
            return len(on) == 1 and states["user"] == states["reference"] == "ON"
        try:
            await_that(one_is_on, 20, f"one of them to be ON ({what})")
        except AssertionError as error:
            raise AssertionError(f"{error}: {self.states(system)}") from None

        def seen_is_of_who_is_on():  # by states of one answer: a death that is not told yet is judged when it is
            states, seen = self.states(system), system.call("get", variables=["seen"])["values"]["seen"]["value"]
            return states == self.states(system) and seen == (2 if states["main"] == "ON" else 3)
        try:
            await_that(seen_is_of_who_is_on, 10, f"the reader to see who is ON ({what})")
        except AssertionError as error:
            seen = system.call("get", variables=["seen"])["values"]["seen"]
            raise AssertionError(f"{error}: {seen}, {self.states(system)}") from None

    @staticmethod
    def states(system):
        return {task["task"]: task["state"] for task in system.call("status")["tasks"]}


if __name__ == "__main__":
    unittest.main()
