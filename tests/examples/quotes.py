# SPDX-License-Identifier: Apache-2.0
"""What docs/howto/NAME.md quotes is what the commands print: every line of a block that begins with `$ chimera` occurs
in docs/howto/NAME/expected.txt under the same command, and every line of a YAML block in one of the descriptions there.

usage: quotes.py HOWTO_FOLDER
"""
import pathlib
import re
import sys

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def faults(name, text, expected, descriptions):
    """What the text quotes wrongly, and the number of lines that were judged."""
    shown = {part.split("\n", 1)[0]: part for part in re.split(r"^\$ ", expected, flags=re.MULTILINE) if part}
    wrong, judged = [], 0
    for kind, block in BLOCK.findall(text):
        lines = block.splitlines()
        if kind == "yaml":
            source, place = descriptions, "descriptions"
        elif lines and lines[0].startswith("$ chimera"):
            source, place = shown.get(lines.pop(0)[2:], ""), "the output of the command"
        else:
            continue
        for line in lines:
            judged += 1
            if line != "tasks:" and line not in source:
                wrong.append(f"{name}: not in {place}: {line}")
    return wrong, judged


def main():
    folder = pathlib.Path(sys.argv[1])
    assert faults("t", "```\n$ chimera x\na b\n```\n", "$ chimera x\nz a b c\n", "") == ([], 1)
    assert len(faults("t", "```\n$ chimera x\nq\n```\n", "$ chimera x\nz\n$ chimera y\nq\n", "")[0]) == 1
    assert len(faults("t", "```yaml\na: 1\n```\n", "", "a: 2\n")[0]) == 1
    wrong, total = [], 0
    for path in sorted(folder.glob("*/expected.txt")):
        descriptions = "".join(file.read_text() for file in path.parent.glob("*.yaml"))
        page = folder / (path.parent.name + ".md")
        more, judged = faults(page.name, page.read_text(), path.read_text(), descriptions)
        wrong, total = wrong + more, total + judged
    for line in wrong:
        print(line)
    print(f"{total} quoted lines, {len(wrong)} wrong")
    return 1 if wrong or not total else 0


if __name__ == "__main__":
    sys.exit(main())
