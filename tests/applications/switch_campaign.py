# SPDX-License-Identifier: Apache-2.0
"""Lesson 17 with switches at random instants instead of the task that watches for singular poses, in virtual time: one
receipt each, no cycle lost, no step above its limit, and tasks that stay publish bit for bit what they publish without
a switch. The last line counts switches.

usage: switch_campaign.py --build TREE --seconds N
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

LESSON = ROOT / "examples" / "17_switch"
A_RUN = 500      # switches
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


def run(program, path, seconds, acts):
    """(report, what the tasks that stay published)"""
    words = [program, "run", str(path), "--for", f"{seconds} s", "--json", "--virtual"]
    for at, target in acts:
        words += ["--at", f"{at:.3f} ms: switch {target}"]
    done = subprocess.run(words, cwd=path.parent, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0"})
    if done.returncode != 0:
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


class Switches:
    """Each number is one run, with A_RUN switches."""

    def __init__(self, arguments):
        build = pathlib.Path(arguments.build).resolve()
        self.program, self.folder, self.n = str(build / "bin/chimera"), tempfile.TemporaryDirectory(), 0
        os.environ.setdefault("CHIMERA_PATH", str(build / "components"))
        os.environ["XDG_RUNTIME_DIR"] = os.environ["XDG_STATE_HOME"] = self.folder.name
        self.path = description(self.folder.name)

    def once(self, _):
        acts, seconds = schedule(A_RUN, random.randrange(1 << 32))
        report, switched = run(self.program, self.path, seconds, acts)
        self.n += len(acts)
        alone = run(self.program, self.path, seconds, [])[1]
        if switched == alone and switched.count(b"\n") >= seconds * 900:
            return faults(report, acts)
        return faults(report, acts) + ["the tasks that stay published something else, or not all: "
                                       f"{switched.count(10)} and {alone.count(10)} rows"]

    def figures(self):
        return {"n": self.n, "counted": "switches"}


if __name__ == "__main__":
    sys.exit(campaigns.run("switching_lesson", __doc__, Switches))
