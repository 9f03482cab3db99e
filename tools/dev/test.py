# SPDX-License-Identifier: Apache-2.0
"""./dev test: compiles the trees, runs every test, and ends with one line that counts them."""
import argparse
import dataclasses
import fnmatch
import hashlib
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import time

import common
import results
import stress
from results import FAILED, PASSED, SKIPPED, Case


@dataclasses.dataclass
class Share:
    """A part of the tests; `runs` are (tree, labels), the real-time ones alone on the machine."""
    name: str
    runs: tuple = ()


SHARES = (
    Share("units", (("debug", "unit|program|hostile"), ("tsan", "threads"), ("release", "symbol|cost"))),
    Share("processes", (("debug", "process"), ("release", "realtime"))),
    Share("page", (("debug", "page"),)),
    Share("firmware", (("debug", "firmware"),)),
    Share("models", (("debug", "model"),)),
)
QUICK = Share("quick", (("debug", "unit"),))
TREES = ("debug", "tsan", "release")
# The result of these tests can depend on the scheduling of threads: a test that fails runs again, at most twice.
SCHEDULED = {"threads", "process", "hostile", "page", "realtime"}
MOST_TRIES = 3
DURATIONS = common.BUILD / "durations.jsonl"
PASSED_BEFORE = common.BUILD / "debug" / "passed.json"
MAY_SKIP = common.ROOT / "tests" / "may_skip.txt"


def parse_arguments():
    parser = argparse.ArgumentParser(
        prog="./dev test", formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Builds and runs every test; the last line counts them. Exit 0 only if none failed.",
        epilog="shares: " + ", ".join(share.name for share in SHARES)
               + "\nA test that runs threads or processes runs again when it fails, at most twice; one that passes then"
               + "\nis printed as `flaky: NAME` and counted. Durations are printed and added to build/durations.jsonl;"
               + "\nno test fails for them."
               + "\nexamples: ./dev test --only units\n          ./dev test --quick")
    names = [share.name for share in SHARES]
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--only", metavar="SHARE", choices=names,
                       help="run one share; its trees are compiled first")
    group.add_argument("--quick", action="store_true",
                       help="after each edit: compile the unit tests of the debug tree, run those that changed")
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


def ctest(tree, labels, jobs, only=()):
    """Runs the tests of a tree that carry one of the labels, or of these the named ones. Returns their cases."""
    folder = common.BUILD / tree
    junit = folder / "results" / "ctest.xml"
    shutil.rmtree(junit.parent, ignore_errors=True)
    junit.parent.mkdir(parents=True)
    command = ["ctest", "--test-dir", f"build/{tree}", "-L", f"^({labels})$", "--no-tests=ignore", "--output-junit",
               str(junit), "--test-output-size-passed", "200000", "--test-output-size-failed", "1000000",
               "-j", str(jobs)]
    if only:
        command += ["-R", "^(" + "|".join(map(re.escape, only)) + ")$"]
    prefix = without_address_randomisation() if tree == "tsan" else []
    code = common.run_logged(prefix + command, folder / "ctest.log", r"\s*\d+/\d+ Test ")
    if not junit.exists():
        return [] if code == 0 else [Case(f"ctest in build/{tree}", FAILED, (folder / "ctest.log").read_text())]
    return results.read(junit, junit.parent)


def ctest_again(tree, labels, cases):
    """Runs what failed and touches real scheduling again, alone, at most MOST_TRIES times in all. Returns the cases of
    the last try of each program; a case that failed before and passes now says so in `flaky`."""
    scheduled = [label for label in labels.split("|") if label in SCHEDULED]
    for _ in range(MOST_TRIES - 1):
        failed = {case.program for case in cases if case.outcome == FAILED}
        failed = sorted(name for name, its in tests_of(tree) if name in failed and set(its) & set(scheduled)) \
            if failed and scheduled else []
        if not failed:
            break
        common.step(f"again, of build/{tree}: {' '.join(failed)}")
        cases = results.merge(cases, ctest(tree, "|".join(scheduled), 1, failed), failed)
    return cases


