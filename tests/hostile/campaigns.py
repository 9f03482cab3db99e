# SPDX-License-Identifier: Apache-2.0
"""The frame of the campaigns of this folder: again and again for a time, with a seed, and a line of JSON at the end."""
import argparse
import json
import os
import pathlib
import random
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "processes"))


def run(name, doc, begin, *options):
    """`begin(arguments)` makes an object with once(number), which gives a list of what is wrong, and figures(), a dict
    for the last line, which may have "n". `options`: more of the command line, as (name, arguments of argparse).
    Modules that need CHIMERA_BUILD are imported by `begin`. Returns the exit code."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True, help="the tree whose programs are tested")
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(1 << 32))
    for option, more in options:
        parser.add_argument(option, **more)
    arguments = parser.parse_args()
    os.environ["CHIMERA_BUILD"] = arguments.build
    random.seed(arguments.seed)
    campaign, n, faults, end = begin(arguments), 0, 0, time.monotonic() + arguments.seconds
    while n == 0 or time.monotonic() < end:
        for wrong in campaign.once(n):
            faults += 1
            print(f"seed {arguments.seed}, number {n}: {wrong}", flush=True)
        n += 1
    print(json.dumps({"name": name, "n": n, "faults": faults, "seed": arguments.seed, **campaign.figures()}))
    return 1 if faults else 0
