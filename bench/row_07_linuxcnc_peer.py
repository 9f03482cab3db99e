# SPDX-License-Identifier: Apache-2.0
# Needs: row_07_executive
"""Row 7 against its peer: 201 tasks in the executive, 201 functions in one LinuxCNC HAL thread, both at 1 kHz.

Pairs of one second each, one after the other. Ours: the work of a wake by our own profile, divided by its jobs; each
job multiplies six values, is released, checked against its deadline, profiled, and publishes a group. Theirs:
`servo.time`, the thread's own measure in clock ticks, divided by 201; each function is one `ddt`, called through a
pointer, unchecked. HAL runs as an ordinary user without real-time rights, as it does where it was not set up for more.
"""
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

PAIRS = 5
FUNCTIONS = 201
NOBODY = 65534


def ours():
    program = os.path.join(os.environ["CHIMERA_BUILD"], "bench", "row_07_executive")
    said = subprocess.run([program, "--real-time"], capture_output=True, text=True, check=True).stdout
    clock = re.search(r"cycle counter at (\d+) MHz", said)
    if not clock:
        sys.exit(f"the cycle counter is not usable here, so ticks cannot be converted: {said}")
    return float(said.split()[0]), int(clock[1])


def hal_file():
    lines = ["loadrt threads name1=servo period1=1000000", f"loadrt ddt count={FUNCTIONS}"]
    lines += [f"addf ddt.{i} servo" for i in range(FUNCTIONS)]
    lines += ["start", "loadusr -w sleep 0.5"] + ["getp servo.time", "loadusr -w sleep 0.05"] * 10
    return "\n".join(lines + ["stop", "unloadrt all", ""])


def theirs(folder, mhz):
    """Nanoseconds per function: the median of ten readings."""
    as_user = {"user": NOBODY, "group": NOBODY, "extra_groups": []} if os.getuid() == 0 else {}
    done = subprocess.run(["halrun", "-f", str(folder / "201.hal")], cwd=folder, capture_output=True, text=True,
                          timeout=30, env={**os.environ, "HOME": str(folder)}, **as_user)
    ticks = [int(line) for line in done.stdout.splitlines() if line.strip().isdigit()]
    if len(ticks) != 10:
        sys.exit(f"halrun did not give ten readings:\n{done.stdout}{done.stderr}")
    return statistics.median(ticks) / FUNCTIONS * 1000 / mhz


if shutil.which("halrun") is None:
    print(json.dumps({"row": 7, "what": "201 jobs beside a LinuxCNC HAL thread: skipped, needs linuxcnc-uspace"}))
    sys.exit(0)
with tempfile.TemporaryDirectory() as name:
    place = pathlib.Path(name)
    place.chmod(0o777)
    (place / "201.hal").write_text(hal_file())
    pairs = []
    for _ in range(PAIRS):
        mine, rate = ours()
        pairs.append((mine, theirs(place, rate)))
ratios = sorted(mine / other for mine, other in pairs)
ratio = statistics.median(ratios)
print(json.dumps({"row": 7, "what": "201 tasks at 1 kHz in real time, per job", "unit": "ns",
                  "figure": round(statistics.median(mine for mine, _ in pairs), 2),
                  "baseline": round(statistics.median(other for _, other in pairs), 2),
                  "baseline_name": "a function of a LinuxCNC HAL thread", "ratio": round(ratio, 3),
                  "goal": "ratio <= 1", "met": ratio <= 1, "aa_spread": round((ratios[-1] - ratios[0]) / ratio, 3),
                  "n": PAIRS}))
