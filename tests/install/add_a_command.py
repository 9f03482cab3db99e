#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Every block of docs/howto/add-a-command.md that names a file stands in that file, and the manual and the completion
in the source name no command: they are made from the table.

usage: add_a_command.py SOURCE
"""
import pathlib
import re
import sys


def flat(text):
    return re.sub(r"\s+", " ", text).strip()


def faults_of(source):
    text = (source / "docs/howto/add-a-command.md").read_text()
    blocks = re.findall(r"^```\w+ (\S+)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    if len(blocks) < 2:
        yield f"add-a-command.md: {len(blocks)} blocks name a file"
    for name, block in blocks:
        if flat(block) not in flat((source / name).read_text()):
            yield f"add-a-command.md: {name} does not have the block that begins with '{block.splitlines()[0]}'"
    for name in ("docs/man/chimera.1.in", "share/chimera/completion/chimera.bash.in"):
        lines = (source / name).read_text().splitlines()
        if not any(re.fullmatch("@[a-z]+@", line) for line in lines):
            yield f"{name}: nothing is filled in"
        for line in lines:
            if re.match(r"\.SS |    '?(reinit|ring|why)'?\)", line):
                yield f"{name}: '{line}' is written by hand"


def main():
    faults = list(faults_of(pathlib.Path(sys.argv[1])))
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
