# SPDX-License-Identifier: Apache-2.0
# Needs: demo component_gain_files
"""Row 18: what looking on costs the tasks. 100 tasks at 1 kHz on one real-time unit, run afresh for each window of 2 s:
alone, alone again (A/A), under `status` every 100 ms (what `chimera top` asks for), and under a tap of 100 variables
read as fast as it comes. The figure is the mean start delay in the window of the middle task, the start of the system
left out; median over the windows. Goal: no larger than in the worst window of the two controls."""
import json
import os
import pathlib
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "tests" / "processes"))
from system import System  # noqa: E402

WINDOWS = 6
SECONDS = 2
N = 100
TASKS = "".join(f"  t{n}: {{component: gain, rtpu: unit, rate: 1 kHz, alias: {{x: x, y: y{n}}}}}\n" for n in range(N))
TEXT = (f"subsystem: subject\nrtpus: {{unit: {{cpu: 1, policy: edf}}}}\ntasks:\n{TASKS}operator: {{x: 1}}\n"
        f"configurations: {{all: [{', '.join(f't{n}' for n in range(N))}]}}\nstart: all\n")
OBSERVERS = {"alone": None, "control": None, "status": {"to": "status", "period_ms": 100},
             "tap": {"to": "tap", "variables": [f"y{n}" for n in range(N)]}}


def delays(system):
    """Of each task: how many cycles, and the sum of their start delays in ns."""
    spreads = [task["start_delay_ns"] for task in system.call("profile")["tasks"]]
    return [(spread["count"], spread["count"] * spread.get("mean", 0)) for spread in spreads]


def window(subscription):
    """Start delay in us, and how many bytes the observer was sent."""
    with System(TEXT) as system:
        received, before = 0, delays(system)
        if subscription is not None:
            system.call("subscribe", **subscription)
        system.client.socket.settimeout(0.1)
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            try:
                received += len(system.client.socket.recv(1 << 20))
            except TimeoutError:
                pass
        system.disconnect()
        pairs = list(zip(before, delays(system)))
        assert all(after[0] - first[0] > SECONDS * 500 for first, after in pairs), "the tasks did not run"
        each = [(after[1] - first[1]) / (after[0] - first[0]) for first, after in pairs]
        return statistics.median(each) / 1e3, received


found = {name: [] for name in OBSERVERS}
for _ in range(WINDOWS):
    for name, asked in OBSERVERS.items():
        delay, size = window(asked)
        assert asked is None or size > 1000, f"{name}: only {size} bytes came"
        found[name].append(delay)
base = statistics.median(found["alone"] + found["control"])
worst = max(found["alone"] + found["control"])
spread = (worst - min(found["alone"] + found["control"])) / base
for name, what in (("status", "start delay under status at 100 ms"),
                   ("tap", "start delay under a tap of 100 variables")):
    figure = statistics.median(found[name])
    print(json.dumps({"row": 18, "what": what, "unit": "us", "figure": round(figure, 1), "baseline": round(base, 1),
                      "baseline_name": "nobody looks on", "limit": round(worst, 1), "ratio": round(figure / base, 3),
                      "goal": "within the A/A spread", "met": figure <= worst, "aa_spread": round(spread, 3),
                      "n": WINDOWS}))
