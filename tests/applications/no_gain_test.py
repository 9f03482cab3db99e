# SPDX-License-Identifier: Apache-2.0
"""The applications of the papers' figures are judged by what their robots do: each holds its bounds as it stands, and
fails them when the gain of its controller is zero. usage: no_gain_test.py PROGRAM EXAMPLES"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

FOLLOWS = ("max_distance <= 20 mm", "target_moved >= 0.1 m")
PASSES = ("max_distance <= 40 mm", "max_angle <= 1.5 deg", "max_error <= 20 mrad", "target_moved >= 0.1 m")
APPLICATIONS = {
    "10_teleoperation/rmms_a": FOLLOWS, "10_teleoperation/rmms_b": FOLLOWS,
    "11_another_robot/generic": FOLLOWS, "11_another_robot/closed_form": FOLLOWS,
    "12_by_itself/rmms": FOLLOWS, "12_by_itself/puma": FOLLOWS,
    "13_visual_servoing/inverse_kinematics": FOLLOWS, "13_visual_servoing/damped_least_squares": FOLLOWS,
    "15_singular_pose/damped_least_squares": PASSES, "17_switch/switch": PASSES, "19_standby/standby": FOLLOWS}
# Figure 8 past a singular pose: what the drives cannot follow.
BESIDE = "15_singular_pose/inverse_kinematics"
BESIDE_SAYS = ("holds: max_distance", "FAILS: max_angle", "FAILS: max_error", "holds: target_moved")


def run(program, description, folder, expected):
    words = [program, "run", str(description), "--virtual", "--for", "3.5 s"]
    for text in expected:
        words += ["--expect", text]
    done = subprocess.run(words, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0"})
    return done.returncode, done.stdout + done.stderr


def without_gain(text):
    changed, times = re.subn(r"gain: [1-9][0-9.]* 1/s", "gain: 0 1/s", text)
    return changed if times else None


def is_judged(program, description, expected):
    changed = without_gain(description.read_text())
    if changed is None:
        print(f"{description}: states no gain")
        return False
    with tempfile.NamedTemporaryFile("w", suffix=".yaml") as other:
        other.write(changed)
        other.flush()
        code, said = run(program, description, description.parent, expected)
        zero_code, zero_said = run(program, other.name, description.parent, expected)
    if code != 0:
        print(f"{description}: as it stands:\n{said}")
    stands_still = zero_code == 1 and "FAILS: max_distance" in zero_said and "holds: target_moved" in zero_said
    if not stands_still:
        print(f"{description}: with gain 0 (exit {zero_code}):\n{zero_said}")
    return code == 0 and stands_still


def main():
    program, examples = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
    failed = sum(not is_judged(program, examples / f"{name}.yaml", expected) for name, expected in APPLICATIONS.items())
    beside = examples / f"{BESIDE}.yaml"
    code, said = run(program, beside, beside.parent, PASSES)
    if code != 1 or any(text not in said for text in BESIDE_SAYS):
        print(f"{BESIDE} (exit {code}):\n{said}")
        failed += 1
    print(f"{len(APPLICATIONS) + 1 - failed} applications are judged by what they do, {failed} are not")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
