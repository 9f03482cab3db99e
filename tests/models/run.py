#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the models exhaustively with SPIN: the correct ones must have no error, every mutant must be caught.
Prints states and seconds of each; exit 0 all as expected, 1 not, 77 when spin or a C compiler is missing."""
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
# model, definition of the mutant ("" is the correct one)
CASES = [
    ("register", ""),
    ("register", "ACCEPT_N_MINUS_1"),
    ("register", "PUBLISH_FIRST"),
    ("outbox", ""),
    ("outbox", "PUBLISH_FIRST"),
    ("outbox", "FREE_FIRST"),
    ("outbox", "ONE_TOO_MANY"),
    ("outbox", "FROM_THE_START"),
    ("outbox", "ANY_INCARNATION"),
    ("switch", ""),
    ("switch", "NO_AGREEMENT"),
    ("switch", "LATE_GOES_ON"),
    ("switch", "OFF_EARLY"),
    ("switch", "FREED_EARLY"),
    ("switch", "NO_PROOF"),
    ("switch", "JOURNAL_LATE"),
    ("switch", "ARMED_STAYS"),
    ("switch", "TWO_PLANS"),
]


def explore(model, mutant, folder):
    """(errors, states) of one exhaustive search; a mutant's search ends at its first error."""
    define = [f"-D{mutant}"] if mutant else []
    run = {"cwd": folder, "check": True, "capture_output": True, "text": True}
    subprocess.run(["spin", *define, "-a", HERE / f"{model}.pml"], **run)
    subprocess.run(["cc", "-O1", "-w", "-DSAFETY", "-DCOLLAPSE", "-DMEMLIM=2048", "-o", "pan", "pan.c"], **run)
    output = subprocess.run(["./pan", "-m100000"], **(run | {"check": False})).stdout
    errors = re.search(r"errors: (\d+)", output)
    states = re.search(r"(\d+) states, stored", output)
    if not errors or not states or "max search depth too small" in output or "out of memory" in output:
        raise RuntimeError(f"{model} {mutant}: the search did not end:\n{output}")
    return int(errors[1]), int(states[1])


def main():
    missing = [tool for tool in ("spin", "cc") if not shutil.which(tool)]
    if missing:
        print(f"skipped: {', '.join(missing)} not installed")
        return 77
    wrong = 0
    for model, mutant in CASES:
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        with tempfile.TemporaryDirectory() as folder:
            errors, states = explore(model, mutant, folder)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        as_expected = (errors > 0) == bool(mutant)
        wrong += not as_expected
        verdict = "caught" if mutant and errors else "NOT CAUGHT" if mutant else f"{errors} errors"
        name = f"{model} with {mutant}" if mutant else model
        print(f"{name:42} {verdict:10} {states:>10} states {seconds:5.1f} s CPU")
    return 1 if wrong else 0


sys.exit(main())
