# SPDX-License-Identifier: Apache-2.0
"""Requests and reactions of tasks over real processes: carried out by the manager, or by the one that follows it; and
`safe_when`, which holds a switch up."""
import os
import random
import signal
import sys
import threading
import time
import unittest

from system import Client, Refused, System, UNITS, await_that

ROUNDS = int(os.environ.get("CHIMERA_ROUNDS", "1"))
SEED = int(os.environ.get("CHIMERA_SEED", str(random.SystemRandom().randrange(1 << 32))))

# `asker` of the second unit asks for what the operator variable `wish` says.
TEXT = UNITS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 100 Hz}
  asker: {component: t_asker, rtpu: second, rate: 100 Hz, constants: {first: low, second: high}}
  one: {component: gain, rtpu: first, rate: 100 Hz, alias: {x: given, y: level}, constants: {k: 1}}
  two: {component: gain, rtpu: second, rate: 100 Hz, alias: {x: given, y: level}, constants: {k: 1}}
  reader: {component: gain, rtpu: first, rate: 100 Hz, alias: {x: level, y: seen}, constants: {k: 1}}
operator: {wish: 0, given: 5}
configurations:
  low: [steady, asker, one, reader]
  high: {tasks: [steady, asker, two, reader], safe_when: 'seen < 8'}
start: low
"""
LISTS = TEXT.replace("{first: low, second: high}", "{first: --on one, second: --on two --off one}")
PREEMPTIVE = TEXT.replace("policy: edf}", "policy: edf, executor: preemptive}")
MIXED = TEXT.replace("cpu: 1, policy: edf}", "cpu: 1, policy: edf, executor: preemptive}")
SETS = {"low": {"steady", "asker", "one", "reader"}, "high": {"steady", "asker", "two", "reader"}}

# The task that fails is left behind, in the other unit than its reader.
FAILS = UNITS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 100 Hz, alias: {count: counted}}
  thrower:
    component: t_thrower
    rtpu: second
    rate: 100 Hz
    constants: {where: cycle, how: 3, at: 100, recovers: false}
    on_fault: REACTION
  beside: {component: t_source, rtpu: second, rate: 100 Hz}
configurations:
  all: [steady, thrower, beside]
  less: [steady]
start: all
"""


# The task of the second unit uses up to 9 ms of each 10.
LATE = UNITS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 100 Hz}
  bad: {component: t_overrun, rtpu: second, rate: 100 Hz, constants: {allowed: 3000000 ns}, REACTION}
configurations:
  all: [steady, bad]
  less: [steady]
