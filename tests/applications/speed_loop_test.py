# SPDX-License-Identifier: Apache-2.0
"""A loop of generic blocks holds its bounds as it stands, and not with one of them put out of order; gains in another
unit are refused before it runs. usage: speed_loop_test.py PROGRAM"""
import os
import pathlib
import subprocess
import sys
import tempfile

LOOP = pathlib.Path(__file__).parent / "speed_loop.yaml"
# At 6.5 s the reference has stepped to 105 rad/s for the fourth time, 0.5 s ago, and the loop has arrived seven times.
# The friction takes half of the speed: 105 rad/s need 15.75 V.
EXPECTED = ("turning >= 104.8 rad/s", "turning <= 105.2 rad/s", "voltage >= 15.5 V", "voltage <= 16 V", "arrivals >= 7",
            "arrivals <= 7", "errors <= 0")
# One change in the text each, and what must be told then.
BROKEN = (
    ("ki: 4 V/rad", "ki: 0 V/rad", "FAILS: turning >= 104.8 rad/s"),
    ("high: 24 V", "high: 12 V", "FAILS: turning >= 104.8 rad/s"),
    ("weight: [1, -1]", "weight: [1, -0.9]", "FAILS: voltage >= 15.5 V"),
    ("trim: 5 rad/s", "trim: 4 rad/s", "FAILS: turning >= 104.8 rad/s"),
    ("200 rad/s], value: [-100 rad/s, 0 rad/s, 100 rad/s]", "200 rad/s], value: [-100 rad/s, 0 rad/s, 90 rad/s]",
     "FAILS: voltage >= 15.5 V"),
    ("when: inside", "when: above", "FAILS: arrivals >= 7"),
    ("stopped: false", "stopped: true", "FAILS: arrivals >= 7"),
    ("duration: 20 ms", "of: both", "FAILS: arrivals <= 7"),
    ("reset: false", "reset: true", "FAILS: arrivals >= 7"),
    ("counts: 4096", "counts: 4000", "FAILS: turning >= 104.8 rad/s"),
    ("kp: 0.2 V.s/rad", "kp: 0.2 N.m.s/rad", "V.s/rad"),
    ("reference_weight: 0.7", "reference_weight: 7", "reference_weight"),
    ("at: [-200 rad/s, 0 rad/s", "at: [0 rad/s, 0 rad/s", "each point of at must be above the one before"),
)


def run(program, text):
    with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
        file.write(text)
        file.flush()
        words = [program, "run", file.name, "--virtual", "--for", "6.5 s"]
        for expected in EXPECTED:
            words += ["--expect", expected]
        done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def main():
    program, text = os.path.abspath(sys.argv[1]), LOOP.read_text()
    code, said = run(program, text)
    failed = [] if code == 0 else [f"as it stands (exit {code}):\n{said}"]
    for found, instead, wanted in BROKEN:
        assert text.count(found) == 1, found
        code, said = run(program, text.replace(found, instead))
        if code != 1 or wanted not in said:
            failed.append(f"with '{instead}' it does not say '{wanted}' (exit {code}):\n{said}")
    print("\n".join(failed) or f"holds its bounds, and fails in {len(BROKEN)} ways")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
