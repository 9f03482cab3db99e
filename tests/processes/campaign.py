# SPDX-License-Identifier: Apache-2.0
"""Repeats a test of this folder for a time, each round with another seed; its last line says how often and what failed.

usage: campaign.py NAME --build TREE --seconds N      (NAME: faults, ending)
"""
import argparse
import json
import os
import pathlib
import random
import subprocess
import sys
import time


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name", choices=("faults", "ending"))
    parser.add_argument("--build", required=True, help="the tree whose programs are tested")
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(1 << 32))
    arguments = parser.parse_args()
    test = pathlib.Path(__file__).with_name(arguments.name + "_test.py")
    rounds = faults = 0
    end = time.monotonic() + arguments.seconds
    while rounds == 0 or time.monotonic() < end:
        seed = arguments.seed + rounds
        environment = dict(os.environ, CHIMERA_BUILD=arguments.build, CHIMERA_SEED=str(seed), CHIMERA_ROUNDS="3")
        done = subprocess.run([sys.executable, str(test)], env=environment, capture_output=True, text=True)
        rounds += 1
        if done.returncode != 0:
            faults += 1
            print(f"round {rounds}, seed {seed}:\n{done.stdout}{done.stderr}", flush=True)
    print(json.dumps({"name": f"process_{arguments.name}", "n": rounds, "faults": faults}))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
