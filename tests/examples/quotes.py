# SPDX-License-Identifier: Apache-2.0
"""What the pages of docs/howto and the READMEs of examples/ quote is what the commands print.

docs/howto/NAME.md is held against docs/howto/NAME/: every line of a block that begins with `$ chimera` occurs in
expected.txt under the same command, and every line of a YAML block in one of the descriptions. In the README of a
lesson every line of a block without a language occurs in expected.txt; a line of a YAML block may end with `...`.
Blocks of other languages are not judged: `text` is the output of a run in real time.

usage: quotes.py HOWTO_FOLDER EXAMPLES_FOLDER
"""
import pathlib
import re
import sys

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def is_in(line, source):
    beginning, shortened, _ = line.partition("...")
    return line in source or (shortened != "" and len(beginning.strip()) > 10 and beginning in source)


def faults(name, text, expected, descriptions, is_lesson=False):
    """What the text quotes wrongly, and the number of lines that were judged."""
    shown = {part.split("\n", 1)[0]: part for part in re.split(r"^\$ ", expected, flags=re.MULTILINE) if part}
    wrong, judged = [], 0
    for kind, block in BLOCK.findall(text):
        lines = block.splitlines()
        if kind == "yaml":
            source, place = descriptions, "descriptions"
        elif lines and lines[0].startswith("$ chimera"):
            source, place = shown.get(lines.pop(0)[2:], ""), "the output of the command"
        elif is_lesson and kind == "":
            source, place = expected, "expected.txt"
        else:
            continue
        for line in lines:
            judged += 1
            if line != "tasks:" and not is_in(line, source):
                wrong.append(f"{name}: not in {place}: {line}")
    return wrong, judged


def main():
    howtos, lessons = map(pathlib.Path, sys.argv[1:])
    assert faults("t", "```\n$ chimera x\na b\n```\n", "$ chimera x\nz a b c\n", "") == ([], 1)
    assert len(faults("t", "```\n$ chimera x\nq\n```\n", "$ chimera x\nz\n$ chimera y\nq\n", "")[0]) == 1
    assert len(faults("t", "```yaml\na: 1\n```\n", "", "a: 2\n")[0]) == 1
    assert len(faults("t", "```\nq\n```\n", "$ chimera x\nz\n", "", True)[0]) == 1
    assert len(faults("t", "```yaml\nsource: {component: b, ...}\n```\n", "", "source: {component: a}\n", True)[0]) == 1
    wrong, total = [], 0
    pages = [(howtos / (path.parent.name + ".md"), path, False) for path in sorted(howtos.glob("*/expected.txt"))]
    pages += [(path.with_name("README.md"), path, True) for path in sorted(lessons.glob("*/expected.txt"))]
    for page, path, is_lesson in pages:
        descriptions = "".join(file.read_text() for file in path.parent.glob("*.yaml"))
        name = page.relative_to(page.parents[1])
        more, judged = faults(name, page.read_text(), path.read_text(), descriptions, is_lesson)
        wrong, total = wrong + more, total + judged
    for line in wrong:
        print(line)
    print(f"{total} quoted lines, {len(wrong)} wrong")
    return 1 if wrong or not total else 0


if __name__ == "__main__":
    sys.exit(main())
