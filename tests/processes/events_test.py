# SPDX-License-Identifier: Apache-2.0
"""Events from one rtpu for a task behind a server in another: each is counted, answered in turn, lost only while the
task is not ON."""
import unittest

from system import System, await_that

APPLICATION = """
subsystem: subject
rtpus:
  served: {cpu: 1, policy: edf, executor: preemptive}
  other: {cpu: 0, policy: edf}
tasks:
  steady: {component: t_counter, rtpu: served, rate: 100 Hz}
  button: {component: ringer, rtpu: other, rate: 200 Hz, constants: {target: alarm, burst: 2}}
  neighbour: {component: ringer, rtpu: served, rate: 100 Hz, alias: {rung: again}, constants: {target: alarm}}
  alarm:
    component: on_event
    rtpu: served
    server: {kind: deferrable, capacity: 4 ms, period: 20 ms}
    constants: {time: 100 us}
configurations: {all: [steady, button, neighbour, alarm]}
start: all
"""


class Events(unittest.TestCase):
    def test_of_other_rtpus_are_answered_each_by_one_job(self):
        with System(APPLICATION) as system:
            system.await_state("alarm", "ON")
            alarm = await_that(lambda: (t := system.task("alarm"))["cycles"] > 200 and t, 20, "events")
            self.assertEqual(alarm["faults"], 0)
            self.assertGreaterEqual(alarm["events"], alarm["cycles"])
            self.assertEqual(system.task("steady")["faults"], 0)

            lost = alarm["events_lost"]
            system.signal("off", "alarm")
            system.await_state("alarm", "OFF")
            off = await_that(lambda: (t := system.task("alarm"))["events_lost"] > lost + 20 and t, 20, "lost events")
            self.assertLessEqual(off["cycles"], off["events"])
            system.signal("on", "alarm")
            await_that(lambda: system.task("alarm")["cycles"] > off["cycles"] + 50, 20, "events again")


if __name__ == "__main__":
    unittest.main(verbosity=1)
