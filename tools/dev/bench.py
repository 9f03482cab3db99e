# SPDX-License-Identifier: Apache-2.0
"""./dev bench: runs the rows one after another and sets what they measured beside their goals."""
import argparse
import json
import os
import platform
import re
import subprocess
import sys

import common

FOLDER = common.ROOT / "bench"
COLUMNS = (("row", "row"), ("what", "what"), ("figure", "figure"), ("baseline", "baseline"), ("limit", "limit"),
           ("ratio", "ratio"), ("goal", "goal"), ("met", "met"), ("aa_spread", "A/A"), ("n", "n"))


def parse_arguments():
    parser = argparse.ArgumentParser(
        prog="./dev bench", formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Runs the bench rows serially under the machine-wide real-time lock.",
        epilog="rows:\n" + "".join(f"  {row:<4} {path.stem.split('_', 2)[2].replace('_', ' ')}\n"
                                   for row, paths in sources().items() for path in paths)
               + "\nexample: ./dev bench 1 7 --json")
    parser.add_argument("rows", nargs="*", type=int, metavar="ROW", help="numbers of rows; all without")
    parser.add_argument("--json", action="store_true", help="one JSON object instead of the table")
    parser.add_argument("--peers", action="store_true", help="install and measure the peers of rows 4 and 7 too")
    return parser.parse_args()


def sources():
    """{row number: [source]}; a row may have several programs."""
    found = {}
    for path in sorted(FOLDER.glob("row_*")):
        match = re.fullmatch(r"row_(\d+)_\w+\.(cc|py)", path.name)
        if match:
            found.setdefault(int(match[1]), []).append(path)
    return found


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


def run(path, peers):
    """The figures of one program. None when it failed; what it said has been printed."""
    tree = common.BUILD / "release"
    command = ["/usr/bin/python3", str(path)] if path.suffix == ".py" else [str(tree / "bench" / path.stem)]
    environment = dict(os.environ, CHIMERA_BUILD=str(tree), CHIMERA_SOURCE=str(common.ROOT),
                       CHIMERA_PEERS="1" if peers else "0")
    done = subprocess.run(command, cwd=common.ROOT, env=environment, stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, errors="replace")
    figures = []
    for line in done.stdout.splitlines():
        if line.startswith("{"):
            figures.append(json.loads(line))
    if done.returncode == 0 and figures:
        return figures
    print(done.stdout + done.stderr + f"{path.name}: exit {done.returncode}, {len(figures)} figures", file=sys.stderr)
    return None


def cell(figure, key):
    value = figure.get(key)
    if key == "met":
        return {True: "yes", False: "NO", None: "-"}[value]
    if value is None or value == "":
        return "-"
    if key == "aa_spread":
        return f"{100 * value:.1f}%"
    text = f"{value:.4g}" if isinstance(value, float) else str(value)
    if key == "figure":
        return f"{text} {figure.get('unit', '')}".rstrip()
    if key == "baseline" and figure.get("baseline_name"):
        return f"{text} {figure['baseline_name']}"
    return text


def table(figures):
    rows = [[title for _, title in COLUMNS]] + [[cell(figure, key) for key, _ in COLUMNS] for figure in figures]
    widths = [max(len(row[i]) for row in rows) for i in range(len(COLUMNS))]
    for row in rows:
        print("  ".join(text.ljust(width) for text, width in zip(row, widths)).rstrip())


def measure(programs, arguments):
    """(figures, number of programs that failed)"""
    figures, failed = [], 0
    with common.realtime_lock():
        for path in programs:
            if not arguments.json:
                common.step(path.stem)
            found = run(path, arguments.peers)
            failed += found is None
            figures += found or []
    return figures, failed


def main():
    arguments = parse_arguments()
    known = sources()
    unknown = [row for row in arguments.rows if row not in known]
    if unknown or not known:
        there_are = ", ".join(map(str, sorted(known))) or "none"
        print(f"./dev: no row {', '.join(map(str, unknown))}; there are: {there_are}", file=sys.stderr)
        return 2
    programs = [path for row in (arguments.rows or sorted(known)) for path in known[row]
                if arguments.peers or not path.stem.endswith("_peer")]
    output = sys.stdout
    if arguments.json:
        sys.stdout = sys.stderr  # steps are for people, standard output is the object
    built = (common.configure_with_tests("release") and
             (not arguments.peers or common.configure("release", "-DCHIMERA_PEERS=ON")) and
             common.compile_tree("release", "bench_rows"))
    if not built:
        return 1
    figures, failed = measure(programs, arguments)
    sys.stdout = output
    if arguments.json:
        print(json.dumps({"machine": machine(), "figures": figures}, indent=1))
    else:
        table(figures)
        print("machine: " + ", ".join(f"{key} {value}" for key, value in machine().items()))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
