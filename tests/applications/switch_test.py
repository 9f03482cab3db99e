# SPDX-License-Identifier: Apache-2.0
"""Lesson 17, judged by its own receipts over 8 periods of the target: figure 9 for each approach to the singular pose
and figure 8 for each way back, every switch done with one receipt, no cycle lost, no step above its limit. With a limit
below what the change really moves the receipts say so. usage: switch_test.py PROGRAM EXAMPLES"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

PERIOD, PERIODS = 8, 8  # s


def run(program, description, folder):
    words = [program, "run", str(description), "--virtual", "--for", f"{PERIOD * PERIODS} s", "--json"]
    done = subprocess.run(words, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0"})
    if done.returncode != 0:
        raise SystemExit(f"exit {done.returncode}\n{done.stdout}{done.stderr}")
    return json.loads(done.stdout)


def faults(receipts):
    found = []
    for number, receipt in enumerate(receipts, 1):
        away = number % 2 == 1
        wanted = {"number": number, "end": "done", "asked_by": {"task": "singularity"},
                  "from": "figure_8" if away else "figure_9", "to": "figure_9" if away else "figure_8"}
        found += [f"{number}: {key} is {receipt[key]}" for key, value in wanted.items() if receipt[key] != value]
        found += [f"{number}: {task['task']} lost {task['lost']}" for task in receipt["tasks"] if task["lost"]]
        for variable in receipt["variables"]:
            if variable["beyond"] or variable["variable"] == "q_ref" and variable["limit"] != 0.01:
                found.append(f"{number}: {variable}")
    return found


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve() / "17_switch"
    report = run(program, folder / "switch.yaml", folder)
    found = faults(report["receipts"])
    if len(report["receipts"]) != 2 * PERIODS or report["receipts_left_out"]:
        found.append(f"{len(report['receipts'])} receipts, {report['receipts_left_out']} left out")
    found += [f"{task['task']}: {task['dropped']} dropped, {task['missed']} missed"
              for task in report["tasks"] if task["dropped"] or task["missed"]]
    text = (folder / "switch.yaml").read_text()
    with tempfile.NamedTemporaryFile("w", suffix=".yaml") as other:
        other.write(text.replace("10 mrad", "1 mrad"))
        other.flush()
        steps = [variable["beyond"] for receipt in run(program, other.name, folder)["receipts"]
                 for variable in receipt["variables"] if variable["variable"] == "q_ref"]
        if True not in steps:
            found.append("a limit of 1 mrad is not noticed")
    print("\n".join(found) or f"{len(report['receipts'])} switches, as they should be")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
