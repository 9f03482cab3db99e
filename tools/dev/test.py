# SPDX-License-Identifier: Apache-2.0
"""./dev test: compiles the trees, runs every test, and ends with one line that counts them."""
import argparse
import dataclasses
import fnmatch
import json
import os
import platform
import shutil
import subprocess
import sys
import time

import common
import machine_speed
import results
import stress
from results import FAILED, PASSED, SKIPPED, Case


@dataclasses.dataclass
class Share:
    """A part of the tests with its limit; `runs` are (tree, labels), the real-time ones alone on the machine."""
    name: str
    limit_min: float
    runs: tuple = ()


COMPILE = Share("compile", 12)
SHARES = (
    Share("units", 3, (("debug", "unit|hostile"), ("tsan", "threads"), ("release", "symbol|cost"))),
    Share("processes", 4, (("debug", "process"), ("release", "realtime"))),
    Share("firmware", 1, (("debug", "firmware"),)),
    Share("models", 2, (("debug", "model"),)),
)
QUICK = Share("quick", 2, (("debug", "unit"),))
TREES = ("debug", "tsan", "release")
TOTAL_LIMIT_MIN = 25
MAY_SKIP = common.ROOT / "tests" / "may_skip.txt"


def parse_arguments():
    parser = argparse.ArgumentParser(
        prog="./dev test", formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Builds and runs every test; the last line counts them. Exit 0 only if none failed.",
        epilog="shares and their limits in minutes: compile 12, "
               + ", ".join(f"{share.name} {share.limit_min}" for share in SHARES)
               + ";\nover one is an error where CI is set, else a remark; a machine that is slower than usual"
               + " has\nas much longer, but 25 for all"
               + "\nexamples: ./dev test --only units\n          ./dev test --quick")
    names = [share.name for share in SHARES]
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--only", metavar="SHARE", choices=names,
                       help="run one share; its trees are compiled first")
    group.add_argument("--quick", action="store_true",
                       help="all day, after each edit: compile what the unit tests of the debug tree run, run these")
    group.add_argument("--stress", nargs="*", metavar="MINUTES|NAME",
                       help="instead: the campaigns of tests/stress.txt, each MINUTES long (default 10)")
    return parser.parse_args()


def trees_of(shares):
    """The trees the shares need."""
    return [tree for tree in TREES if any(tree == run[0] for share in shares for run in share.runs)]


def on_build_machine():
    return os.environ.get("CI", "") not in ("", "false", "0")


def compile_trees(trees, quick=False):
    for tree in trees:
        targets = ("tests_quick",) if quick else () if tree == "debug" else ("tests_needed",)
        if not common.configure_with_tests(tree) or not common.compile_tree(tree, *targets):
            return False
    return True


def without_address_randomisation():
    """This compiler's thread sanitizer cannot use every memory map when addresses are randomised widely."""
    prefix = ["setarch", platform.machine(), "-R"]
    works = shutil.which("setarch") and subprocess.run(prefix + ["true"], capture_output=True).returncode == 0
    return prefix if works else []


def ctest(tree, labels, jobs):
    """Runs the tests of a tree that carry one of the labels. Returns their cases."""
    folder = common.BUILD / tree
    junit = folder / "results" / "ctest.xml"
    shutil.rmtree(junit.parent, ignore_errors=True)
    junit.parent.mkdir(parents=True)
    command = ["ctest", "--test-dir", f"build/{tree}", "-L", f"^({labels})$", "--no-tests=ignore", "--output-junit",
               str(junit), "--test-output-size-passed", "200000", "--test-output-size-failed", "1000000",
               "-j", str(jobs)]
    prefix = without_address_randomisation() if tree == "tsan" else []
    code = common.run_logged(prefix + command, folder / "ctest.log", r"\s*\d+/\d+ Test ")
    if not junit.exists():
        return [] if code == 0 else [Case(f"ctest in build/{tree}", FAILED, (folder / "ctest.log").read_text())]
    return results.read(junit, junit.parent)


