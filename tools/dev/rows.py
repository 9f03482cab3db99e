# SPDX-License-Identifier: Apache-2.0
"""The rows of bench/: their programs, what must be built for them, and the figures that one run prints."""
import json
import os
import re
import subprocess
import sys

import common


def sources(root=common.ROOT):
    """{row number: [source]}; a row may have several programs."""
    found = {}
    for path in sorted((root / "bench").glob("row_*")):
        match = re.fullmatch(r"row_(\d+)_\w+\.(cc|py)", path.name)
        if match:
            found.setdefault(int(match[1]), []).append(path)
    return found


def programs(known, wanted, peers=False):
    """The sources of the wanted rows, all without, in the order of the rows asked."""
    found = [path for row in (wanted or sorted(known)) for path in known[row]]
    return [path for path in found if peers or not path.stem.endswith("_peer")]


def targets(paths):
    """What ninja must build before these run: the programs themselves and what their `Needs:` lines name."""
    found = {path.stem for path in paths if path.suffix == ".cc"}
    for path in paths:
        for line in re.findall(r"^(?://|#) Needs: +(.*)$", path.read_text(encoding="utf-8"), re.MULTILINE):
            found |= set(line.split())
    return sorted(found)


def run(path, peers=False, root=common.ROOT):
    """The figures of one program of the tree at `root`. None when it failed; what it said has been printed."""
    tree = root / "build" / "release"
    command = ["/usr/bin/python3", str(path)] if path.suffix == ".py" else [str(tree / "bench" / path.stem)]
    environment = dict(os.environ, CHIMERA_BUILD=str(tree), CHIMERA_SOURCE=str(root),
                       CHIMERA_PEERS="1" if peers else "0")
    done = subprocess.run(command, cwd=root, env=environment, stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, errors="replace")
    figures = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode == 0 and figures:
        return figures
    print(done.stdout + done.stderr + f"{path.name}: exit {done.returncode}, {len(figures)} figures", file=sys.stderr)
    return None


def number(value, unit=""):
    """A figure as the tables show it; '-' for none."""
    if value is None or value == "":
        return "-"
    return f"{value:.4g} {unit}".rstrip() if isinstance(value, float) else f"{value} {unit}".rstrip()


def print_table(titles, lines):
    table = [titles] + lines
    widths = [max(len(line[i]) for line in table) for i in range(len(titles))]
    for line in table:
        print("  ".join(text.ljust(width) for text, width in zip(line, widths)).rstrip())