def tests_of(tree):
    """(name, labels) of each test of a tree."""
    listing = subprocess.run(["ctest", "--test-dir", f"build/{tree}", "--show-only=json-v1"], cwd=common.ROOT,
                             capture_output=True, text=True, check=True)
    for test in json.loads(listing.stdout)["tests"]:
        yield test["name"], next((p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"), [])


def state_of(paths):
    """Hash of the times and sizes of these files: it changes when one of them does."""
    found = {}
    for path in paths:
        try:
            status = os.stat(path)
            found[str(path)] = (status.st_mtime_ns, status.st_size)
        except OSError:
            found[str(path)] = None
    return hashlib.sha256(repr(sorted(found.items())).encode()).hexdigest()


def unchanged_tests(tree):
    """State of each test program of the tree: its file, the components that tests load, the data that tests read. Those
    whose state is the one with which they passed last. A test that is a script has no state: it runs each time."""
    listed = subprocess.run(["git", "-c", "safe.directory=*", "ls-files", "-co", "--exclude-standard"], cwd=common.ROOT,
                            capture_output=True, text=True, check=True).stdout.splitlines()
    data = state_of([common.ROOT / name for name in listed if not name.endswith((".cc", ".h", ".py"))]
                    + sorted((common.BUILD / tree / "components").glob("*.so")))
    programs = {path.name: path for path in (common.BUILD / tree).rglob("*_test") if path.is_file()}
    states = {name: data + state_of([path]) for name, path in programs.items()}
    passed = json.loads(PASSED_BEFORE.read_text()) if PASSED_BEFORE.exists() else {}
    return states, {name for name, state in states.items() if passed.get(name) == state}


def run_changed(tree, labels):
    """The cases of the tests that are not as they were when they passed last."""
    states, unchanged = unchanged_tests(tree)
    names = [name for name, its in tests_of(tree) if set(its) & set(labels.split("|")) and name not in unchanged]
    skipped = sorted(name for name, its in tests_of(tree) if set(its) & set(labels.split("|")) and name in unchanged)
    cases = ctest(tree, labels, max(2, os.cpu_count() or 2), names)
    bad = {case.program for case in cases if case.outcome == FAILED}
    passed = {name: states[name] for name in [*names, *skipped] if name in states and name not in bad}
    PASSED_BEFORE.write_text(json.dumps(passed))
    if skipped:
        print(f"unchanged since they passed: {', '.join(skipped)}")
    return cases


def unlabelled(tree):
    """Tests of a tree that no share would ever run."""
    known = {label for share in SHARES for run in share.runs if run[0] == tree for label in run[1].split("|")}
    for name, labels in tests_of(tree):
        if not known & set(labels):
            yield Case(name, FAILED, f"no share runs its labels {labels} in build/{tree}: it would never run")


def run_share(share, trees):
    cases, cpus = [], max(2, os.cpu_count() or 2)
    for tree, labels in share.runs:
        if tree not in trees:
            continue
        if labels == "realtime":
            with common.realtime_lock():
                found = ctest_again(tree, labels, ctest(tree, labels, jobs=1))
        else:  # hostile ones wait a lot
            found = ctest_again(tree, labels, ctest(tree, labels, jobs=cpus + 1 if "hostile" in labels else cpus))
        cases += found
    return cases or [Case(f"share {share.name}", FAILED, "it has no tests")]


def allowed_skips():
    """Lines of may_skip.txt: a test name (wildcards allowed), then the reason."""
    lines = (line.strip() for line in MAY_SKIP.read_text().splitlines())
    return [line.split(None, 1)[0] for line in lines if line and not line.startswith("#")]


def judge_skips(cases):
    """On the build machine a skip that tests/may_skip.txt does not list is a failure."""
    if not on_build_machine():
        return
    allowed = allowed_skips()
    for case in cases:
        if case.outcome == SKIPPED and not any(fnmatch.fnmatchcase(case.name, pattern) for pattern in allowed):
            case.outcome = FAILED
            case.said = f"skipped, and not listed in {MAY_SKIP.relative_to(common.ROOT)}: {case.said}"


def timed(name, seconds, n_tests=None):
    """Prints how long a part took, and adds it to the record."""
    print(f"   {name:<10} {clock(seconds)}" + ("" if n_tests is None else f"  {n_tests} tests"), flush=True)
    entry = {"at": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()), "commit": common.commit(), "part": name,
             "seconds": round(seconds, 1)}
    with open(DURATIONS, "a", encoding="utf-8") as file:
        file.write(json.dumps(entry) + "\n")


def clock(seconds):
    return f"{int(seconds) // 60:2d}:{int(seconds) % 60:02d}"


def shown(said):
    """The lines of an output, the middle of a long one left out."""
    lines = said.rstrip().splitlines()
    if len(lines) > 120:
        lines = lines[:60] + [f"... {len(lines) - 120} lines ..."] + lines[-60:]
    return "\n    ".join(lines)


def finish(cases):
    """Failures and flaky ones with what they said, skips with their reasons, the count. Returns the exit code."""
    judge_skips(cases)
    for case in cases:
        if case.outcome == FAILED:
            print(f"FAILED {case.name}\n    {shown(case.said)}")
        elif case.flaky:
            print(f"flaky: {case.name}\n    {shown(case.flaky)}")
    for case in cases:
        if case.outcome == SKIPPED:
            print(f"skipped {case.name}: {case.said}")
    count = {outcome: sum(case.outcome == outcome for case in cases) for outcome in (PASSED, FAILED, SKIPPED)}
    n_flaky = sum(bool(case.flaky) for case in cases)
    print(f"{count[PASSED]} passed, {count[FAILED]} failed, {count[SKIPPED]} skipped"
          + (f", {n_flaky} flaky" if n_flaky else ""), flush=True)
    return 1 if count[FAILED] or not count[PASSED] else 0


def run_tests(shares, quick=False):
    begin = time.monotonic()
    trees = trees_of(shares)
    if not compile_trees(trees, quick):
        return finish([Case("compile", FAILED, "see above")])
    timed("compile", time.monotonic() - begin)
    cases = []
    for tree in trees:
        cases += unlabelled(tree)
    for share in shares:
        common.step(f"running {share.name}")
        start = time.monotonic()
        found = run_changed(*QUICK.runs[0]) if quick else run_share(share, trees)
        timed(share.name, time.monotonic() - start, len(found))
        cases += found
    timed("total", time.monotonic() - begin)
    if quick:
        print(f"left out, and run by `./dev test`: {left_out()}")
    return finish(cases)


def left_out():
    """Tests that --quick leaves out, by share."""
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
