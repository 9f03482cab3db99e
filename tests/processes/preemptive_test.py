# SPDX-License-Identifier: Apache-2.0
"""What a bad job in a preemptive real-time unit costs the others: nothing. Bounded counts here; the same with more of
them is the campaign `process_preemptive`. CHIMERA_ROUNDS says how often each is repeated."""
import os
import re
import signal
import sys
import time
import unittest

from system import System, await_that

ROUNDS = int(os.environ.get("CHIMERA_ROUNDS", "1"))
REAL_TIME = ("--priority", "40")

# `watch` stands above everything on its CPU: what it misses is the machine's doing. `below` gives way to the bad ones.
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
  dozes: {component: t_crash, rtpu: third, rate: 200 Hz, alias: {y: y4}, constants: {where: cycle, how: doze},
          resources: {armed: ARMED-dozes}}
  blocks: {component: t_crash, rtpu: second, rate: 100 Hz, budget: 500 us, criticality: medium, alias: {y: y3},
           constants: {where: cycle, how: block}, resources: {armed: ARMED-blocks}}
  beside: {component: t_source, rtpu: second, rate: 50 Hz, alias: {x: x2, expired: e2}}
  below: {component: t_source, rtpu: below, rate: 50 Hz, alias: {x: x3, expired: e3}}
configurations:
  all: [steady, watch, loops, vanishes, sleeps, dozes, blocks, beside, below]
start: all
"""

# `bad` uses up to three times what it may; `patient` waits for it and is late for no reason of its own.
OVERRUNS = """
subsystem: subject
rtpus:
  second: {cpu: 1, policy: POLICY, executor: EXECUTOR}
tasks:
  bad: {component: t_overrun, rtpu: second, rate: 1 kHz, budget: 500 us, constants: {allowed: 500000 ns}}
  patient: {component: t_source, rtpu: second, rate: 500 Hz, budget: 300 us, constants: {spend: 250000 ns}}
configurations: {all: [bad, patient]}
start: all
"""

# A job that waits while it is told to, in a unit that others are in.
WAITS = """
subsystem: subject
rtpus:
  only: {cpu: 1, policy: edf, executor: preemptive}
tasks:
  waits: {component: t_crash, rate: 200 Hz, on_miss: REACTION, alias: {y: y0}, constants: {where: cycle, how: linger},
          resources: {armed: ARMED}}
  beside: {component: t_source, rate: 100 Hz}
"""

# Nothing of its own takes long.
TAKEN = """
subsystem: subject
rtpus:
  only: {policy: edf, executor: EXECUTOR}
tasks:
  brief: {component: t_source, rate: 100 Hz, budget: 1 ms}
"""
AWAY = re.compile(r"^missed its deadline: no task of its real-time unit ran for ([0-9.]+) ms: the CPU was taken")

BLOCKED = re.compile(r"^missed its deadline: it waits in a system call \(it used [0-9.]+ [mu]s\)$")
PERIOD_MS = 5  # of those that do not end in time

WHOSE = re.compile(r"^missed its deadline: (bad used |it used [0-9.]+ [mu]s \(budget 300 us\)|"
                   r"no task of its real-time unit ran for [0-9.]+ ms: the CPU was taken )")
GAVE_WAY = re.compile(r"^demoted below all other threads: the tasks of its real-time unit used [0-9.]+ ms lately, "
                      r"nearly all that the kernel leaves to real-time threads$")

# Every task but the guarded ones is an endless loop, and all begin at once, on all processors.
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


# Half as much again as there is: `a` and `b` are honest and critical, the others say that they take a tenth.
OVERLOAD = """
subsystem: subject
rtpus:
  only: {cpu: 1, policy: POLICY, executor: preemptive}
tasks:
  a: {component: t_source, rate: 160 Hz, budget: 1.3 ms, criticality: high, constants: {spend: 1200000 ns},
      alias: {x: x0, expired: e0}}
  b: {component: t_source, rate: 50 Hz, budget: 8 ms, criticality: high, constants: {spend: 7500000 ns},
      alias: {x: x1, expired: e1}}
  c: {component: t_source, rate: 40 Hz, budget: 2 ms, constants: {spend: 13000000 ns}, alias: {x: x2, expired: e2}}
  d: {component: t_source, rate: 25 Hz, budget: 2 ms, constants: {spend: 16000000 ns}, alias: {x: x3, expired: e3}}
"""

# The same on a CPU that two units share: alone, neither of them would use more than the kernel allows.
OF_TWO_UNITS = """
subsystem: subject
rtpus:
  upper: {cpu: 1, policy: muf, executor: preemptive}
  lower: {cpu: 1, policy: muf, executor: preemptive}
