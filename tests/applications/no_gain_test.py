# SPDX-License-Identifier: Apache-2.0
"""The applications of the papers' figures are judged by what their robots do: each holds its bound as it stands, and
fails it when the gain of its controller is zero. usage: no_gain_test.py PROGRAM EXAMPLES"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

EXPECTED = ("max_distance <= 20 mm", "target_moved >= 0.1 m")
APPLICATIONS = ("10_teleoperation/rmms_a", "10_teleoperation/rmms_b", "11_another_robot/generic",
                "11_another_robot/closed_form", "12_by_itself/rmms", "12_by_itself/puma",
                "13_visual_servoing/inverse_kinematics", "13_visual_servoing/damped_least_squares")


def run(program, description, folder):
    words = [program, "run", str(description), "--virtual", "--for", "3.5 s"]
    for text in EXPECTED:
        words += ["--expect", text]
    done = subprocess.run(words, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60,
                          env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0"})
    return done.returncode, done.stdout + done.stderr


def without_gain(text):
    changed, times = re.subn(r"gain: [1-9][0-9.]* 1/s", "gain: 0 1/s", text)
    return changed if times else None


def main():
    program, examples = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2])
    failed = 0
    for name in APPLICATIONS:
        description = (examples / f"{name}.yaml").resolve()
        changed = without_gain(description.read_text())
        if changed is None:
            print(f"{name}: states no gain")
            failed += 1
            continue
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as other:
            other.write(changed)
            other.flush()
            code, said = run(program, description, description.parent)
            zero_code, zero_said = run(program, other.name, description.parent)
        if code != 0:
            print(f"{name}: as it stands:\n{said}")
        if zero_code != 1 or "FAILS: max_distance" not in zero_said or "holds: target_moved" not in zero_said:
            print(f"{name}: with gain 0 (exit {zero_code}):\n{zero_said}")
            code = 1
        failed += code != 0
    print(f"{len(APPLICATIONS) - failed} applications are judged by what they do, {failed} are not")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
