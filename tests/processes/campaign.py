# SPDX-License-Identifier: Apache-2.0
"""Repeats scripts of this folder for a time, each round with another seed; the last line says how often and what
failed.

usage: campaign.py NAME --build TREE --seconds N      (NAME: a line of CAMPAIGNS)
"""
import argparse
import json
import os
import pathlib
import random
import re
import subprocess
import sys
import time

# The scripts of each campaign with CHIMERA_ROUNDS for each, and the word of the count that they print; without a word
# the rounds are counted.
CAMPAIGNS = {
    "faults": ((("faults_test.py", 1), ("kills_campaign.py", 7)), None),
    "ending": ((("ending_test.py", 1), ("kills_campaign.py", 20)), "kills"),
    "exhaustion": ((("exhaustion_test.py", 0),), "failed calls"),
    "logging": ((("logging_test.py", 1),), None),
    "preemptive": ((("preemptive_test.py", 1),), "bad jobs"),
    "clocks": ((("clocks_test.py", 300),), "jumps"),
    "numbers": ((("numbers_test.py", 50),), "restarts"),
}
# Of the script that runs.
ROUNDS = int(os.environ.get("CHIMERA_ROUNDS", "1"))
SEED = int(os.environ.get("CHIMERA_SEED", str(random.SystemRandom().randrange(1 << 32))))


def begin():
    """Before a test that draws random numbers."""
    random.seed(SEED)
    print(f"seed {SEED}", file=sys.stderr)


def counted(word, n=1):
    print(f"{word}: {int(n)}", file=sys.stderr)


def total(word, output):
    return sum(int(n) for n in re.findall(rf"\b{word}: (\d+)\b", output))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name", choices=CAMPAIGNS)
    parser.add_argument("--build", required=True, help="the tree whose programs are tested")
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--seed", type=int, default=SEED)
    arguments = parser.parse_args()
    scripts, word = CAMPAIGNS[arguments.name]
    n = rounds = faults = 0
    end = time.monotonic() + arguments.seconds
    while rounds == 0 or time.monotonic() < end:
        seed = arguments.seed + rounds
        rounds += 1
        for script, repeats in scripts:
            environment = dict(os.environ, CHIMERA_BUILD=arguments.build, CHIMERA_SEED=str(seed),
                               CHIMERA_ROUNDS=str(repeats))
            done = subprocess.run([sys.executable, str(pathlib.Path(__file__).with_name(script))], env=environment,
                                  capture_output=True, text=True)
            n += total(word, done.stderr) if word else 0
            if done.returncode != 0:
                faults += 1
                print(f"round {rounds}, seed {seed}, {script}:\n{done.stdout}{done.stderr}", flush=True)
    print(json.dumps({"name": f"process_{arguments.name}", "n": n if word else rounds, "faults": faults,
                      "counted": word or "rounds", "rounds": rounds}))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