def unlabelled(tree):
    """Tests of a tree that no share would ever run."""
    known = {label for share in SHARES for run in share.runs if run[0] == tree for label in run[1].split("|")}
    listing = subprocess.run(["ctest", "--test-dir", f"build/{tree}", "--show-only=json-v1"], cwd=common.ROOT,
                             capture_output=True, text=True, check=True)
    for test in json.loads(listing.stdout)["tests"]:
        labels = next((p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"), [])
        if not known & set(labels):
            yield Case(test["name"], FAILED, f"no share runs its labels {labels} in build/{tree}: it would never run")


def run_share(share, trees):
    cases, cpus = [], max(2, os.cpu_count() or 2)
    for tree, labels in share.runs:
        if tree not in trees:
            continue
        if labels == "realtime":
            with common.realtime_lock():
                cases += ctest(tree, labels, jobs=1)
        else:
            cases += ctest(tree, labels, jobs=cpus + 1 if "hostile" in labels else cpus)  # hostile ones wait a lot
    return cases or [Case(f"share {share.name}", FAILED, "it has no tests")]


def allowed_skips():
    """Lines of may_skip.txt: a test name (wildcards allowed), then the reason."""
    lines = (line.strip() for line in MAY_SKIP.read_text().splitlines())
    return [line.split(None, 1)[0] for line in lines if line and not line.startswith("#")]


def judge_skips(cases):
    """On the build machine a skip that nobody foresaw is a failure."""
    if not on_build_machine():
        return
    allowed = allowed_skips()
    for case in cases:
        if case.outcome == SKIPPED and not any(fnmatch.fnmatchcase(case.name, pattern) for pattern in allowed):
            case.outcome = FAILED
            case.said = f"skipped, and not listed in {MAY_SKIP.relative_to(common.ROOT)}: {case.said}"


def timed(share, seconds, cases, slower=1.0):
    """Prints the share's line. One that took too long is a failed case on the build machine, elsewhere a remark. Where
    the machine was slower than usual, by that factor, the share has as much more time (decision 0067)."""
    over = seconds > share.limit_min * 60 * slower
    counts = "" if share is COMPILE else f"  {len(cases)} tests"
    limit = clock(share.limit_min * 60) + (f" x {slower:.1f}, the machine is slow" if slower > 1.1 else "")
    remark = "" if not over else "  TOO LONG" if on_build_machine() else "  longer than its limit: with CI set an error"
    print(f"   {share.name:<10} {clock(seconds)} of {limit}{counts}{remark}", flush=True)
    if over and on_build_machine():
        cases.append(Case(f"share {share.name}", FAILED, f"took {clock(seconds)}, its limit is {limit}"))
    return cases


def clock(seconds):
    return f"{int(seconds) // 60:2d}:{int(seconds) % 60:02d}"


def finish(cases):
    """Failures with what they said, skips with their reasons, the count. Returns the exit code."""
    judge_skips(cases)
    for case in cases:
        if case.outcome == FAILED:
            lines = case.said.rstrip().splitlines()
            shown = lines if len(lines) <= 120 else lines[:60] + [f"... {len(lines) - 120} lines ..."] + lines[-60:]
            print(f"FAILED {case.name}\n    " + "\n    ".join(shown))
    for case in cases:
        if case.outcome == SKIPPED:
            print(f"skipped {case.name}: {case.said}")
    count = {outcome: sum(case.outcome == outcome for case in cases) for outcome in (PASSED, FAILED, SKIPPED)}
    print(f"{count[PASSED]} passed, {count[FAILED]} failed, {count[SKIPPED]} skipped", flush=True)
    return 1 if count[FAILED] or not count[PASSED] else 0


def run_tests(shares, quick=False):
    begin, before = time.monotonic(), machine_speed.slowness()
    trees = trees_of(shares)
    if not compile_trees(trees, quick):
        return finish([Case("compile", FAILED, "see above")])
    seconds, slower = time.monotonic() - begin, machine_speed.slowness()
    cases = timed(COMPILE, seconds, [], (before + slower) / 2)
    for tree in trees:
        cases += unlabelled(tree)
    for share in shares:
        common.step(f"running {share.name}")
        start = time.monotonic()
        found = run_share(share, trees)
        seconds, before, slower = time.monotonic() - start, slower, machine_speed.slowness()
        cases += timed(share, seconds, found, (before + slower) / 2)
    cases = timed(Share("total", TOTAL_LIMIT_MIN), time.monotonic() - begin, cases)
    if quick:
        print(f"left out, and run by `./dev test`: {left_out()}")
    return finish(cases)


def left_out():
    """What --quick does not run, as the shares have it."""
    runs = [(tree, label) for share in SHARES for tree, labels in share.runs for label in labels.split("|")]
    return ", ".join(f"{label} ({tree})" for tree, label in runs if (tree, label) not in QUICK.runs)


def main():
    arguments = parse_arguments()
    if arguments.stress is not None:
        return stress.main(arguments.stress)
    if arguments.quick:
        return run_tests([QUICK], quick=True)
    return run_tests([share for share in SHARES if arguments.only in (None, share.name)])


if __name__ == "__main__":
    sys.exit(main())
