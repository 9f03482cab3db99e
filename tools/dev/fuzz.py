# SPDX-License-Identifier: Apache-2.0
"""Runs a libFuzzer target from a committed corpus for a time; with --planted the target must find its defect."""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--corpus", type=pathlib.Path, required=True)
    parser.add_argument("--seconds", type=int, default=8)
    parser.add_argument("--planted", action="store_true", help="the target has a planted defect: finding it is success")
    return parser.parse_args()


def fuzz(arguments, folder):
    """Runs in `folder` on a copy of the corpus, so that the committed one stays as it is."""
    corpus = folder / "corpus"
    shutil.copytree(arguments.corpus, corpus)
    command = [str(arguments.program.resolve()), str(corpus), f"-max_total_time={arguments.seconds}",
               "-print_final_stats=1", "-timeout=5", "-rss_limit_mb=2048", f"-artifact_prefix={folder}/found_"]
    if arguments.planted:
        command.append("-seed=1")  # so many executions, on every machine: a slow one does not find it less
    return subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          errors="replace")


def last_number(pattern, text):
    found = re.findall(pattern, text)
    return int(found[-1]) if found else 0


def judge(arguments, process):
    """Exit code and the line that says why."""
    said = process.stdout + process.stderr
    executions = max(last_number(r"stat::number_of_executed_units: (\d+)", said), last_number(r"^#(\d+)", said))
    edges = last_number(r"cov: (\d+)", said)
    counted = f"{arguments.program.name}: {executions} executions, {edges} edges"
    crashed = process.returncode != 0 and "SUMMARY: " in said
    if arguments.planted:
        return (0, f"{counted}, the planted defect was found") if crashed else (1, f"{counted}, NOT found:\n{said}")
    if process.returncode != 0 or not executions or not edges:
        return 1, f"{said}\n{counted}, exit {process.returncode}"
    return 0, counted


def main():
    arguments = parse_arguments()
    if not arguments.corpus.is_dir() or not any(arguments.corpus.iterdir()):
        print(f"no corpus in {arguments.corpus}")
        return 1
    with tempfile.TemporaryDirectory() as folder:
        process = fuzz(arguments, pathlib.Path(folder))
        code, line = judge(arguments, process)
    print(line)
    return code


if __name__ == "__main__":
    sys.exit(main())
