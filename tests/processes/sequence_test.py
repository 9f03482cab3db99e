# SPDX-License-Identifier: Apache-2.0
"""A sequence over real processes: without its manager, and after the death of each rtpu."""
import unittest

from descriptions import preemptive
from system import System, await_that

STEPS = """
subsystem: subject
rtpus:
  servo: {cpu: 0, policy: edf}
  brain: {cpu: 1, policy: edf}
tasks:
  near:
    component: signal_generator
    rate: 100 Hz
    alias: {y: level}
    constants: {amplitude: 0 m, offset: 1 m}
  far:
    component: signal_generator
    rate: 100 Hz
    alias: {y: level}
    constants: {amplitude: 0 m, offset: 2 m}
configurations:
  near_by: [near]
  far_off: [far]
"""
RUNS = STEPS + """
sequence:
  rtpu: brain
  steps:
    - {name: first, switch: near_by, until: 'level < 1500 mm', within: 60 s}
    - {name: second, switch: far_off, until: level >= 2 m, within: 60 s}
    - {name: third, switch: near_by, for: 50 ms}
    - {name: last, switch: far_off}
"""
STAYS = STEPS + """
sequence:
  rtpu: brain
  steps:
    - {name: first, switch: near_by, for: 1 h}
    - {name: second, switch: far_off, for: 1 h, reentry: true}
    - {name: third, switch: near_by, for: 1 h}
"""
PAUSED, RUNNING, DONE = 0, 2, 6


class Sequence(unittest.TestCase):
    def await_step(self, system, step, state):
        await_that(lambda: (system.value("sequence_step"), system.value("sequence_state")) == (step, state),
                   lambda: f"step {step} in state {state}: {system.value('sequence_step')} "
                           f"{system.value('sequence_state')} {system.told()}")

    def go(self, system, *words):
        return system.chimera("sequence", *words, "--subsystem", "subject").stdout

    def go_from_the_first(self, system, step):
        """The first step begins by itself: a Go would begin it once more, perhaps after what the test does next."""
        if step > 1:
            self.go(system, "go", str(step))

    def kill(self, system, rtpu, step, state, note=""):
        """Afterwards the sequence has this step and state, and has said the note."""
        before, since = system.rtpu(rtpu), system.next_event()
        self.assertTrue(system.kill(before["pid"]))
        system.await_restart(rtpu, before)
        if note:
            system.await_event(since, "note", note, task="sequence")
        self.await_step(system, step, state)

    def test_goes_through_its_steps(self):
        for form in (str, preemptive):
            with self.subTest(form.__name__), System(form(RUNS)) as system:
                self.await_step(system, 4, DONE)
                self.assertEqual([receipt["to"] for receipt in system.call("receipts")["receipts"]],
                                 ["far_off", "near_by", "far_off"])
                shown = system.chimera("sequence", "--subsystem", "subject").stdout
                described = system.call("describe")["sequence"]
                self.assertEqual([step["until"] or step["for"] for step in described["steps"]],
                                 ["level < 1500 mm", "level >= 2 m", "50 ms", None])
                self.assertEqual(described["path"], "sequence/steps")
                self.assertEqual(shown.replace("[subject] ", ""), "  1 first\n  2 second\n  3 third\n> 4 last  done\n")
                self.assertIn("goes to step 1", self.go(system, "go"))
                await_that(lambda: len(system.call("receipts")["receipts"]) == 7, lambda: f"a round: {system.told()}")

    def test_goes_on_after_a_death_only_where_reentry_is_allowed(self):
        with System(STAYS) as system:
            for step, state, note in ((1, PAUSED, "may go on with step 2"), (2, RUNNING, "goes on with step 2"),
                                      (3, PAUSED, "may go on with step 2")):
                self.go_from_the_first(system, step)
                self.await_step(system, step, RUNNING)
                self.kill(system, "servo", step, state, note)

    def test_goes_on_after_the_death_of_its_own_rtpu_only_where_reentry_is_allowed(self):
        with System(STAYS) as system:
            for word, step, after in (("2", 2, (2, RUNNING, "goes on with step 2")), ("first", 1, (0, PAUSED)),
                                      ("third", 3, (0, PAUSED))):
                self.go(system, "go", word)
                self.await_step(system, step, RUNNING)
                self.kill(system, "brain", *after)

    def test_a_pause_outlives_the_death_of_its_rtpu(self):
        with System(STAYS) as system:
            self.go(system, "go", "2")
            self.await_step(system, 2, RUNNING)
            self.go(system, "pause")
            self.await_step(system, 2, PAUSED)
            self.kill(system, "brain", 0, PAUSED)

    def test_goes_on_without_its_manager(self):
        with System(STAYS) as system:
            for step in (1, 2, 3):
                self.go_from_the_first(system, step)
                self.await_step(system, step, RUNNING)
                self.assertTrue(system.kill(system.call("hello")["manager"]["pid"]))
                self.await_step(system, step, RUNNING)


if __name__ == "__main__":
    unittest.main()
