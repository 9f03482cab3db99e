# SPDX-License-Identifier: Apache-2.0
# Needs: process_campaigns hostile_campaigns
"""Row 21, the control server: the time from an act to its answer, beside the most costly questions that all other
connections may ask without a pause (tests/hostile/costly.py: checks of 256 joins in loops, schedules of 6 MB, the
library, the description, status, events, values), and beside the values of an application that has 3.9 MiB of them.
Baseline, in turn with it: the server without other clients. The clients run on the processors of the manager."""
import json
import os
import pathlib
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "tests" / "hostile"))
from costly import LARGE_VALUES, Load, worst, worst_of_values  # noqa: E402
from percentile import percentile  # noqa: E402
from system import TWO_RTPUS, System, await_that  # noqa: E402

GOAL_MS = 100
TURNS, ACTS = 5, 60  # an act each 25 ms: below the rate that one connection may have
WHAT = (("off, on", "signal", lambda n: {"signal": "on" if n % 2 else "off", "tasks": ["beside"]}),
        ("flag", "flag", lambda n: {"up": n % 2 == 0}))

def window(system, found):
    for n in range(ACTS):
        for what, method, parameters in WHAT:
            began = time.monotonic_ns()
            system.call(method, **parameters(n))
            found[what].append((time.monotonic_ns() - began) / 1e6)
            time.sleep(0.025)


def measure(description, asked, answers, name):
    alone, beside = {what: [] for what, _, _ in WHAT}, {what: [] for what, _, _ in WHAT}
    with System(description) as system:
        for _ in range(TURNS):
            window(system, alone)
            with Load(system.socket, asked) as load:
                await_that(lambda: load.answers > answers, "the load")
                window(system, beside)
    for what, _, _ in WHAT:
        figure, baseline = percentile(beside[what], 0.99), percentile(alone[what], 0.99)
        middle = statistics.median(beside[what])
        print(json.dumps({"row": 21, "what": f"{what} beside {name}, p99 (p50 {middle:.1f})", "unit": "ms",
                          "figure": round(figure, 2), "baseline": round(baseline, 2),
                          "baseline_name": f"no other client (p50 {statistics.median(alone[what]):.2f})",
                          "ratio": round(figure / baseline, 1), "goal": f"<= {GOAL_MS} ms", "met": figure <= GOAL_MS,
                          "n": len(beside[what])}))


measure(TWO_RTPUS, worst(), 100, "the worst load")
measure(LARGE_VALUES, worst_of_values(), 5, "large values")
