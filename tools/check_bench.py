# SPDX-License-Identifier: Apache-2.0
"""Every component of library/ stands in a bench row: linked there (`// Components:`) and measured in a case
`{"NAME", "law", ...`, or by its name in `exchange("NAME", ...`."""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "check"))
import sources  # noqa: E402

MADE = re.compile(r"^\s*chimera_component\((\w+)", re.MULTILINE)
LINKED = re.compile(r"^// Components: (.*)$", re.MULTILINE)
MEASURED = re.compile(r"(?:\{|\bexchange\()\"(\w+)\", \"")


def check(root):
    made, linked, measured = {}, set(), set()
    for name in sources.files(root):
        if re.fullmatch(r"library/.*/?CMakeLists\.txt", name):
            made |= {component: name for component in MADE.findall(sources.text(root, name))}
        if re.fullmatch(r"bench/row_\w+\.cc", name):
            text = sources.text(root, name)
            here = set(" ".join(LINKED.findall(text)).split())
            found = set(MEASURED.findall(text))
            linked |= here
            measured |= found & here
    for component in sorted(made.keys() - measured):
        wrong = "linked with one, but measured by none" if component in linked else "in none"
        yield f"{made[component]}: {component}: every component stands in a row of bench/; this one is {wrong}"


_HERE = "library/a/CMakeLists.txt"
_MAKES = "chimera_component(a a.cc)\n"
_ROW = "// Components: a\n"
_SAYS = f"{_HERE}: a: every component stands in a row of bench/; this one is "
PLANTED = (
    ({_HERE: _MAKES, "bench/row_19_x.cc": _ROW + '{{"a", "sum",\n'}, None),
    ({_HERE: _MAKES, "bench/row_19_x.cc": _ROW + 'exchange("a", "bare calls", rig);\n'}, None),
    ({_HERE: _MAKES, "bench/row_19_x.cc": _ROW}, _SAYS + "linked with one, but measured by none"),
    ({_HERE: _MAKES, "bench/row_19_x.cc": '{{"a", "sum",\n'}, _SAYS + "in none"),
    ({_HERE: _MAKES}, _SAYS + "in none"),
)

if __name__ == "__main__":
    sources.run(check, PLANTED)
