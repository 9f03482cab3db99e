# SPDX-License-Identifier: Apache-2.0
"""Every promise of docs/security.md names a test, and every name is one of this tree.

usage: promises.py
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "security.md"
NAME = re.compile(r"`([A-Za-z_]\w*)(?:\.(\w+))?`")


def python_tests():
    """"door_test.test_x" of all scripts, and "questions_test" of one that is one test: who names a promise's test says
    which of them."""
    for folder in ("hostile", "processes", "page"):
        for path in (ROOT / "tests" / folder).glob("*_test.py"):
            methods = re.findall(r"^    def (test_\w+)\(", path.read_text(encoding="utf-8"), re.M)
            yield from [f"{path.stem}.{method}" for method in methods] or [path.stem]


def compiled_tests():
    for folder in ("chimera", "tests"):
        for path in (ROOT / folder).rglob("*_test.cc"):
            for suite, name in re.findall(r"^TEST(?:_F|_P)?\((\w+), (\w+)\)", path.read_text(encoding="utf-8"), re.M):
                yield f"{suite}.{name}"


def campaigns():
    for line in (ROOT / "tests" / "stress.txt").read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            yield line.split()[0]


def complaints(page, known):
    for number, line in enumerate(page.splitlines(), 1):
        cells = [cell.strip() for cell in line.strip("|").split(" | ")]
        if not line.startswith("|") or set(line) <= set("|-") or cells[-1] == "test":
            continue
        names = [".".join(part for part in match if part) for match in NAME.findall(cells[-1])]
        if not names:
            yield f"{number}: no test proves this: {cells[0]}"
        for name in names:
            if name not in known:
                yield f"{number}: {name} is no test and no campaign"


def judges_rightly():
    planted = "| promise | test |\n|---|---|\n| a | `A.B` |\n| b | none |\n| c | `A.Gone` |\n"
    return [said.split(":")[0] for said in complaints(planted, {"A.B"})] == ["4", "5"]


def main():
    found = list(complaints(PAGE.read_text(encoding="utf-8"), {*python_tests(), *compiled_tests(), *campaigns()}))
    if not judges_rightly():
        found.append("a planted page is judged wrongly")
    print("\n".join(found) or "every promise has its test")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
