# SPDX-License-Identifier: Apache-2.0
"""./dev bench: runs the rows one after another and sets what they measured beside their goals, or beside what the same
rows of another commit measure."""
import argparse
import json
import os
import platform
import subprocess
import sys

import against
import common
import rows

COLUMNS = (("row", "row"), ("what", "what"), ("figure", "figure"), ("baseline", "baseline"), ("limit", "limit"),
           ("ratio", "ratio"), ("goal", "goal"), ("met", "met"), ("aa_spread", "A/A"), ("n", "n"))
PAIRS = 8


def pair_count(text):
    if not text.isdigit() or not 1 <= int(text) <= 1000:
        raise argparse.ArgumentTypeError(f"'{text}' is no number of pairs from 1 to 1000")
    return int(text)


def parse_arguments():
    parser = argparse.ArgumentParser(
        prog="./dev bench", formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Runs the bench rows serially under the machine-wide real-time lock.",
        epilog="rows:\n" + "".join(f"  {row:<4} {path.stem.split('_', 2)[2].replace('_', ' ')}\n"
                                   for row, paths in rows.sources().items() for path in paths)
               + "\nexamples: ./dev bench 1 7 --json\n"
                 "          ./dev bench 7 --against main~1 --pairs 4")
    parser.add_argument("rows", nargs="*", type=int, metavar="ROW", help="numbers of rows; all without")
    parser.add_argument("--json", action="store_true", help="one JSON object instead of the table")
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--peers", action="store_true", help="install and measure the peers of rows 4 and 7 too")
    group.add_argument("--against", metavar="COMMIT", help="unpack and build that commit under build/against/ too, run "
                       "the rows of both in turn, and print both figures, the median ratio and its quartiles")
    parser.add_argument("--pairs", type=pair_count, metavar="N", help=f"with --against: pairs of runs ({PAIRS})")
    parser.add_argument("--record", action="store_true", help="with --against: add the figures to "
                        "bench/results/pairs.csv")
    arguments = parser.parse_args()
    if arguments.pairs and not arguments.against:
        parser.error("--pairs counts the pairs of --against COMMIT, which is missing")
    if arguments.record and not arguments.against:
        parser.error("--record keeps the figures of --against COMMIT, which is missing")
    arguments.pairs = arguments.pairs or PAIRS
    return arguments


def machine():
    model = platform.processor()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            model = next(line.split(":", 1)[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    compiler = subprocess.run(["g++", "-dumpfullversion"], capture_output=True, text=True).stdout.strip()
    return {"cpu": model, "cpus": os.cpu_count(), "kernel": platform.release(), "load": round(os.getloadavg()[0], 2),
            "compiler": f"g++ {compiler}", "commit": common.commit()}


def cell(figure, key):
    value = figure.get(key)
    if key == "met":
        return {True: "yes", False: "NO", None: "-"}[value]
    if key == "aa_spread" and value is not None:
        return f"{100 * value:.1f}%"
    if key == "baseline" and value is not None and figure.get("baseline_name"):
        return f"{rows.number(value)} {figure['baseline_name']}"
    return rows.number(value, figure.get("unit", "") if key == "figure" else "")


def table(figures):
    rows.print_table([title for _, title in COLUMNS], [[cell(figure, key) for key, _ in COLUMNS] for figure in figures])


def measure(programs, arguments):
    """(figures, number of programs that failed)"""
    figures, failed = [], 0
    with common.realtime_lock():
        for path in programs:
            if not arguments.json:
                common.step(path.stem)
            found = rows.run(path, arguments.peers)
            failed += found is None
            figures += found or []
    return figures, failed


def measured_alone(arguments, known):
    """(exit code, what the rows of this checkout measured)"""
    programs = rows.programs(known, arguments.rows, arguments.peers)
    built = (common.configure_with_tests("release") and
             (not arguments.peers or common.configure("release", "-DCHIMERA_PEERS=ON")) and
             common.compile_tree("release", *(rows.targets(programs) if arguments.rows else ["bench_rows"])))
    if not built:
        return 1, None
    figures, failed = measure(programs, arguments)
    return (1 if failed else 0), {"machine": machine(), "figures": figures}


def measured_against(arguments, known):
    try:
        return 0, {"machine": machine(), **against.result(arguments, known)}
    except against.Refused as refused:
        print(f"./dev: {refused}", file=sys.stderr)
        return refused.code, None


def show(found, arguments):
    if arguments.json:
        print(json.dumps(found, indent=1))
        return
    if arguments.against:
        against.show(found)
    else:
        table(found["figures"])
    print("machine: " + ", ".join(f"{key} {value}" for key, value in found["machine"].items()))


def main():
    arguments = parse_arguments()
    known = rows.sources()
    unknown = [row for row in arguments.rows if row not in known]
    if unknown or not known:
        there_are = ", ".join(map(str, sorted(known))) or "none"
        print(f"./dev: no row {', '.join(map(str, unknown))}; there are: {there_are}", file=sys.stderr)
        return 2
    output = sys.stdout
    if arguments.json:
        sys.stdout = sys.stderr  # steps are for people, standard output is the object
    try:
        code, found = (measured_against if arguments.against else measured_alone)(arguments, known)
    except KeyboardInterrupt:
        print("./dev: interrupted", file=sys.stderr)
        return 130
    sys.stdout = output
    if found:
        show(found, arguments)
        if arguments.record:
            against.record(found)
    return code


if __name__ == "__main__":
    sys.exit(main())