start: all
"""


def on(system):
    return {task["task"] for task in system.call("status")["tasks"] if task["state"] == "ON"}


def set_to(system, **values):
    system.call("set", values=values)


def told(system, kind="switch"):
    return [event["text"] for event in system.events() if event["kind"] == kind]


class Requests(unittest.TestCase):
    def await_set(self, system, name, limit=10):
        await_that(lambda: on(system) == SETS[name], limit, f"{name}; {on(system)}; {told(system)}")

    def await_less(self, system):
        try:
            await_that(lambda: on(system) == {"steady"}, 10, "less")
        except AssertionError as failure:
            states = [(task["task"], task["state"]) for task in system.call("status")["tasks"]]
            events = [f"{event['kind']}: {event['text']}" for event in system.events()]
            raise AssertionError(f"{failure}: {states}, {system.call('receipts')['receipts']}, {events}") from None

    def test_a_task_asks_and_is_named(self):
        for text in (TEXT, MIXED, PREEMPTIVE, LISTS):
            with self.subTest(preemptive=text.count("executor: preemptive"), lists=text.count("--on")):
                self.a_task_asks_and_is_named(text)

    def a_task_asks_and_is_named(self, text):
        with System(text) as system:
            set_to(system, wish=2)
            self.await_set(system, "high")
            set_to(system, wish=1)
            self.await_set(system, "low")
            time.sleep(0.3)  # thirty cycles that ask for what is in force
            lines = told(system)
            self.assertEqual(sum("asked for by task asker: begun" in line for line in lines), 2, lines)
            self.assertTrue(any("by task asker from 'low' to 'high'" in line for line in lines), lines)
            self.assertEqual(system.call("get", variables=["refused"])["values"]["refused"]["value"], 0)
            receipts = await_that(lambda: (filed := system.call("receipts")["receipts"])[1:] and filed, 5,
                                  "two receipts")
            self.assertEqual([(one["to"], one["end"], one["asked_by"]) for one in receipts],
                             [("high", "done", {"task": "asker"}), ("low", "done", {"task": "asker"})])

    def test_tasks_that_are_no_legal_set_are_refused_by_name(self):
        with System(LISTS.replace("--on two --off one", "--off one two")) as system:
            set_to(system, wish=2)
            await_that(lambda: told(system), 5, "the refusal")
            self.assertEqual(told(system)[0], "switch --off one two, asked for by task asker, is refused: "
                                              "level would have no producer")
            set_to(system, wish=1)  # in force
            def is_silent():  # a refusal is told ten times a second
                n = len(told(system))
                time.sleep(0.5)
                return len(told(system)) == n
            await_that(is_silent, 5, "the end of the refusals")
            self.assertEqual((on(system), system.call("receipts")["receipts"]), (SETS["low"], []))

    def test_safe_when_holds_it_up_and_is_told_by_name(self):
        with System(TEXT) as system:
            set_to(system, given=9)
            await_that(lambda: system.call("get", variables=["seen"])["values"]["seen"]["value"] == 9, 5, "seen")
            for _ in range(3):  # a unit that stalls at the deadline gives no reason
                receipt = system.call("switch", configuration="high", wait_ms=300)
                if receipt["reason"] == "not-safe":
                    break
            self.assertEqual((receipt["end"], receipt["reason"]), ("aborted", "not-safe"))
            self.assertEqual(receipt["why"], "'seen' is 9, and safe_when of 'high' asks for seen < 8")
            self.assertEqual(on(system), SETS["low"])
            answers = []

            def ask():
                client = Client(system.socket, 30)
                answers.append(client.call("switch", configuration="high"))
                client.close()

            asking = threading.Thread(target=ask)
            asking.start()
            time.sleep(0.3)
            self.assertEqual(on(system), SETS["low"])
            set_to(system, given=5)
            asking.join(10)
            self.assertEqual(answers[0]["end"], "done", answers)
            self.assertEqual(on(system), SETS["high"])

    def test_a_wish_waits_for_the_next_manager(self):
        """The manager is killed around the instant at which a task begins to ask."""
        random.seed(SEED)
        print(f"seed {SEED}", file=sys.stderr)
        with System(TEXT) as system:
            present = "low"
            for _ in range(ROUNDS):
                target = "high" if present == "low" else "low"
                pid = system.pids()["manager"]
                delay = random.random() * 0.03
                killer = threading.Thread(target=lambda: (time.sleep(delay), system.kill(pid)))
                killer.start()
                try:
                    set_to(system, wish=2 if target == "high" else 1)
                except (Refused, OSError, ConnectionError):  # killed before it took it: ask again
                    killer.join()
                    await_that(lambda: self.answers(system), 10, "a manager")
                    set_to(system, wish=2 if target == "high" else 1)
                killer.join()
                await_that(lambda: self.answers(system), 10, "a manager")
                self.await_set(system, target, 15)
                present = target
                time.sleep(4)  # three deaths in 10 s and it is given up

    @staticmethod
    def answers(system):
        try:
            system.disconnect()
            return bool(system.call("status"))
        except (Refused, OSError, ConnectionError):
            return False

    def test_on_fault_leads_to_another_configuration(self):
        for text in (FAILS, FAILS.replace("cpu: 1, policy: edf}", "cpu: 1, policy: edf, executor: preemptive}")):
            with self.subTest(preemptive=text.count("executor: preemptive")):
                self.on_fault_leads_to_another_configuration(text)

    def on_fault_leads_to_another_configuration(self, text):
        with System(text.replace("REACTION", "{switch: less}")) as system:
            self.await_less(system)
            self.assertEqual(system.state("thrower"), "ERROR")
            lines = await_that(lambda: [line for line in told(system) if "on_fault of thrower" in line and
                                        "to 'less' after" in line], 5, f"a receipt; {told(system)}")
            self.assertEqual(len(lines), 1)

    def test_on_miss_and_on_overrun_lead_to_another_configuration(self):
        reactions = {"on_miss": "deadline: 1 ms, on_miss: {switch: less}",
                     "on_overrun": "budget: 500 us, on_overrun: {switch: less}"}
        for reaction, executor in (("on_miss", "preemptive"), ("on_overrun", "executive")):
            with self.subTest(reaction=reaction):
                self.leads_to_another_configuration(reaction, LATE.replace("REACTION", reactions[reaction]).replace(
                    "cpu: 1, policy: edf}", f"cpu: 1, policy: edf, executor: {executor}}}"))

    def leads_to_another_configuration(self, reaction, text):
        with System(text) as system:
            self.await_less(system)
            receipts = await_that(lambda: system.call("receipts")["receipts"], 5, "a receipt")
            self.assertEqual([(one["to"], one["end"], one["asked_by"]) for one in receipts],
                             [("less", "done", {"reaction": reaction, "task": "bad"})])
            self.assertEqual(system.state("bad"), "OFF")

    def test_a_reaction_asks_again_for_the_same_although_the_manager_is_dead(self):
        """The first fault was answered by the manager that dies; the second one comes before its successor."""
        with System(FAILS.replace("REACTION", "{switch: less}")) as system:
            self.await_less(system)
            await_that(lambda: system.call("receipts")["receipts"], 5, "its receipt: the switch is over")
            for what in ("kill", "spawn"):  # made anew: it fails in its cycle 100 again
                system.signal(what, "thrower")
            self.assertEqual(system.call("switch", configuration="all")["end"], "done")
            keeper, manager = system.pids()["keeper"], system.pids()["manager"]
            self.assertTrue(system.kill(keeper, signal.SIGSTOP))  # starts no successor
            try:
                self.assertTrue(system.kill(manager))
                time.sleep(1.5)
            finally:
                self.assertTrue(system.kill(keeper, signal.SIGCONT))
            await_that(lambda: self.answers(system), 10, "a manager")
            await_that(lambda: on(system) == {"steady"}, 10, "less, once more")
            ends = lambda: [(one["to"], one["end"]) for one in system.call("receipts")["receipts"]]
            await_that(lambda: ends() == [("less", "done"), ("all", "done"), ("less", "done")], 5,
                       f"a receipt of each, filed after the tasks are seen OFF; {ends()}")

    def test_on_fault_flag_is_seen_in_the_other_unit_until_it_is_cleared(self):
        with System(FAILS.replace("REACTION", "flag")) as system:
            system.await_state("thrower", "ERROR")
            await_that(lambda: system.call("status")["flag"]["up"], 5, "the flag")
            self.assertEqual(on(system), {"steady", "beside"})
            system.signal("clear", "thrower")
            await_that(lambda: not system.call("status")["flag"]["up"], 5, "the flag down")

    def test_on_fault_stop_turns_the_unit_off(self):
        with System(FAILS.replace("REACTION", "stop")) as system:
            await_that(lambda: on(system) == {"steady"}, 10, "the other unit alone")
            self.assertEqual((system.state("thrower"), system.state("beside")), ("ERROR", "OFF"))


if __name__ == "__main__":
    unittest.main()
