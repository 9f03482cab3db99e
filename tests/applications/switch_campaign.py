# SPDX-License-Identifier: Apache-2.0
"""Lesson 17 with a hand that switches it at random instants of virtual time instead of the task that watches for
singular poses: one receipt each, no cycle lost, no step above its limit, and who stays publishes bit for bit what it
publishes without any switch. Its last line says how many switches and how many faults.

usage: switch_campaign.py --build TREE [--seconds N | --switches N] [--seed N]
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
LESSON = ROOT / "examples" / "17_switch"
A_RUN = 500      # switches
FIRST_MS, GAP_MS = 200, (30, 130)
# Of tasks that stay and read nothing of the arm.
STAY = "ball, feature, is_in_picture, in_sight, received"


def description(folder):
    """The lesson, without who asks, with a log of who stays, and where the lesson itself goes back: clear of the
    singular pose and slow. Elsewhere exact kinematics leap to what the others lag behind, and the receipt says so."""
    text = (LESSON / "switch.yaml").read_text()
    text = text.replace("forward_kinematics, singularity, monitor", "forward_kinematics, monitor, log")
    text = text.replace("\nconfigurations:", f"""
  log:
    {{component: csv_log, rate: 1 kHz, alias: {{in: [{STAY}]}}, constants: {{capacity: 1000000}},
     resources: {{file: stay.csv}}}}
configurations:""")
    for before, after in (("-0.05 m, 0.293 m", "0.17 m, 0.293 m"), ("[0 m, 0.25 m, 0 m]", "[0 m, 0.03 m, 0 m]")):
        assert text.count(before) == 1, before
        text = text.replace(before, after)
    path = pathlib.Path(folder) / "switch.yaml"
    path.write_text(text)
    return path


def run(program, path, seconds, acts):
    """(report, what who stays published)"""
    words = [program, "run", str(path), "--virtual", "--for", f"{seconds} s", "--json"]
    for at, target in acts:
        words += ["--at", f"{at:.3f} ms: switch {target}"]
    done = subprocess.run(words, cwd=path.parent, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=600,
                          env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0"})
    if done.returncode != 0:
        raise SystemExit(f"exit {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return json.loads(done.stdout), (path.parent / "stay.csv").read_bytes()


def faults(report, acts):
    found = []
    if len(report["receipts"]) != len(acts) or report["receipts_left_out"]:
        found.append(f"{len(report['receipts'])} receipts of {len(acts)} switches")
    for number, (receipt, act) in enumerate(zip(report["receipts"], acts), 1):
        wanted = {"number": number, "end": "done", "to": act[1]}
        found += [f"{number}: {key} is {receipt[key]}, {receipt['why']}" for key, value in wanted.items()
                  if receipt[key] != value]
        found += [f"{number}: {task['task']} lost {task['lost']}" for task in receipt["tasks"] if task["lost"]]
        found += [f"{number}: {variable}" for variable in receipt["variables"] if variable["beyond"]]
    return found + [f"{task['task']}: {task['dropped']} dropped, {task['missed']} missed"
                    for task in report["tasks"] if task["dropped"] or task["missed"]]


def trial(program, path, n, seed):
    chance = random.Random(seed)
    at, target, acts = FIRST_MS, "figure_8", []
    for _ in range(n):
        at += chance.uniform(*GAP_MS)
        target = {"figure_8": "figure_9", "figure_9": "figure_8"}[target]
        acts.append((at, target))
    seconds = round(at / 1e3 + 1, 1)
    report, switched = run(program, path, seconds, acts)
    found = faults(report, acts)
    alone = run(program, path, seconds, [])[1]
    if switched != alone or switched.count(b"\n") < seconds * 900:
        found.append(f"who stays published something else, or not all: {switched.count(10)} and {alone.count(10)} rows")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True, help="the tree whose programs are tried")
    parser.add_argument("--seconds", type=float, default=0)
    parser.add_argument("--switches", type=int, default=0, help="so many, in one run")
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(1 << 32))
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    os.environ.setdefault("CHIMERA_PATH", str(build / "components"))
    n = wrong = rounds = 0
    end = time.monotonic() + arguments.seconds
    with tempfile.TemporaryDirectory() as folder:
        path = description(folder)
        while rounds == 0 or time.monotonic() < end:
            seed = arguments.seed + rounds
            rounds += 1
            found = trial(str(build / "bin" / "chimera"), path, arguments.switches or A_RUN, seed)
            n += arguments.switches or A_RUN
            wrong += len(found)
            if found:
                print(f"seed {seed}:\n" + "\n".join(found[:20]), flush=True)
    print(json.dumps({"name": "switching_lesson", "n": n, "faults": wrong, "counted": "switches", "runs": rounds}))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
