# SPDX-License-Identifier: Apache-2.0
"""A job that never ends in a preemptive rtpu costs its own rtpu a restart; the tasks of the others stay ON. The test
prints the cycles that they lost; the campaign `process_preemptive` repeats this in a release build."""
import sys
import unittest

from system import System, await_that, duration

REAL_TIME = ("--priority", "40")

# `watch` has the highest priority on its CPU: only the host can make it miss. `below` gives way to the jobs that hang.
# `beside` uses a hundred times its budget of microseconds, which is no reason to give it up.
APPLICATION = """
subsystem: subject
rtpus:
  first: {cpu: 0, policy: edf}
  watch: {cpu: 1, policy: edf}
  second: {cpu: 1, policy: muf, executor: preemptive}
  third: {cpu: 1, policy: edf, executor: preemptive}
  below: {cpu: 1, policy: edf}
tasks:
  steady: {component: t_source, rtpu: first, rate: 100 Hz, alias: {x: x0, expired: e0}}
  watch: {component: t_source, rtpu: watch, rate: 100 Hz, criticality: high, alias: {x: x1, expired: e1}}
  loops: {component: t_crash, rtpu: second, rate: 200 Hz, budget: 100 us, on_overrun: demote, criticality: medium,
          alias: {y: y0}, constants: {where: cycle, how: hang}, resources: {armed: ARMED-loops}}
  vanishes: {component: t_crash, rtpu: third, rate: 200 Hz, budget: 100 us, alias: {y: y1},
             constants: {where: cycle, how: vanish}, resources: {armed: ARMED-vanishes}}
  sleeps: {component: t_crash, rtpu: third, rate: 200 Hz, budget: 100 us, alias: {y: y2},
           constants: {where: cycle, how: sleep}, resources: {armed: ARMED-sleeps}}
  beside: {component: t_source, rtpu: second, rate: 50 Hz, budget: 5 us, constants: {spend: 500000 ns},
           alias: {x: x2, expired: e2}}
  below: {component: t_source, rtpu: below, rate: 50 Hz, alias: {x: x3, expired: e3}}
configurations:
  all: [steady, watch, loops, vanishes, sleeps, beside, below]
start: all
"""

# Every task but the guarded ones is an endless loop; all loops begin at once, on both CPUs.
LOOPS = """
subsystem: subject
rtpus:
  hard_a: {cpu: 0, policy: muf, executor: preemptive}
  hard_b: {cpu: 1, policy: muf, executor: preemptive}
  soft_a: {cpu: 0, policy: muf, executor: preemptive}
  soft_b: {cpu: 1, policy: edf, executor: preemptive}
tasks:
  guarded_a: {component: t_source, rtpu: hard_a, rate: 100 Hz, budget: 1 ms, criticality: high,
              constants: {spend: 500000 ns}, alias: {x: x0, expired: e0}}
  guarded_b: {component: t_source, rtpu: hard_b, rate: 100 Hz, budget: 1 ms, criticality: high,
              constants: {spend: 500000 ns}, alias: {x: x1, expired: e1}}
"""
N_LOOPS = 4
for n in range(N_LOOPS):
    LOOPS += (f"  loop_{n}: {{component: t_crash, rtpu: soft_{'ab'[n % 2]}, rate: 5 Hz, budget: 15 ms, "
              f"on_overrun: demote, alias: {{y: y{n}}}, constants: {{where: cycle, how: hang}}, "
              "resources: {armed: ARMED}}\n")
LOOPS += ("configurations: {all: [guarded_a, guarded_b, " + ", ".join(f"loop_{n}" for n in range(N_LOOPS)) +
          "]}\nstart: all\n")


def lost(system, tasks):
    """Deadlines missed and releases dropped so far, of each of these tasks."""
    of = {t["task"]: t["missed"] + t["dropped"] for t in system.call("status")["tasks"]}
    return {task: of[task] for task in tasks}


def print_lost(system, before, what):
    after = lost(system, before)
    print(f"lost beside {what}: { {task: after[task] - before[task] for task in before} }", file=sys.stderr)


class Preemptive(unittest.TestCase):
    def test_row_3_a_job_that_never_ends_costs_its_own_rtpu_a_restart(self):
        with System(APPLICATION, REAL_TIME) as system:
            for task, rtpu, mates in (("loops", "second", ("beside",)), ("vanishes", "third", ("sleeps",)),
                                      ("sleeps", "third", ("vanishes",))):
                with self.subTest(task):
                    self.is_restarted(system, task, rtpu, mates)

    def is_restarted(self, system, task, rtpu, mates):
        others = [t for t in ("steady", "watch", "below", "beside") if t not in mates]
        before, since, was = lost(system, others), system.next_event(), system.rtpu(rtpu)
        incarnations = {t["task"]: t["incarnation"] for t in system.call("status")["tasks"]}
        trigger = system.armed.with_name(f"{system.armed.name}-{task}")
        trigger.write_text("")
        seen = system.await_event(since, "hang")
        begun = int(trigger.read_text())
        trigger.unlink()
        system.await_restart(rtpu, was)
        for one in (task, *mates):
            system.await_state(one, "ON")
        hung = {(e["task"], e["rtpu"]) for e in system.events(since, "hang")}
        self.assertEqual(hung, {(task, rtpu)})
        for other in others:
            after = system.task(other)
            self.assertEqual((after["state"], after["incarnation"]), ("ON", incarnations[other]))
        told = min(e["at_ns"] for e in system.events(since, task=task) if e["kind"] in ("blame", "hang"))
        duration(f"from the begin of {task} to the first event", (told - begun) / 1e9)
        duration(f"from the begin of {task} to `hang`", (seen["at_ns"] - begun) / 1e9)
        print_lost(system, before, task)
        print("bad jobs: 1", file=sys.stderr)

    def test_row_18_with_endless_loops_in_all_tasks_but_the_guarded_ones_the_manager_answers(self):
        with System(LOOPS, REAL_TIME) as system:
            before = lost(system, ("guarded_a", "guarded_b"))
            system.arm()
            asked = system.call("status")["now_ns"]
            for rtpu in ("soft_a", "soft_b"):
                system.await_event(0, "hang", rtpu=rtpu)
            duration("until both rtpus with loops are reported", (system.call("status")["now_ns"] - asked) / 1e9)
            system.disarm()
            await_that(lambda: {"guarded_a", "guarded_b"} <= system.on(), system.told)
            print_lost(system, before, "the loops")
        print(f"bad jobs: {N_LOOPS}", file=sys.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=1)
