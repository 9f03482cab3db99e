# SPDX-License-Identifier: Apache-2.0
"""./dev test --stress: runs campaigns for a time, prints n and the 95 % bound 3/n, keeps the record."""
import dataclasses
import datetime
import json
import re
import shlex
import subprocess

import common

LIST = common.ROOT / "tests" / "stress.txt"


@dataclasses.dataclass
class Campaign:
    """A line of tests/stress.txt."""
    name: str
    tree: str
    target: str
    command: list


def campaigns():
    found = []
    for line in LIST.read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            name, target, command = line.split(None, 2)
            tree, _, target = target.rpartition("/")
            tree = tree or "release"
            found.append(Campaign(name, tree, target, shlex.split(command.format(build=common.BUILD / tree))))
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


def build(chosen):
    """True when the targets of the campaigns are built, a tree at a time; ./dev installs what a tree needs."""
    trees = {}
    for campaign in chosen:
        trees.setdefault(campaign.tree, set()).add(campaign.target)
    return all(subprocess.run([common.ROOT / "dev", "build", tree, *sorted(targets)]).returncode == 0
               for tree, targets in trees.items())


def run(campaign, seconds):
    """One campaign. Returns its fault count, or None when it did not report."""
    name = campaign.name
    common.step(f"{name} for {seconds:g} s")
    process = subprocess.run(campaign.command + ["--seconds", f"{seconds:g}"], cwd=common.ROOT,
                             stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace")
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
    date = datetime.datetime.now(datetime.timezone.utc).date().isoformat()
    common.record("campaigns.csv", [(date, common.commit(), name, n, faults, "")])
    return faults if process.returncode == 0 else max(faults, 1)


def main(words):
    minutes, wanted = parse(words)
    known = campaigns()
    names = [campaign.name for campaign in known]
    unknown = [name for name in wanted if name not in names]
    if unknown or not known:
        print(f"./dev: no campaign '{' '.join(unknown)}' in {LIST.relative_to(common.ROOT)}; "
              f"there are: {', '.join(names) or 'none'}")
        return 2
    chosen = [campaign for campaign in known if not wanted or campaign.name in wanted]
    if not build(chosen):
        return 1
    outcomes = [run(campaign, minutes * 60) for campaign in chosen]
    return 0 if all(faults == 0 for faults in outcomes) else 1
