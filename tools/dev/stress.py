# SPDX-License-Identifier: Apache-2.0
"""./dev test --stress: runs campaigns for a time, prints n and the 95 % bound 3/n, keeps the record."""
import datetime
import json
import re
import shlex
import subprocess

import common

LIST = common.ROOT / "tests" / "stress.txt"
RECORD = common.ROOT / "docs" / "reliability.md"


def campaigns():
    """(name, target, command) of each line."""
    found = []
    for line in LIST.read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            name, target, command = line.split(None, 2)
            found.append((name, target, shlex.split(command.format(build=common.BUILD / "release"))))
    return found


def parse(words):
    """(minutes, names): [MINUTES] [NAME ...] in any order."""
    minutes, names = 10.0, []
    for word in words:
        if re.fullmatch(r"\d+(\.\d+)?", word):
            minutes = float(word)
        else:
            names.append(word)
    return minutes, names


def last_json(output):
    for line in reversed(output.strip().splitlines()):
        if line.startswith("{"):
            return json.loads(line)
    raise ValueError("no JSON line in its output")


def run(name, command, seconds):
    """One campaign. Returns its fault count, or None when it did not report."""
    common.step(f"{name} for {seconds:g} s")
    process = subprocess.run(command + ["--seconds", f"{seconds:g}"], cwd=common.ROOT, stdin=subprocess.DEVNULL,
                             capture_output=True, text=True, errors="replace")
    try:
        report = last_json(process.stdout)
        n, faults = int(report["n"]), int(report["faults"])
    except (ValueError, KeyError) as error:
        print(process.stdout + process.stderr + f"{name}: exit {process.returncode}, no usable report: {error}")
        return None
    bound = f"at 95 % confidence below {3 / n:.2g} per run" if faults == 0 and n else "no bound"
    print(f"   {name}: n = {n}, faults = {faults}, {bound}", flush=True)
    if faults:
        print(process.stdout + process.stderr)
    record(name, n, faults)
    return faults if process.returncode == 0 else max(faults, 1)


def record(name, n, faults):
    date = datetime.datetime.now(datetime.timezone.utc).date().isoformat()
    bound = f"{3 / n:.2g}" if faults == 0 and n else "-"
    with open(RECORD, "a", encoding="utf-8") as file:
        file.write(f"| {date} | {common.commit()} | {name} | {n} | {faults} | {bound} |\n")


def main(words):
    minutes, wanted = parse(words)
    known = [campaign[0] for campaign in campaigns()]
    unknown = [name for name in wanted if name not in known]
    if unknown or not known:
        print(f"./dev: no campaign '{' '.join(unknown)}' in {LIST.relative_to(common.ROOT)}; "
              f"there are: {', '.join(known) or 'none'}")
        return 2
    chosen = [campaign for campaign in campaigns() if not wanted or campaign[0] in wanted]
    if not common.configure_with_tests("release") or not common.compile_tree("release", *{c[1] for c in chosen}):
        return 1
    outcomes = [run(name, command, minutes * 60) for name, _, command in chosen]
    return 0 if all(faults == 0 for faults in outcomes) else 1
