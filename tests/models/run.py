#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the models exhaustively with SPIN: the correct ones must have no error, every mutant must be caught. With
--recorder the model of a switch must be able to make each recorded run of real rtpus (tests/switching), and none of
them with a change that breaks a rule. Prints states and seconds of each; exit 0 all as expected, 1 not, 77
when spin or a C compiler is missing.

usage: run.py [--recorder PROGRAM] [--only-recorded]"""
import argparse
import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

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
    ("slow_switch", ""),
    ("slow_switch", "COMMITS_ALONE"),
    ("slow_switch", "COMMIT_BLIND"),
    ("slow_switch", "ABORT_BLIND"),
    ("slow_switch", "LEFT_OUT_BLIND"),
    ("slow_switch", "LEFT_OUT_EARLY"),
    ("slow_switch", "LEFT_OUT_NEVER"),
    ("slow_switch", "TURNED_BY_ANY"),
    ("slow_switch", "TURNED_SHORT"),
    ("slow_switch", "FLAG_OF_ONE"),
    ("slow_switch", "FLAG_DOWN_EARLY"),
    ("slow_switch", "BACK_FORWARDS"),
    ("slow_switch", "REINIT_BACKWARDS"),
    ("slow_switch", "SPAWN_FIRST"),
    ("slow_switch", "KILL_UNDONE_FIRST"),
    ("slow_switch", "AGAIN_EARLY"),
    ("slow_switch", "DEATH_READ"),
    ("slow_switch", "BACK_EARLY"),
]

# Number of recorded runs of real rtpus, switches in each run, and the events that all runs together must have.
RECORDED, PLANS = 40, 3
SEEN = {"prepared by the manager", "armed", "proposed", "agreed", "committed", "adopted", "over", "aborted",
        "aborted by the manager", "died", "died by the manager", "filed by the manager"}


def explore(model, mutant, folder):
    """(errors, states) of one exhaustive search; a mutant's search ends at its first error."""
    define = [f"-D{mutant}"] if mutant else []
    run = {"cwd": folder, "check": True, "capture_output": True, "text": True}
    subprocess.run(["spin", *define, "-a", HERE / f"{model}.pml"], **run)
    level = "-O0" if mutant else "-O1"  # that of a mutant ends after less time than -O1 takes
    subprocess.run(["cc", level, "-w", "-DSAFETY", "-DCOLLAPSE", "-DMEMLIM=2048", "-o", "pan", "pan.c"], **run)
    output = subprocess.run(["./pan", "-m100000"], **(run | {"check": False})).stdout
    errors = re.search(r"errors: (\d+)", output)
    states = re.search(r"(\d+) states, stored", output)
    if not errors or not states or "max search depth too small" in output or "out of memory" in output:
        raise RuntimeError(f"{model} {mutant}: the search did not end:\n{output}")
    return int(errors[1]), int(states[1])


def build_follower(folder):
    """The model of a switch that follows a recorded run."""
    run = {"cwd": folder, "check": True, "capture_output": True, "text": True}
    subprocess.run(["spin", "-DRECORDED", f"-DPLANS={PLANS}", "-a", HERE / "switch.pml"], **run)
    subprocess.run(["cc", "-O1", "-w", "-DSAFETY", "-DNOREDUCE", "-DCOLLAPSE", "-DMEMLIM=1024", "-o", "pan", "pan.c",
                    HERE / "recorded_run.c"], **run)


def can_make(events, folder):
    """Whether the model has a run with exactly these events, in their order."""
    path = pathlib.Path(folder) / "run"
    path.write_text("\n".join(events) + "\n")
    done = subprocess.run(["./pan", "-m100000", "-E"], cwd=folder, env=dict(os.environ, RECORDED_RUN=str(path)),
                          capture_output=True, text=True)
    output = done.stdout
    if "errors: 1" in output and "assertion violated 0 " in output:
        return True
    if "errors: 0" not in output or "max search depth too small" in output or "out of memory" in output:
        raise RuntimeError(f"the search for a recorded run did not end:\n{output}{done.stderr}")
    return False


def moved(events, what, before):
    """The first event of that name from its place to before the last one of another name in front of it."""
    at = next(i for i, event in enumerate(events) if event.startswith(what))
    to = max(i for i in range(at) if events[i].startswith(before))
    return events[:to] + [events[at]] + events[to:at] + events[at + 1:]


# Runs that break a rule, made from a run without a death in which a switch was committed.
BROKEN = {
    "committed before the last has agreed": lambda events: moved(events, "committed", "agreed"),
    "proposed before all are armed": lambda events: moved(events, "proposed", "armed"),
    "adopted before the commit": lambda events: moved(events, "adopted", "committed"),
    "over before the last has adopted": lambda events: moved(events, "over", "adopted"),
    "filed before the last is over": lambda events: moved(events, "filed", "over"),
    "aborted after the commit": lambda events: [
        line for event in events for line in ([event, "aborted 2"] if event.startswith("committed") else [event])],
    "planned before the last is filed": lambda events: [event for event in events if not event.startswith("filed")]
        + ["prepared 2"],
    "one agrees twice": lambda events: [
        line for event in events for line in ([event] * 2 if event.startswith("agreed") else [event])],
}


def judge_recorded(recorder):
    """How many recorded runs are not judged as they should be."""
    wrong, seen, sound = 0, set(), None
    before = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        build_follower(folder)
        for seed in range(1, RECORDED + 1):
            done = subprocess.run([recorder, "--record", "--seed", str(seed)], capture_output=True, text=True)
            events = done.stdout.splitlines()
            if done.returncode != 0 or not events or not can_make(events, folder):
                wrong += 1
                print(f"recorded run {seed}: NOT ACCEPTED {' | '.join(events)} {done.stderr}")
                continue
            seen.update(event.rsplit(" ", 1)[0] + (" by the manager" if event.endswith(" 2") else "")
                        for event in events)
            is_sound = not any(event.startswith(("died", "aborted")) for event in events)
            if is_sound and sum(event.startswith("committed") for event in events) == PLANS:
                sound = sound or events
        for what in SEEN - seen:
            wrong += 1
            print(f"no recorded run has '{what}'")
        for what, broken in BROKEN.items():
            if sound is None or can_make(broken(sound), folder):
                wrong += 1
                print(f"recorded run with '{what}': NOT REJECTED")
    print(f"{RECORDED} runs of real rtpus, {len(BROKEN)} of them broken: {wrong} judged wrongly "
          f"{time.monotonic() - before:5.1f} s")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--recorder", help="tests/switching/switching_stress of a tree")
    parser.add_argument("--only-recorded", action="store_true")
    arguments = parser.parse_args()
    missing = [tool for tool in ("spin", "cc") if not shutil.which(tool)]
    if missing:
        print(f"skipped: {', '.join(missing)} not installed")
        return 77
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        work = [] if arguments.only_recorded else [pool.submit(judge, *case) for case in CASES]
        if arguments.recorder:
            work.append(pool.submit(judge_recorded, arguments.recorder))
        return 1 if sum(one.result() for one in work) else 0


def judge(model, mutant):
    """1 when the search did not end as it should."""
    before = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        errors, states = explore(model, mutant, folder)
    verdict = "caught" if mutant and errors else "NOT CAUGHT" if mutant else f"{errors} errors"
    name = f"{model} with {mutant}" if mutant else model
    print(f"{name:42} {verdict:10} {states:>10} states {time.monotonic() - before:5.1f} s")
    return (errors > 0) != bool(mutant)


sys.exit(main())
