# SPDX-License-Identifier: Apache-2.0
"""Random deaths of any process of a subsystem beside two clients that ask all the time: each call of a client ends, each
process but the keeper has a successor, the tasks of the others go on, and in the end nothing is left. One death in
fifty is that of the keeper; another subsystem is then started. The last line counts the deaths and has the longest call.

usage: deaths_campaign.py --build TREE --seconds N [--most N]
"""
import argparse
import json
import os
import pathlib
import random
import subprocess
import sys
import threading
import time

PROCESSES = pathlib.Path(__file__).resolve().parents[1] / "processes"
BUDGET, SPAN = 3, 10.0  # an rtpu is started again at most 3 times in 10 s

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
TASK_OF = {"first": "a", "second": "b", "third": "c", "fourth": "d"}


class Asker(threading.Thread):
    """Asks until the end; counts answers and has the longest duration of a call."""

    def __init__(self, name, ask):
        super().__init__(name=name, daemon=True)
        self.ask, self.answers, self.unanswered, self.longest = ask, 0, 0, 0.0
        self.faults, self.over = [], threading.Event()

    def run(self):
        while not self.over.is_set():
            begun = time.monotonic()
            try:
                self.ask()
                self.answers += 1
            except Exception as wrong:  # noqa: BLE001 - the subject may be gone
                self.unanswered += 1
                if not isinstance(wrong, OSError) or isinstance(wrong, TimeoutError):
                    self.faults.append(f"{self.name}: {wrong!r}")
                time.sleep(0.01)
            self.longest = max(self.longest, time.monotonic() - begun)

    def end(self):
        self.over.set()
        self.join(processes.HANG)
        if self.is_alive():
            self.faults.append(f"{self.name}: its last call has not ended after {processes.HANG} s")


def answered_in_its_turn(client, method, parameters):
    while True:
        try:
            return client.call(method, **parameters)
        except processes.Refused as refusal:
            if "the analysis failed: its process ended by signal 9" in str(refusal):
                return None  # the analyst was killed, and that is said
            if refusal.code != processes.TOO_FAST:
                raise
            time.sleep(refusal.data["retry_ms"] / 1e3)


def by_protocol(system):
    def ask():
        client = processes.Client(system.socket)
        try:
            for method, parameters in QUESTIONS:
                answered_in_its_turn(client, method, parameters)
        finally:
            client.close()
    return ask


def by_command(system):
    def ask():
        words = [str(processes.CHIMERA), "status", "--subsystem", "subject", "--json"]
        done = subprocess.run(words, capture_output=True, text=True, env=system.environment, timeout=processes.HANG)
        if done.returncode != 0:
            raise OSError(json.loads(done.stdout)["error"]["message"])  # else it says nothing, or not in JSON
        json.loads(done.stdout)
    return ask


class Subject:
    """One subsystem, until its keeper dies or `until`."""

    def __init__(self, campaign):
        self.campaign, self.dice = campaign, campaign.dice
        self.deaths_of = {name: [] for name in TASK_OF}

    def victims(self, pids):
        now = time.monotonic()
        found = ["manager", "manager"]
        for name, instants in self.deaths_of.items():
            if name in pids and sum(now - instant < 1.2 * SPAN for instant in instants) < BUDGET:
                found.append(name)
        if self.analyst(pids):
            found.append("analyst")
        return found

    def analyst(self, pids):
        return next((pid for pid in self.system.named("chimera-analyst") if pid not in pids.values()), None)

    def run(self):
        with processes.System(TEXT) as self.system:
            askers = [Asker("protocol", by_protocol(self.system)), Asker("command", by_command(self.system))]
            for asker in askers:
                asker.start()
            try:
                while self.campaign.goes_on() and self.death():
                    pass
            finally:
                for asker in askers:
                    asker.end()
            self.campaign.note(askers)
            if self.system.process.poll() is None:
                self.system.process.terminate()
                self.system.wait()
            self.system.await_nothing_left()

    def death(self):
        """One death and what follows; False when it was that of the keeper."""
        pids = self.system.pids()
        before = {t["task"]: t for t in self.system.call("status")["tasks"]}
        if self.dice.random() < 0.02:
            return self.keeper_dies(pids["keeper"])
        victim = self.dice.choice(self.victims(pids))
        pid = self.analyst(pids) if victim == "analyst" else pids[victim]
        time.sleep(self.dice.random() * 0.05)
        if pid is None or not processes.kill(pid, self.system.marker):
            return True
        self.campaign.deaths[victim if victim in ("manager", "analyst") else "rtpu"] += 1
        if victim in self.deaths_of:
            self.deaths_of[victim].append(time.monotonic())
        if victim != "analyst":
            self.system.disconnect()
            processes.await_that(lambda: self.system.pids().get(victim, pid) != pid, f"another {victim}")
        for task in TASK_OF.values():
            self.system.await_state(task, "ON")
        self.judge(before, TASK_OF.get(victim))
        return True

    def judge(self, before, died):
        """Tasks of the others went on, without a new beginning."""
        after = {t["task"]: t for t in self.system.call("status")["tasks"]}
        for name in TASK_OF.values():
            if name == died:
                continue  # it began anew in another process
            if after[name]["incarnation"] != before[name]["incarnation"]:
                self.campaign.faults.append(f"{name} began anew though {died or 'no task'} died")
            if after[name]["cycles"] < before[name]["cycles"]:
                self.campaign.faults.append(f"{name} lost count of its cycles")

    def keeper_dies(self, pid):
        processes.kill(pid, self.system.marker)
        self.campaign.deaths["keeper"] += 1
        self.system.wait()
        return False


class Campaign:
    def __init__(self, seconds, most, seed):
        self.end, self.most, self.dice = time.monotonic() + seconds, most, random.Random(seed)
        self.deaths = {"manager": 0, "rtpu": 0, "analyst": 0, "keeper": 0}
        self.faults, self.answers, self.unanswered, self.longest = [], [0, 0], [0, 0], [0.0, 0.0]
        self.subjects = 0

    def n(self):
        return sum(self.deaths.values())

    def goes_on(self):
        return self.n() < self.most and time.monotonic() < self.end and len(self.faults) < 20

    def note(self, askers):
        for i, asker in enumerate(askers):
            self.answers[i] += asker.answers
            self.unanswered[i] += asker.unanswered
            self.longest[i] = max(self.longest[i], asker.longest)
            self.faults += asker.faults

    def run(self):
        while self.subjects == 0 or self.goes_on():
            self.subjects += 1
            try:
                Subject(self).run()
            except AssertionError as wrong:
                self.faults.append(str(wrong))
        for fault in self.faults[:50]:
            print(fault, flush=True)
        print(json.dumps({"name": "hostile_deaths", "n": self.n(), "faults": len(self.faults), "counted": "deaths",
                          **self.deaths, "subsystems": self.subjects, "answers": self.answers,
                          "unanswered": self.unanswered, "longest_s": [round(s, 2) for s in self.longest]}))
        return 1 if self.faults else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", required=True, help="the tree whose programs are killed")
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--most", type=int, default=1 << 30, help="deaths, after which it ends")
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(1 << 32))
    arguments = parser.parse_args()
    os.environ["CHIMERA_BUILD"] = arguments.build
    sys.path.insert(0, str(PROCESSES))
    global processes
    import system as processes
    return Campaign(arguments.seconds, arguments.most, arguments.seed).run()


if __name__ == "__main__":
    sys.exit(main())
