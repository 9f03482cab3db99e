# SPDX-License-Identifier: Apache-2.0
"""Random deaths of any process of a subsystem beside two clients that ask all the time: each call of a client ends,
each process but the keeper has a successor, the tasks of the others go on, and in the end nothing is left. A subsystem
ends with its twentieth death, or with its keeper. The last line counts the deaths and has the longest call.

usage: deaths_campaign.py --build TREE --seconds N
"""
import collections
import random
import sys
import threading
import time

import campaigns

BUDGET, SPAN = 3, 12.0  # an rtpu is started again at most 3 times in 10 s
TASK_OF = {"first": "a", "second": "b", "third": "c", "fourth": "d"}
TEXT = """
subsystem: subject
rtpus:
  first: {cpu: 0, policy: edf}
  second: {cpu: 1, policy: edf}
  third: {cpu: 0, policy: edf}
  fourth: {cpu: 1, policy: edf}
tasks:
  a: {component: t_recorder, rtpu: first, rate: 200 Hz, alias: {x: x0, y: x1}, constants: {label: a}}
  b: {component: t_recorder, rtpu: second, rate: 100 Hz, alias: {x: x1, y: x2}, constants: {label: b}}
  c: {component: t_recorder, rtpu: third, rate: 50 Hz, alias: {x: x2, y: x3}, constants: {label: c}}
  d: {component: t_recorder, rtpu: fourth, rate: 100 Hz, alias: {x: x3, y: x4}, constants: {label: d}}
operator: {x0: 0}
configurations: {all: [a, b, c, d]}
start: all
"""
QUESTIONS = (("status", {}), ("get", {"variables": ["x4"]}), ("why", {"variable": "x4"}),
             ("check", {"text": "subsystem: a", "file": "a.yaml"}))  # the last one is the analyst's


class Asker(threading.Thread):
    """Calls `ask` until the end. An OSError is no fault: the process that answers may be dead."""

    def __init__(self, ask):
        super().__init__(daemon=True)
        self.ask, self.longest, self.faults, self.over = ask, 0.0, [], threading.Event()
        self.start()

    def run(self):
        while not self.over.is_set():
            begun = time.monotonic()
            try:
                self.ask()
            except Exception as wrong:  # noqa: BLE001
                if not isinstance(wrong, OSError) or isinstance(wrong, TimeoutError):
                    self.faults.append(repr(wrong))
                time.sleep(0.01)
            self.longest = max(self.longest, time.monotonic() - begun)


class Deaths:
    def __init__(self, _):
        import system
        self.system, self.deaths, self.longest = system, collections.Counter(), 0.0

    def by_protocol(self, subject):
        client = self.system.Client(subject.socket)
        try:
            for method, parameters in QUESTIONS:
                client.call(method, **parameters)
        except self.system.Refused as refusal:
            is_told = "the analysis failed: its process ended by signal 9" in str(refusal)
            if not is_told and refusal.code != self.system.TOO_FAST:
                raise
        finally:
            client.close()

    def by_command(self, subject):
        if subject.chimera("status", "--json", code=None).returncode != 0:
            raise OSError("the manager is being replaced")

    def once(self, _):
        """One subsystem."""
        faults, last = [], {name: [] for name in TASK_OF}
        with self.system.System(TEXT) as subject:
            askers = [Asker(lambda: self.by_protocol(subject)), Asker(lambda: self.by_command(subject))]
            try:
                while sum(self.deaths.values()) % 20 != 19 and self.death(subject, last, faults):
                    pass
                self.death(subject, last, faults)
            except AssertionError as wrong:
                faults.append(str(wrong))
            for asker in askers:
                asker.over.set()
            for asker in askers:
                asker.join(self.system.HANG)
                faults += asker.faults + (["a call has not ended"] if asker.is_alive() else [])
                self.longest = max(self.longest, asker.longest)
        return faults

    def victims(self, subject, pids, last):
        now, analyst = time.monotonic(), subject.named("chimera-analyst")
        found = {"manager": pids["manager"], "analyst": analyst[0] if analyst else None}
        for name, instants in last.items():
            if sum(now - instant < SPAN for instant in instants) < BUDGET:
                found[name] = pids.get(name)
        return [(name, pid) for name, pid in found.items() if pid]

    def death(self, subject, last, faults):
        """One death and what follows. False when it was that of the keeper."""
        if subject.process.poll() is not None:
            return False
        pids = subject.pids()
        before = {t["task"]: t for t in subject.call("status")["tasks"]}
        if random.random() < 0.02:
            self.deaths["keeper"] += subject.kill(pids["keeper"])
            subject.wait()
            return False
        victim, pid = random.choice(self.victims(subject, pids, last))
        time.sleep(random.random() * 0.05)
        if not subject.kill(pid):
            return True
        self.deaths[victim if victim in ("manager", "analyst") else "rtpu"] += 1
        if victim in last:
            last[victim].append(time.monotonic())
        if victim != "analyst":
            subject.disconnect()
            self.system.await_that(lambda: subject.pids().get(victim, pid) != pid, f"another {victim}")
        for task in TASK_OF.values():
            subject.await_state(task, "ON")
        after = {t["task"]: t for t in subject.call("status")["tasks"]}
        for task in set(TASK_OF.values()) - {TASK_OF.get(victim)}:
            if after[task]["incarnation"] != before[task]["incarnation"] or \
                    after[task]["cycles"] < before[task]["cycles"]:
                faults.append(f"{task} began anew when {victim} died")
        return True

    def figures(self):
        return {"n": sum(self.deaths.values()), "counted": "deaths", **self.deaths, "longest_s": round(self.longest, 2)}


if __name__ == "__main__":
    sys.exit(campaigns.run("hostile_deaths", __doc__, Deaths))
