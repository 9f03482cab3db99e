# SPDX-License-Identifier: Apache-2.0
# Needs: demo
"""Row 15: from `chimera run` to the first cycle. Measured from outside, so it is an upper bound: the whole command for
a run of 10 ms in real time, less those 10 ms; process start, library, verification, loading, init and end included."""
import json
import os
import statistics
import subprocess
import time

REPETITIONS = 21
GOAL_MS = 100
RUN_MS = 10


def once(program, description):
    began = time.monotonic()
    command = [program, "run", description, "--for", f"{RUN_MS} ms", "--json"]
    done = subprocess.run(command, capture_output=True, text=True)
    took = (time.monotonic() - began) * 1e3 - RUN_MS
    result = json.loads(done.stdout)
    assert done.returncode == 0 and all(task["cycles"] > 0 for task in result["tasks"]), done.stdout + done.stderr
    return took


program = os.path.join(os.environ["CHIMERA_BUILD"], "bin", "chimera")
description = os.path.join(os.environ["CHIMERA_SOURCE"], "examples", "01_puma_pid", "puma_pid.yaml")
times = [once(program, description) for _ in range(REPETITIONS)]
figure = statistics.median(times)
print(json.dumps({"row": 15, "what": "run: command to first cycle and back, less the run", "unit": "ms",
                  "figure": round(figure, 3), "goal": f"<= {GOAL_MS}", "met": figure <= GOAL_MS, "n": REPETITIONS}))
