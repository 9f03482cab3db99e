# SPDX-License-Identifier: Apache-2.0
# Needs: process_campaigns
"""Row 15, with processes: from the command until `status` reports every task of four rtpus on two CPUs as ON.
The first cycle comes at the next release after that."""
import json
import os
import pathlib
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "tests" / "processes"))
from system import System  # noqa: E402

REPETITIONS = 15
GOAL_MS = 100
UNITS = "".join(f"  u{n}: {{cpu: {n % 2}, policy: edf}}\n" for n in range(4))
TASKS = "".join(f"  t{n}: {{component: t_source, rtpu: u{n}, rate: 1 kHz, alias: {{x: x{n}, expired: e{n}}}}}\n"
                for n in range(4))
TEXT = f"subsystem: subject\nrtpus:\n{UNITS}tasks:\n{TASKS}configurations: {{all: [t0, t1, t2, t3]}}\nstart: all\n"


def once():
    began = time.monotonic_ns()
    with System(TEXT, ("--priority", "80")) as system:
        return (system.call("status")["started_ns"] - began) / 1e6


times = [once() for _ in range(REPETITIONS)]
figure = statistics.median(times)
print(json.dumps({"row": 15, "what": f"run: command to all ON, 4 rtpus (max {max(times):.1f} ms)", "unit": "ms",
                  "figure": round(figure, 3), "goal": f"<= {GOAL_MS}", "met": figure <= GOAL_MS, "n": REPETITIONS}))
