# SPDX-License-Identifier: Apache-2.0
"""Lesson 17 with switches at random instants instead of the task that watches for singular poses: one receipt each, no
cycle lost, no step above its limit. In virtual time, where tasks that stay publish bit for bit what they publish
without a switch; with --real in real-time processes, beside a busy program on each processor. The last line counts
switches.

A switch in real time is judged if a witness above everything on the same processor was never later than a tenth of the
robot's period during the switch.

usage: switch_campaign.py --build TREE [--real] --seconds N
"""
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "hostile"))
import campaigns  # noqa: E402
from host_witness import HostWitness, any_stall  # noqa: E402

LESSON = ROOT / "examples" / "17_switch"
A_RUN = 500      # switches
A_REAL_RUN = 50
AROUND_S = 2e-3  # nor may the host stall so shortly before and after
CPU = 1          # of the lesson
FIRST_MS, GAP_MS = 200, (30, 130)
# Of tasks that stay and read nothing of the arm.
STAY = "ball, feature, is_in_picture, in_sight, received"


def description(folder):
    """The lesson without the task that asks, with a log of the tasks that stay."""
    text = (LESSON / "switch.yaml").read_text()
    text = text.replace("forward_kinematics, singularity, monitor", "forward_kinematics, monitor, log")
    text = text.replace("\nconfigurations:", f"""
  log:
    {{component: csv_log, rate: 1 kHz, alias: {{in: [{STAY}]}}, constants: {{capacity: 1000000}},
     resources: {{file: stay.csv}}}}
configurations:""")
    path = pathlib.Path(folder) / "switch.yaml"
    path.write_text(text)
    return path


def run(program, path, seconds, acts, is_real=False):
    """(report, what the tasks that stay published)"""
    words = [program, "run", str(path), "--for", f"{seconds} s", "--json"] + ([] if is_real else ["--virtual"])
    for at, target in acts:
        words += ["--at", f"{at:.3f} ms: switch {target}"]
    done = subprocess.run(words, cwd=path.parent, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0"})
    if done.returncode not in ((0, 1) if is_real else (0,)):  # 1: a deadline was missed, which is judged here
        raise SystemExit(f"exit {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return json.loads(done.stdout), (path.parent / "stay.csv").read_bytes()


def faults_of(number, receipt, act):
    wanted = {"number": number, "end": "done", "to": act[1]}
    found = [f"{number}: {key} is {receipt[key]}, {receipt['why']}" for key, value in wanted.items()
             if receipt[key] != value]
    found += [f"{number}: {task['task']} lost {task['lost']}" for task in receipt["tasks"] if task["lost"]]
    return found + [f"{number}: {variable}" for variable in receipt["variables"] if variable["beyond"]]


def faults(report, acts):
    found = []
    if len(report["receipts"]) != len(acts) or report["receipts_left_out"]:
        found.append(f"{len(report['receipts'])} receipts of {len(acts)} switches")
    for number, (receipt, act) in enumerate(zip(report["receipts"], acts), 1):
        found += faults_of(number, receipt, act)
    return found + [f"{task['task']}: {task['dropped']} dropped, {task['missed']} missed"
                    for task in report["tasks"] if task["dropped"] or task["missed"]]


def schedule(n, seed):
    """n switches there and back, and how long that takes in seconds."""
    chance = random.Random(seed)
    at, target, acts = FIRST_MS, "figure_8", []
    for _ in range(n):
        at += chance.uniform(*GAP_MS)
        target = {"figure_8": "figure_9", "figure_9": "figure_8"}[target]
        acts.append((at, target))
    return acts, round(at / 1e3 + 1, 1)


class Load:
    """A busy program on each processor, as an ordinary process."""

    def __enter__(self):
        self.busy = [subprocess.Popen(["taskset", "-c", str(cpu), sys.executable, "-c", "while True: pass"])
                     for cpu in range(os.cpu_count())]

    def __exit__(self, *_):
        for one in self.busy:
            one.kill()
            one.wait()


class Switches:
    """Each number is one run, with some switches."""

    def __init__(self, arguments):
        build = pathlib.Path(arguments.build).resolve()
        self.program, self.is_real = str(build / "bin/chimera"), arguments.real
        self.folder = tempfile.TemporaryDirectory()
        os.environ.setdefault("CHIMERA_PATH", str(build / "components"))
        os.environ["XDG_RUNTIME_DIR"] = os.environ["XDG_STATE_HOME"] = self.folder.name
        self.path, self.n, self.unjudged = description(self.folder.name), 0, 0

    def once(self, _):
        acts, seconds = schedule(A_REAL_RUN if self.is_real else A_RUN, random.randrange(1 << 32))
        return self.in_real_time(acts, seconds) if self.is_real else self.in_virtual_time(acts, seconds)

    def in_real_time(self, acts, seconds):
        with Load():
            witness = HostWitness(CPU)
            report, _ = run(self.program, self.path, seconds, acts, is_real=True)
            stalls, found = witness.stalls(), []
        if len(report["receipts"]) != len(acts):
            found.append(f"{len(report['receipts'])} receipts of {len(acts)} switches")
        for number, (receipt, act) in enumerate(zip(report["receipts"], acts), 1):
            begin, end = ((receipt["origin_ns"] + receipt[key]) / 1e9 for key in ("asked_ns", "ended_ns"))
            if any_stall(stalls, begin - AROUND_S, end + AROUND_S):
                self.unjudged += 1
            else:
                self.n += 1
                found += faults_of(number, receipt, act)
        return found

    def in_virtual_time(self, acts, seconds):
        report, switched = run(self.program, self.path, seconds, acts)
        self.n += len(acts)
        alone = run(self.program, self.path, seconds, [])[1]
        if switched == alone and switched.count(b"\n") >= seconds * 900:
            return faults(report, acts)
        return faults(report, acts) + ["the tasks that stay published something else, or not all: "
                                       f"{switched.count(10)} and {alone.count(10)} rows"]

    def figures(self):
        return {"n": self.n, "counted": "switches", **({"not_judged": self.unjudged} if self.is_real else {})}


if __name__ == "__main__":
    sys.exit(campaigns.run("switching_lesson" + "_real" * ("--real" in sys.argv), __doc__, Switches,
                           ("--real", {"action": "store_true", "help": "in real time"})))
