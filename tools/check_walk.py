# SPDX-License-Identifier: Apache-2.0
"""Proves that the ways through the code of docs/walk.md name files that exist, that each row has as many as it says,
that the sentence above each table says their sum, and that no way grows beyond its goal."""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "check"))
import sources  # noqa: E402

WALK = "docs/walk.md"
SECTION = re.compile(r"^## (\d+)\. [^\n]*\n(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)
ROW = re.compile(r"^\| ([^|\n]+) \| (\d+) \| ([^|\n]+) \|", re.MULTILINE)
SUM = re.compile(r"\b(\d+) files with their headers\b")
MOST = {"8": 45, "9": 30, "10": 44}  # by section: docs/walk.md says why


def named(cell):
    """Paths without their endings: "`task/` port, registry; `keeper/keeper`" has three."""
    for part in cell.split(";"):
        match = re.fullmatch(r"\s*`([^`]+)`([\w, ]*)\s*", part)
        if match is None:
            yield part.strip()
        elif match[1].endswith("/"):
            yield from (match[1] + name.strip() for name in match[2].split(","))
        else:
            yield match[1]


def exists(root, path):
    """In the folder that is named, or in one of its rooms."""
    floor, _, name = path.rpartition("/")
    return any(any((root / folder).glob(f"{floor}{room}/{name}{ending}"))
               for folder in ("chimera", ".") for room in ("", "/*") for ending in (".h", ".cc"))


def check(root):
    if not (root / WALK).is_file():
        return
    for section in SECTION.finditer(sources.text(root, WALK)):
        rows, told = list(ROW.finditer(section[2])), SUM.search(section[2])
        if not rows:
            continue
        for row in rows:
            paths = list(named(row[3]))
            yield from (f"{WALK}: section {section[1]}, {row[1]}: no file {path}.h or {path}.cc"
                        for path in paths if not exists(root, path))
            if len(paths) != int(row[2]):
                yield f"{WALK}: section {section[1]}, {row[1]}: {len(paths)} files are named, {row[2]} are said"
        total = sum(int(row[2]) for row in rows)
        if told is None or int(told[1]) != total:
            yield f"{WALK}: section {section[1]}: the sentence must say '{total} files with their headers'"
        if total > MOST.get(section[1], total):
            yield f"{WALK}: section {section[1]}: {total} files, at most {MOST[section[1]]} are allowed"


_HEAD = "## 8. Files\n\nIt crosses {} files with their headers.\n\n| stage | files | |\n|---|---|---|\n"
_TREE = {"chimera/task/port.h": "", "chimera/task/registry.cc": "", "apps/x/main.cc": ""}


def _walk(said, row):
    return {WALK: _HEAD.format(said) + row + "\n", **_TREE}


PLANTED = (
    (_walk(3, "| a | 3 | `task/` port, registry; `apps/x/main` | text |"), None),
    (_walk(2, "| a | 2 | `task/` port, registry; `apps/x/main` | |"),
     f"{WALK}: section 8, a: 3 files are named, 2 are said"),
    (_walk(2, "| a | 2 | `task/` port, taken | text |") | {"chimera/task/life/taken.h": ""}, None),
    (_walk(2, "| a | 2 | `task/` port, gone | |"), f"{WALK}: section 8, a: no file task/gone.h or task/gone.cc"),
    (_walk(4, "| a | 2 | `task/` port, registry | |\n| b | 1 | `apps/x/main` | |"),
     f"{WALK}: section 8: the sentence must say '3 files with their headers'"),
    (_walk(46, "| a | 46 | `task/` " + ", ".join(["port"] * 46) + " | |"),
     f"{WALK}: section 8: 46 files, at most 45 are allowed"),
)

if __name__ == "__main__":
    sources.run(check, PLANTED)
