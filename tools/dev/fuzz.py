# SPDX-License-Identifier: Apache-2.0
"""The campaign fuzz: mutates the committed corpus of every x_fuzz.cc for a time. First each target runs with its
planted defect, which it must find. The last line counts executions and faults.
Build first: ./dev build fuzz fuzz_targets"""
import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

import common

PLANTED_LIMIT = 30  # s; a planted defect is found in less


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, default=common.BUILD / "fuzz")
    parser.add_argument("--seconds", type=float, default=60)
    return parser.parse_args()


def sources():
    """Every x_fuzz.cc; its corpus is the folder x_corpus beside it."""
    return sorted(path for folder in ("chimera", "firmware") for path in (common.ROOT / folder).rglob("*_fuzz.cc"))


def corpus_of(source):
    return source.with_name(source.stem.removesuffix("_fuzz") + "_corpus")


def fuzz(program, corpus, seconds, *options):
    """Runs on a copy of the corpus, so that the committed one stays as it is; an input that fails is kept beside the
    program. Returns (exit code, what the program printed)."""
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder) / "corpus"
        shutil.copytree(corpus, copy)
        command = [str(program), str(copy), f"-max_total_time={max(1, round(seconds))}", "-print_final_stats=1",
                   "-timeout=5", "-rss_limit_mb=2048", f"-artifact_prefix={program}.found_", *options]
        process = subprocess.run(command, cwd=folder, env=dict(os.environ, CHIMERA_SOURCE=str(common.ROOT)),
                                 stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                 errors="replace")
        return process.returncode, process.stdout


def last_number(pattern, text):
    found = re.findall(pattern, text)
    return int(found[-1]) if found else 0


def executions(said):
    return max(last_number(r"stat::number_of_executed_units: (\d+)", said), last_number(r"^#(\d+)", said))


def judge(code, said):
    """Why a run without a planted defect is a fault; empty: it is none."""
    if code != 0:
        return f"exit {code}"
    return "" if executions(said) and last_number(r"cov: (\d+)", said) else "it executed nothing"


def judge_planted(code, said):
    return "" if code != 0 and "SUMMARY: " in said else "it did not find its planted defect"


def report(name, fault, said):
    print(f"{said}\n{name}: {fault}" if fault else f"{name}: {executions(said)} executions", flush=True)
    return 1 if fault else 0


def main():
    arguments = parse_arguments()
    programs = [(arguments.build.resolve() / "targets" / source.stem, corpus_of(source)) for source in sources()]
    begin, n, faults = time.monotonic(), 0, 0
    for program, corpus in programs:
        planted = program.with_name(program.name + "_planted")
        # With one seed the mutations are the same on every machine, and a slow machine finds the defect too.
        code, said = fuzz(planted, corpus, PLANTED_LIMIT, "-seed=1")
        faults += report(planted.name, judge_planted(code, said), said)
    left = arguments.seconds - (time.monotonic() - begin)
    for program, corpus in programs:
        code, said = fuzz(program, corpus, left / len(programs))
        n += executions(said)
        faults += report(program.name, judge(code, said), said)
    print(json.dumps({"name": "fuzz", "n": n, "faults": faults}))
    return 1 if faults or not n else 0


if __name__ == "__main__":
    sys.exit(main())
