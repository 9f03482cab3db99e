# SPDX-License-Identifier: Apache-2.0
"""Requests and reactions of tasks over real processes: carried out by the manager, or by the one that follows it; and
`safe_when`, which holds a switch up."""
import signal
import time
import unittest

from descriptions import mixed, preemptive
from system import RTPUS, System, await_that

# `asker` of the second rtpu asks for what the operator variable `wish` says.
TEXT = RTPUS + """
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
SETS = {"low": {"steady", "asker", "one", "reader"}, "high": {"steady", "asker", "two", "reader"}}

# The task that fails is left behind, in another rtpu than its reader.
FAILS = RTPUS + """
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

# The task of the second rtpu uses up to 9 ms of each 10.
LATE = RTPUS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 100 Hz}
  bad: {component: t_overrun, rtpu: second, rate: 100 Hz, constants: {allowed: 3000000 ns}, REACTION}
configurations:
  all: [steady, bad]
  less: [steady]
start: all
"""


def set_to(system, **values):
    system.call("set", values=values)


class Requests(unittest.TestCase):
    def await_on(self, system, tasks):
        await_that(lambda: system.on() == tasks, lambda: f"{tasks}: {system.told()}")

    def ends(self, system, *keys):
        return [tuple(one[key] for key in keys) for one in system.call("receipts")["receipts"]]

    def test_a_task_asks_and_is_named(self):
        for text in (TEXT, mixed(TEXT), preemptive(TEXT), LISTS):
            with self.subTest(preemptive=text.count("executor: preemptive"), lists=text.count("--on")):
                self.a_task_asks_and_is_named(text)

    def a_task_asks_and_is_named(self, text):
        with System(text) as system:
            set_to(system, wish=2)
            self.await_on(system, SETS["high"])
            set_to(system, wish=1)
            self.await_on(system, SETS["low"])
            system.await_cycles("asker", 30)  # all of them ask for what is in force
            lines = system.texts("switch")
            self.assertEqual(sum("asked for by task asker: begun" in line for line in lines), 2, lines)
            self.assertTrue(any("by task asker from 'low' to 'high'" in line for line in lines), lines)
            self.assertEqual(system.value("refused"), 0)
            await_that(lambda: self.ends(system, "to", "end", "asked_by") == [
                ("high", "done", {"task": "asker"}), ("low", "done", {"task": "asker"})], system.told)

    def test_tasks_that_are_no_legal_set_are_refused_by_name(self):
        with System(LISTS.replace("--on two --off one", "--off one two")) as system:
            set_to(system, wish=2)
            event = system.await_event(0, "switch")
            self.assertEqual(event["text"], "switch --off one two, asked for by task asker, is refused: "
                                            "level would have no producer")
            set_to(system, wish=1)  # in force
            system.await_cycles("asker", 50)
            self.assertEqual((system.on(), self.ends(system, "to")), (SETS["low"], []))

    def test_safe_when_holds_it_up_and_is_told_by_name(self):
        with System(TEXT) as system:
            set_to(system, given=9)
            system.await_value("seen", 9)
            receipt = system.call("switch", configuration="high", wait_ms=300)
            self.assertEqual((receipt["end"], receipt["reason"]), ("aborted", "not-safe"))
            self.assertEqual(receipt["why"], "'seen' is 9, and safe_when of 'high' asks for seen < 8")
            self.assertEqual(system.on(), SETS["low"])
            asking = system.ask("switch", configuration="high")
            await_that(lambda: system.call("plan", configuration="high")["reason"] == "under-way", "the switch")
            set_to(system, given=5)
            self.assertEqual(asking.answer()["end"], "done")
            self.assertEqual(system.on(), SETS["high"])

    def test_on_fault_leads_to_another_configuration(self):
        for text in (FAILS, mixed(FAILS)):
            with self.subTest(preemptive=text.count("executor: preemptive")), \
                    System(text.replace("REACTION", "{switch: less}")) as system:
                self.await_on(system, {"steady"})
                self.assertEqual(system.state("thrower"), "ERROR")
                self.assertIn("on_fault of thrower", system.await_event(0, "switch", "to 'less' after")["text"])

    def test_on_miss_and_on_overrun_lead_to_another_configuration(self):
        reactions = {"on_miss": "deadline: 1 ms, on_miss: {switch: less}",
                     "on_overrun": "budget: 500 us, on_overrun: {switch: less}"}
        for reaction, form in (("on_miss", mixed), ("on_overrun", str)):
            with self.subTest(reaction), System(form(LATE.replace("REACTION", reactions[reaction]))) as system:
                self.await_on(system, {"steady"})
                await_that(lambda: self.ends(system, "to"), "a receipt")
                self.assertEqual(self.ends(system, "to", "end", "asked_by"),
                                 [("less", "done", {"reaction": reaction, "task": "bad"})])
                self.assertEqual(system.state("bad"), "OFF")

    def test_a_reaction_asks_again_for_the_same_although_the_manager_is_dead(self):
        """The first fault was answered by the manager that dies; the second one comes before its successor."""
        with System(FAILS.replace("REACTION", "{switch: less}")) as system:
            self.await_on(system, {"steady"})
            await_that(lambda: self.ends(system, "to"), "its receipt: the switch is over")
            for what in ("kill", "spawn"):  # made anew: it fails in its cycle 100 again
                system.signal(what, "thrower")
            self.assertEqual(system.call("switch", configuration="all")["end"], "done")
            keeper, manager = system.pids()["keeper"], system.pids()["manager"]
            self.assertTrue(system.kill(keeper, signal.SIGSTOP))  # starts no successor
            try:
                self.assertTrue(system.kill(manager))
                system.disconnect()
                time.sleep(1.5)  # the time of the second fault, which no living process reports; later is right, too
            finally:
                self.assertTrue(system.kill(keeper, signal.SIGCONT))
            await_that(lambda: self.ends(system, "to", "end") == [("less", "done"), ("all", "done"), ("less", "done")],
                       system.told)
            self.assertEqual(system.on(), {"steady"})

    def test_on_fault_flag_is_seen_in_the_other_rtpu_until_it_is_cleared(self):
        with System(FAILS.replace("REACTION", "flag")) as system:
            system.await_state("thrower", "ERROR")
            await_that(lambda: system.call("status")["flag"]["up"], "the flag")
            self.assertEqual(system.on(), {"steady", "beside"})
            system.signal("clear", "thrower")
            await_that(lambda: not system.call("status")["flag"]["up"], "the flag down")

    def test_on_fault_stop_turns_the_rtpu_off(self):
        with System(FAILS.replace("REACTION", "stop")) as system:
            self.await_on(system, {"steady"})
            self.assertEqual((system.state("thrower"), system.state("beside")), ("ERROR", "OFF"))


if __name__ == "__main__":
    unittest.main()
