# SPDX-License-Identifier: Apache-2.0
"""All bad ends in all methods in all executors, in random order: reported, judged, and without an effect on others. The
last line counts them. `lost_cycles`: deadlines that the other rtpu, on another CPU, missed and releases it lost.

usage: ends_campaign.py --build TREE --seconds N [--priority P]
"""
import itertools
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile

import campaigns

METHODS = ("init", "reinit", "on", "cycle", "off", "kill", "error", "clear", "sync")
WAYS = ("throw", "fault", "segv", "abort", "kill", "exit", "loop", "sleep", "late")
EXECUTORS = ("executive", "preemptive", "virtual", "virtual preemptive")
ENDLESS = ("loop", "sleep", "late")


def start_virtual(place, where, how, arguments, component):
    """A run in virtual time, with one task `bad`."""
    import system
    armed = pathlib.Path(place) / "armed"
    armed.touch()
    file = pathlib.Path(place) / f"{where}-{how}{''.join(arguments)}.yaml"
    file.write_text("subsystem: subject\nrtpus: {one: {cpu: 0, policy: edf}}\ntasks:\n"
                    f"  bad: {{component: {component}, rtpu: one, rate: 100 Hz, "
                    f"constants: {{where: {where}, how: {how}}}, resources: {{armed: {armed}}}}}\n")
    return subprocess.Popen([str(system.CHIMERA), "run", str(file), "--virtual", "--for", "100 ms", *arguments],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            env=dict(os.environ, ASAN_OPTIONS=system.QUIET))


class Ends:
    def __init__(self, arguments):
        import ends_test
        import system
        self.ends, self.system, self.priority, self.lost, self.cases = ends_test, system, arguments.priority, 0, []

    def once(self, _):
        if not self.cases:
            self.cases = list(itertools.product(METHODS, WAYS, EXECUTORS))
            random.shuffle(self.cases)
        self.where, self.how, self.executor = self.cases.pop()
        try:
            self.in_virtual_time() if self.executor.startswith("virtual") else self.in_real_time()
        except Exception as fault:  # noqa: BLE001 - the campaign goes on
            return [f"{self.where} {self.how} {self.executor}: {fault!r}"]
        return []

    def figures(self):
        return {"lost_cycles": self.lost}

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
            process = start_virtual(place, self.where, self.how, words, component)
            out, err = process.communicate(timeout=self.system.HANG)
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
        text = self.ends.application([(self.executor, self.where, self.how)])
        text = text.replace("component: t_ends,", f"component: {component},").replace("u0: {cpu: 0", "u0: {cpu: 1")
        with self.system.System(text, ["--priority", self.priority]) as system:
            before = system.task("steady")
            self.misbehave(system)
            after = system.await_cycles("steady")
            assert (after["state"], after["incarnation"]) == ("ON", before["incarnation"]), after
            self.lost += sum(after[key] - before[key] for key in ("missed", "dropped"))
            self.end(system)

    def misbehave(self, system):
        for word in {"init": ("off", "kill"), "on": ("off",), "kill": ("off",)}.get(self.where, ()):
            system.signal(word, "t0")
        since = system.next_event()
        system.arm()
        if self.where == "clear":
            system.await_state("t0", "ERROR")
        word = {"init": "spawn", "on": "on", "reinit": "reinit", "clear": "clear", "off": "off"}.get(self.where)
        if self.where == "kill" or (self.where == "init" and self.how in ENDLESS):
            return system.disarm()  # kill is judged at the end; an init that takes long is only reported
        if word is not None:
            try:
                system.signal(word, "t0")
            except self.system.Refused:
                pass
        text = system.await_event(since, "fault" if self.how in ("throw", "fault") else "rtpu-ended")["text"]
        if self.how in ENDLESS:
            assert f"t0.{self.where} did not return within" in text or f"t0.{self.where} used" in text, text
        system.disarm()
        self.system.await_that(lambda: (u := system.rtpu("u0"))["phase"] == "serving" or u["given_up"], "recovery")

    def end(self, system):
        if at_end := self.where in ("off", "kill"):
            if self.where == "off" and system.state("t0") == "OFF":
                system.signal("on", "t0")
            system.await_state("t0", "ON" if self.where == "off" else "OFF")
            system.arm()
        system.disconnect()
        system.process.send_signal(random.choice((signal.SIGTERM, signal.SIGINT)))
        code, said = system.wait(), system.said()
        if at_end:
            assert code == 1 and "FAILED: t0: " in said and "may not be off" in said, (code, said)


if __name__ == "__main__":
    sys.exit(campaigns.run("hostile_ends", __doc__, Ends, ("--priority", {"default": "0"})))
