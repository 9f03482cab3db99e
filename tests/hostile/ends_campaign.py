# SPDX-License-Identifier: Apache-2.0
"""All bad ends in all methods in all executors, in random order: reported, judged, and without an effect on others. The
last line counts them. `lost_cycles`: deadlines that the other rtpu, on another CPU, missed and releases it lost.

usage: ends_campaign.py --build TREE --seconds N [--priority P]
"""
import argparse
import itertools
import json
import os
import random
import signal
import sys
import tempfile
import time

METHODS = ("init", "reinit", "on", "cycle", "off", "kill", "error", "clear", "sync")
WAYS = ("throw", "fault", "segv", "abort", "kill", "exit", "loop", "sleep", "late")
EXECUTORS = ("executive", "preemptive", "virtual", "virtual preemptive")
ENDLESS = ("loop", "sleep", "late")


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", required=True, help="the tree whose programs are tested")
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(1 << 32))
    parser.add_argument("--priority", default="0")
    return parser.parse_args()


class Case:
    def __init__(self, where, how, executor, priority):
        self.where, self.how, self.executor, self.priority = where, how, executor, priority
        self.lost = 0

    def run(self):
        return self.in_virtual_time() if self.executor.startswith("virtual") else self.in_real_time()

    def in_virtual_time(self):
        if self.how in ENDLESS and self.where not in ("off", "kill"):
            return  # a cycle may compute for long there: nothing ends it but Ctrl-C
        with tempfile.TemporaryDirectory() as place:
            words = ["--preemptive"] if self.executor.endswith("preemptive") else []
            if self.where == "reinit":
                words += ["--at", "20 ms: reinit bad"]
            if self.where == "clear":
                words += ["--at", "50 ms: clear bad"]
            component = "t_ends_event" if self.where == "sync" else "t_ends"
            process = ends.start_virtual(place, self.where, self.how, words, component)
            out, err = process.communicate(timeout=ends.HANG)
        assert process.returncode in (0, 1), (process.returncode, out, err)
        dies = self.how in ("segv", "abort", "kill", "exit")
        if dies or self.where in ("init", "on", "off", "kill"):  # an `on` that error() recovers from is OFF and refused
            assert process.returncode == 1, (out, err)
        if dies:
            assert f"in bad.{self.where}" in out + err, (out, err)
        if self.where in ("off", "kill"):
            assert "FAILED: bad: " in out + err and "may not be off" in out + err, (out, err)

    def in_real_time(self):
        component = "t_ends_event" if self.where == "sync" else "t_ends"
        text = ends.application([(self.executor, self.where, self.how)]).replace("component: t_ends,",
                                                                                f"component: {component},")
        text = text.replace("u0: {cpu: 0", "u0: {cpu: 1")
        with ends.System(text, ["--priority", self.priority]) as system:
            before = system.task("steady")
            self.misbehave(system)
            after = system.await_cycles("steady")
            assert (after["state"], after["incarnation"]) == ("ON", before["incarnation"]), after
            self.lost = sum(after[key] - before[key] for key in ("missed", "dropped"))
            self.end(system)

    def misbehave(self, system):
        first = {"init": ("off", "kill"), "on": ("off",), "kill": ("off",)}.get(self.where, ())
        for word in first:
            system.signal(word, "t0")
        since = system.next_event()
        system.arm()
        if self.where == "clear":
            system.await_state("t0", "ERROR")
        word = {"init": "spawn", "on": "on", "reinit": "reinit", "clear": "clear", "off": "off"}.get(self.where)
        if self.where == "kill" or (self.where == "init" and self.how in ENDLESS):
            return system.disarm()  # kill is judged at the end; an init that takes long is only told
        if word is not None:
            try:
                system.signal(word, "t0")
            except ends.Refused:
                pass
        text = system.await_event(since, "fault" if self.how in ("throw", "fault") else "rtpu-ended")["text"]
        if self.how in ENDLESS:
            assert "did not return within" in text and f"t0.{self.where}" in text, text
        system.disarm()
        ends.await_that(lambda: (u := system.rtpu("u0"))["phase"] == "serving" or u["given_up"], "recovery")

    def end(self, system):
        at_end = self.where in ("off", "kill")
        if at_end:
            if self.where == "off" and system.state("t0") == "OFF":
                system.signal("on", "t0")
            system.await_state("t0", "ON" if self.where == "off" else "OFF")
            system.arm()
        system.disconnect()
        system.process.send_signal(random.choice((signal.SIGTERM, signal.SIGINT)))
        code = system.wait()
        if at_end:
            said = system.said()
            assert code == 1 and "FAILED: t0: " in said and "may not be off" in said, (code, said)


def main():
    arguments = parse()
    os.environ["CHIMERA_BUILD"] = arguments.build
    global ends
    import ends_test as ends  # knows the tree when it is read
    random.seed(arguments.seed)
    cases = list(itertools.product(METHODS, WAYS, EXECUTORS))
    n = faults = lost = 0
    end = time.monotonic() + arguments.seconds
    while n == 0 or time.monotonic() < end:
        random.shuffle(cases)
        for where, how, executor in cases:
            if n and time.monotonic() >= end:
                break
            case = Case(where, how, executor, arguments.priority)
            n += 1
            try:
                case.run()
                lost += case.lost
            except Exception as fault:  # the campaign goes on
                faults += 1
                print(f"seed {arguments.seed}, {where} {how} {executor}: {fault!r}", flush=True)
    print(json.dumps({"name": "hostile_ends", "n": n, "faults": faults, "lost_cycles": lost}))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