tasks:
  a: {component: t_source, rtpu: upper, rate: 160 Hz, budget: 1.3 ms, criticality: high, constants: {spend: 1200000 ns},
      alias: {x: x0, expired: e0}}
  c: {component: t_source, rtpu: upper, rate: 40 Hz, budget: 2 ms, criticality: medium, constants: {spend: 15000000 ns},
      alias: {x: x2, expired: e2}}
  d: {component: t_source, rtpu: lower, rate: 25 Hz, budget: 2 ms, constants: {spend: 24000000 ns},
      alias: {x: x3, expired: e3}}
"""


def started(text):
    """In real time; without it while somebody else has the CPUs."""
    for _ in range(20):
        try:
            return System(text, REAL_TIME)
        except AssertionError as refusal:
            if "is in use by another real-time subsystem" not in str(refusal):
                raise
        time.sleep(0.5)
    return System(text)


def median(values):
    return sorted(values)[len(values) // 2]


class Preemptive(unittest.TestCase):
    counts, times, has_rights = {}, {}, True

    @classmethod
    def tearDownClass(cls):
        for what, n in sorted(cls.counts.items()):
            print(f"{what}: {n}", file=sys.stderr)
        for what, ms in sorted(cls.times.items()):
            print(f"{what}: median {median(ms):.1f} ms, worst {max(ms):.1f} ms of {len(ms)}", file=sys.stderr)

    def count(self, what, n=1):
        Preemptive.counts[what] = Preemptive.counts.get(what, 0) + n

    def took(self, what, ns):
        Preemptive.times.setdefault(what, []).append(ns / 1e6)

    def is_judged(self, system):
        """Without real-time rights levels are the system's choice, and so is who is late. Sanitizers make every job
        slower and never lock memory, so only a release build is judged: the campaign `process_preemptive`."""
        Preemptive.has_rights = all(r["grant"].startswith("Real-time OK") for r in system.call("status")["rtpus"])
        return Preemptive.has_rights

    def lost(self, system, tasks):
        """Deadlines missed and releases dropped by now, of each of these."""
        of = {t["task"]: t["missed"] + t["dropped"] for t in system.call("status")["tasks"]}
        return {task: of[task] for task in tasks}

    def grown(self, system, before):
        after = self.lost(system, before)
        return {task: after[task] - before[task] for task in before if after[task] != before[task]}

    def undisturbed(self, once):
        """One try in which the witness was not disturbed decides; at most five are made. `once` gives what others
        lost, or None when the machine disturbed the witness or grants no real-time rights: those do not come back."""
        outcomes = [once()]
        while outcomes[-1] != {} and len(outcomes) < 5 and Preemptive.has_rights:
            outcomes.append(once())
        if outcomes[-1] is None:
            print(f"not judged: {'host stalled' if Preemptive.has_rights else 'no real-time rights'}", file=sys.stderr)
        else:
            self.assertEqual(outcomes[-1], {}, f"lost beside a clean witness: {outcomes}")

    def recovers(self, system, unit, task, mates):
        """One fault of `task`, until everything of its unit is ON again; what was lost meanwhile."""
        units = ("beside", "loops", "blocks", "vanishes", "sleeps", "dozes")
        others = ["steady", "watch", "below"] + [t for t in units if t not in (task, *mates)]
        before, since = self.lost(system, others), system.events()[-1]["number"] + 1
        was, armed = system.rtpu(unit), time.monotonic_ns()
        trigger = system.armed.with_name(f"{system.armed.name}-{task}")
        trigger.write_text("")
        seen = await_that(lambda: [e for e in system.events(since) if e["kind"] == "hang"], 10, f"{task} is seen")
        begun = trigger.read_text()
        trigger.unlink()
        await_that(lambda: system.rtpu(unit)["incarnation"] > was["incarnation"], 5, "a new incarnation")
        for one in (task, *mates):
            system.await_state(one, "ON")
        back = max(e["at_ns"] for e in system.events(since) if e["kind"] == "state" and e["text"] == "OFF -> ON")
        hung = [(e["task"], e["rtpu"]) for e in system.events(since) if e["kind"] == "hang"]
        self.assertEqual(set(hung), {(task, unit)})
        self.assertEqual(system.rtpu(unit)["restarts"], was["restarts"] + len(hung), "one of them may be still armed")
        self.count(f"row 3 {task}")
        self.count("bad jobs")
        self.took(f"{task}: seen after", seen[0]["at_ns"] - armed)
        self.took(f"{task}: ON again after", back - seen[0]["at_ns"])
        lost = self.grown(system, before)
        lost.update(self.told_late(task, begun, system.events(since)))
        return None if "watch" in lost or not self.is_judged(system) else lost

    def told_late(self, task, begun, events):
        """Nothing when whoever waits for its task was told of it within a period and a millisecond."""
        told = min(e["at_ns"] for e in events if e.get("task") == task and e["kind"] in ("blame", "hang"))
        self.took(f"{task}: told after its begin", told - int(begun))
        after_ms = (told - int(begun)) / 1e6
        return {} if after_ms <= PERIOD_MS + 1 else {f"{task} told after": after_ms}

    def test_row_3_a_call_that_blocks_is_told_within_a_period_and_a_millisecond(self):
        def once():
            others = ("steady", "watch", "below", "beside", "loops", "blocks", "vanishes", "sleeps")
            before, late = self.lost(system, others), {}
            for _ in range(20):
                since = system.events()[-1]["number"] + 1
                trigger.write_text("")
                told = await_that(lambda: [e for e in system.events(since)
                                           if (e.get("task"), e["kind"]) == ("dozes", "blame") and
                                           BLOCKED.match(e["text"])], 10, "it is told that it waits")
                begun = await_that(trigger.read_text, 5, "its begin")
                trigger.unlink()
                late.update(self.told_late("dozes", begun, told))
                self.count("row 3 dozes")
                self.count("bad jobs")
                time.sleep(0.1)  # one is told every 100 ms at most
            lost = self.grown(system, before)
            return None if "watch" in lost or not self.is_judged(system) else {**lost, **late}
        with started(APPLICATION) as system:
            trigger = system.armed.with_name(f"{system.armed.name}-dozes")
            for _ in range(ROUNDS):
                self.undisturbed(once)

    def test_reactions_act_while_the_job_still_waits(self):
        for reaction in ("flag", "stop"):
            with self.subTest(reaction=reaction):
                self.assertTrue(any(self.reacts(reaction) for _ in range(10)), "each time it was late before it waited")

    def reacts(self, reaction):
        """False: the machine was away, and a job was late that did not wait."""
        with System(WAITS.replace("REACTION", reaction), wait=False) as system:
            try:
                system.await_started()
                since = system.events()[-1]["number"] + 1
                if any(e["kind"] == reaction for e in system.events()):
                    return False
                system.arm()
                await_that(lambda: {reaction, "blame"} <= {e["kind"] for e in system.events(since)}, 10, "both events")
                kinds, state = [e["kind"] for e in system.events(since)], system.state("waits")
                if not any(BLOCKED.match(e["text"]) for e in system.events(since) if e["kind"] == "blame"):
                    return False
            except (OSError, AssertionError):
                if reaction != "stop" or system.process.poll() is None:
                    raise
                return False
            self.assertEqual(state, "ON")
            self.assertNotIn("hang", kinds, "it is seen to hang after 2 s")
            if reaction == "flag":
                self.assertEqual(system.call("status")["flag"], {"up": True, "by": ["only"]})
            else:
                system.await_state("beside", "OFF")
            system.disarm()
            if reaction == "stop":
                await_that(lambda: self.is_off(system), 10, "waits OFF")
                self.assertEqual(kinds.count("stop"), 1)
            return True

    def is_off(self, system):
        """The task is OFF; or the run, in which no task is ON any more, has ended by then."""
        try:
            return system.state("waits") == "OFF"
        except OSError:
            return system.process.poll() is not None

    def test_row_3_a_job_that_never_ends_costs_its_own_unit_a_restart_and_others_nothing(self):
        for _ in range(ROUNDS):
            for task, unit, mates in (("loops", "second", ("beside", "blocks")),
                                      ("vanishes", "third", ("sleeps", "dozes")),
                                      ("sleeps", "third", ("vanishes", "dozes"))):
                def once():
                    with started(APPLICATION) as system:
                        return self.recovers(system, unit, task, mates)
                self.undisturbed(once)

    def test_a_job_that_blocks_two_milliseconds_costs_nobody_anything(self):
        def once():
            others = ("steady", "watch", "below", "beside", "loops", "blocks")
            before, cycles = self.lost(system, others), system.task("blocks")["cycles"]
            trigger.write_text("")
            await_that(lambda: system.task("blocks")["cycles"] > cycles + 30, 10, "cycles that block")
            trigger.unlink()
            self.count("jobs that blocked", 30)
            lost = self.grown(system, before)
            return None if "watch" in lost or not self.is_judged(system) else lost
        with started(APPLICATION) as system:
            trigger = system.armed.with_name(f"{system.armed.name}-blocks")
            for _ in range(ROUNDS):
                self.undisturbed(once)
            blocks = system.task("blocks")
            self.assertLess(blocks["overrun"], blocks["cycles"] // 4, "execution time is judged, not elapsed time")

    def test_row_4_overruns_make_no_burst_and_every_miss_has_its_culprit(self):
        for executor, policy in (("preemptive", "muf"), ("preemptive", "edf"), ("executive", "edf")):
            text = OVERRUNS.replace("POLICY", policy).replace("EXECUTOR", executor)
            with self.subTest(executor=executor, policy=policy), started(text) as system:
                def blamed():
                    return [e for e in system.events() if e["kind"] == "blame" and e["task"] == "patient"]

                def named():
                    return [e for e in blamed() if "missed its deadline: bad used " in e["text"]]
                # Without real-time rights both get a share of the CPU, and `patient` is seldom late.
                await_that(lambda: system.task("bad")["cycles"] > 400 * ROUNDS and named(), 20 + 3 * ROUNDS,
                           "cycles, and a miss for which the bad one is named")
                system.signal("off", "bad")
                values = system.call("get", variables=["bursts", "unsaid", "over"])["values"]
                seen = {name: reading["value"] for name, reading in values.items()}
                self.assertEqual((seen["bursts"], seen["unsaid"]), (0, 0))
                bad = await_that(lambda: (t := system.task("bad"))["overrun"] >= seen["over"] and t, 5, "every overrun")
                self.assertGreater(seen["over"], bad["cycles"] // 2)
                # The machine delays some, more on a busy one: then it is named, or whoever it kept from ending.
                told, bads = len(blamed()), len(named())
                if self.is_judged(system):
                    self.assertGreater(bads, told // 2)
                for event in blamed():
                    self.assertRegex(event["text"], WHOSE)
                self.count("row 4 cycles", bad["cycles"])
                self.count("row 4 overruns", bad["overrun"])
                self.count("bad jobs", bad["overrun"])
                self.count("row 4 culprits named", bads)
                self.count("row 4 delays by the machine told", told - bads)

    def test_row_18_a_processor_that_is_taken_away_is_told(self):
        for executor in ("executive", "preemptive"):
            with self.subTest(executor=executor), System(TAKEN.replace("EXECUTOR", executor)) as system:
                def once():
                    since, pid = system.events()[-1]["number"] + 1, system.rtpu("only")["pid"]
                    self.assertTrue(system.kill(pid, signal.SIGSTOP))
                    time.sleep(0.06)
                    self.assertTrue(system.kill(pid, signal.SIGCONT))
                    time.sleep(0.15)  # one is told every 100 ms at most
                    told = [AWAY.search(e["text"]) for e in system.events(since) if e["kind"] == "blame"]
                    return [float(away[1]) for away in told if away and float(away[1]) > 50]  # others: of the machine
                self.assertLess(max(await_that(once, 10, "what was taken away")), 1000)

    def test_row_18_overload_costs_the_critical_tasks_nothing(self):
        """Long enough that the kernel would take the processor from all of them (0.95 s of each second), twice."""
        for text, critical in ((OVERLOAD.replace("POLICY", "muf"), ("a", "b")), (OF_TWO_UNITS, ("a",))):
            for _ in range(ROUNDS):
                self.undisturbed(lambda: self.overloaded(text, critical))

    def overloaded(self, text, critical):
        with started(text) as system:
            if not self.is_judged(system):
                return None
            await_that(lambda: system.task("a")["cycles"] > 400, 10, "two and a half seconds")
            tasks = {t["task"]: t for t in system.call("status")["tasks"]}
            told = [e for e in system.events() if e["kind"] == "demoted"]
        self.count("row 18 critical jobs under overload", sum(tasks[task]["cycles"] for task in critical))
        self.assertGreater(tasks["c"]["demoted"] + tasks["d"]["demoted"], 0, "there is an overload")
        self.assertEqual(sum(tasks[task]["demoted"] for task in critical), 0)
        self.assertTrue(told)
        for event in told:
            self.assertIn(event["task"], ("c", "d"))
            self.assertRegex(event["text"], GAVE_WAY)
        lost = {task: tasks[task]["missed"] + tasks[task]["dropped"] for task in critical}
        return {task: n for task, n in lost.items() if n}

    def test_row_18_endless_loops_in_every_task_but_the_guarded_ones(self):
        def once():
            with started(LOOPS) as system:
                control = self.lost(system, ("guarded_a", "guarded_b"))
                time.sleep(0.5)
                is_judged = self.is_judged(system) and not self.grown(system, control)
                before, slowest = self.lost(system, control), 0
                system.arm()
                end = time.monotonic() + 1
                while time.monotonic() < end:
                    asked = time.monotonic_ns()
                    system.call("status")
                    slowest = max(slowest, time.monotonic_ns() - asked)
                    time.sleep(0.02)
                lost = self.grown(system, before)
                told = await_that(lambda: {e["task"] for e in system.events() if e["kind"] == "hang"}, 10, "a hang")
                system.disarm()
            self.took("row 18: slowest answer", slowest)
            self.count("row 18 loops", N_LOOPS)
            self.count("bad jobs", N_LOOPS)
            self.assertLess(slowest, 1e9, "an answer within a second")
            self.assertTrue(told)
            return lost if is_judged else None
        for _ in range(ROUNDS):
            self.undisturbed(once)


if __name__ == "__main__":
    unittest.main(verbosity=1)
