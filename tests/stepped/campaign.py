#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""SteppedChaos with one seed after the other: campaign.py --build TREE --seconds N"""
import argparse
import json
import os
import pathlib
import random
import subprocess
import sys
import time

parser = argparse.ArgumentParser()
parser.add_argument("--build", type=pathlib.Path, required=True)
parser.add_argument("--seconds", type=float, default=60)
arguments = parser.parse_args()
tree = arguments.build.resolve()
n = faults = 0
end = time.monotonic() + arguments.seconds
while time.monotonic() < end:
    seed = str(random.randrange(1, 2**48))
    environment = dict(os.environ, CHIMERA_SEED=seed, CHIMERA_BUILD=str(tree), ASAN_OPTIONS="detect_leaks=0",
                       CHIMERA_SOURCE=str(pathlib.Path(__file__).resolve().parents[2]))
    done = subprocess.run([tree / "tests/stepped/stepped_test", "--gtest_filter=SteppedChaos.*"], env=environment,
                          capture_output=True, text=True)
    n += 1
    if done.returncode != 0:
        faults += 1
        print(f"CHIMERA_SEED={seed}:\n{done.stdout[-3000:]}{done.stderr[-3000:]}", flush=True)
print(json.dumps({"name": "subsystem", "n": n, "faults": faults}))
sys.exit(faults != 0)
