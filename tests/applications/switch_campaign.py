# SPDX-License-Identifier: Apache-2.0
"""Lesson 17 with a hand that switches it at random instants instead of the task that watches for singular poses: one
receipt each, no cycle lost, no step above its limit. In virtual time, and who stays publishes bit for bit what it
publishes without any switch; with --real in real-time processes, beside a busy program on each processor. Its last
line says how many switches and how many faults.

A switch in real time is judged where a witness above everything on the same processor was never later than a tenth of
the robot's period meanwhile; else it is not judged, and there is another one, at most five for each that is.

usage: switch_campaign.py --build TREE [--real] [--seconds N | --switches N] [--seed N]
"""
import argparse
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "processes"))
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
    """The lesson, without who asks, with a log of who stays."""
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
    """(report, what who stays published)"""
    words = [program, "run", str(path), "--for", f"{seconds} s", "--json"] + ([] if is_real else ["--virtual"])
    for at, target in acts:
        words += ["--at", f"{at:.3f} ms: switch {target}"]
    done = subprocess.run(words, cwd=path.parent, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=600,
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


def real_trial(program, path, n, seed):
    """(faults, how many were judged)"""
    acts, seconds = schedule(n, seed)
    witness = HostWitness(CPU)
    report, _ = run(program, path, seconds, acts, is_real=True)
    stalls, found, judged = witness.stalls(), [], 0
    if len(report["receipts"]) != len(acts):
        found.append(f"{len(report['receipts'])} receipts of {len(acts)} switches")
    for number, (receipt, act) in enumerate(zip(report["receipts"], acts), 1):
        begin, end = ((receipt["origin_ns"] + receipt[key]) / 1e9 for key in ("asked_ns", "ended_ns"))
        if not any_stall(stalls, begin - AROUND_S, end + AROUND_S):
            judged += 1
            found += faults_of(number, receipt, act)
    return found, judged


def trial(program, path, n, seed):
    acts, seconds = schedule(n, seed)
    report, switched = run(program, path, seconds, acts)
    found = faults(report, acts)
    alone = run(program, path, seconds, [])[1]
    if switched != alone or switched.count(b"\n") < seconds * 900:
        found.append(f"who stays published something else, or not all: {switched.count(10)} and {alone.count(10)} rows")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True, help="the tree whose programs are tried")
    parser.add_argument("--real", action="store_true", help="in real time")
    parser.add_argument("--seconds", type=float, default=0)
    parser.add_argument("--switches", type=int, default=0, help="so many, in one run; in real time in several")
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(1 << 32))
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    os.environ.setdefault("CHIMERA_PATH", str(build / "components"))
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_RUNTIME_DIR"] = os.environ["XDG_STATE_HOME"] = folder
        done = (in_real_time if arguments.real else in_virtual_time)(arguments, str(build / "bin" / "chimera"),
                                                                     description(folder))
    print(json.dumps({"name": "switching_lesson" + "_real" * arguments.real, "counted": "switches", **done}))
    return 1 if done["faults"] else 0


def told(seed, found):
    if found:
        print(f"seed {seed}:\n" + "\n".join(found[:20]), flush=True)
    return len(found)


def in_virtual_time(arguments, program, path):
    n = wrong = rounds = 0
    end = time.monotonic() + arguments.seconds
    while rounds == 0 or time.monotonic() < end:
        seed = arguments.seed + rounds
        rounds += 1
        wrong += told(seed, trial(program, path, arguments.switches or A_RUN, seed))
        n += arguments.switches or A_RUN
    return {"n": n, "faults": wrong, "runs": rounds}


def in_real_time(arguments, program, path):
    n = wrong = runs = unjudged = 0
    end = time.monotonic() + arguments.seconds
    with Load():
        while n < arguments.switches or (not arguments.switches and time.monotonic() < end):
            found, judged = real_trial(program, path, A_REAL_RUN, arguments.seed + runs)
            wrong += told(arguments.seed + runs, found)
            n, unjudged, runs = n + judged, unjudged + A_REAL_RUN - judged, runs + 1
            if unjudged > 5 * (n + A_REAL_RUN):
                print(f"not judged: host stalled in {unjudged} of {n + unjudged} switches")
                break
    return {"n": n, "faults": wrong, "runs": runs, "not_judged": unjudged}


if __name__ == "__main__":
    sys.exit(main())
