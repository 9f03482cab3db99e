# SPDX-License-Identifier: Apache-2.0
"""Sentences of README.md and docs/ that name limits of the code, held against the code."""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools" / "check"))
import sources  # noqa: E402

REFUSALS = "chimera/verify/unsupported.cc"
# What a refusal says in the code, and how the limits of README.md call it.
CALLED = (
    ("llf in real time", "policy `llf` in real time"),
    ("budgets above 0.93 of a CPU in real time", "budgets above 0.93 of a CPU"),
    ("budgets of all rtpus together above 0.93", "budgets above 0.93 of a CPU"),
    (": demote' of task", "`demote`"),
    ("from a descriptor, in virtual time", "in virtual time events from a descriptor"),
    ("'server' of task", "in an executive `server`"),
    ("'stack' of task", "`stack`"),
    ("\"isolation: process\", task", "`isolation: process` of a task"),
)
# Calls whose sentence stands in a variable: that of `what` in reaction(), which has two calls.
ELSEWHERE = ("refuse(reaction->at, what,", "refuse(at, \"'\" + std::string(key)")


def refusals(code):
    """The text of every call of refuse() and refuse_key(), and of the sentence made for reaction()."""
    for match in re.finditer(r"\b(refuse(?:_key)?\((?!Place).*?|const std::string what =.*?)\)?;\n", code, re.DOTALL):
        if not match[1].startswith(ELSEWHERE):
            yield re.sub(r"\s+", " ", match[1])


def limits(readme):
    section = re.search(r"^## Limits\n(.*?)(?=^## |\Z)", readme, re.MULTILINE | re.DOTALL)
    return re.sub(r"\s+", " ", section[1]) if section else ""


def refusal_complaints(root):
    told = limits(sources.text(root, "README.md"))
    for call in refusals(sources.text(root, REFUSALS)):
        called = [phrase for sentence, phrase in CALLED if sentence in call]
        if not called:
            yield f"{REFUSALS}: no phrase is known here for the refusal {call}"
        for phrase in called:
            if phrase not in told:
                yield f"README.md: the limits do not say \"{phrase}\", which run refuses"


def table_complaints(root):
    room = sources.text(root, "chimera/verify/rules/rule_room.cc")
    most = re.search(r"kMaxTableBytes = (\d+) << 20;", room)
    document = re.sub(r"\s+", " ", sources.text(root, "docs/formats/table.md"))
    told = re.search(r"outputs take more than (\d+) MiB", document)
    if not most or not told or most[1] != told[1]:
        yield (f"docs/formats/table.md: says {told and told[1]} MiB for all outputs, the rule table-limit has "
               f"{most and most[1]}")


def check(root):
    yield from refusal_complaints(root)
    yield from table_complaints(root)


_README = "# A\n\n## Limits\n\n- Refused: policy `llf` in real time, `standby_for`.\n\n## More\n"
_CODE = ('  void refuse_key(Place at, const char* key) {\n    refuse(at, "\'" + std::string(key) + "\' of");\n  }\n'
         '  refuse(a, "policy llf in real time", "x");\n')
_ROOM = "  constexpr std::uint64_t kMaxTableBytes = 4 << 20;\n"
_TABLE = "outputs take more than\n4 MiB.\n"


def _tree(**other):
    files = {"README.md": _README, REFUSALS: _CODE, "chimera/verify/rules/rule_room.cc": _ROOM,
             "docs/formats/table.md": _TABLE}
    names = {"readme": "README.md", "code": REFUSALS, "table": "docs/formats/table.md"}
    return files | {names[key]: text for key, text in other.items()}


_MISSING = "README.md: the limits do not say \"policy `llf` in real time\", which run refuses"
PLANTED = (
    (_tree(), None),
    (_tree(readme=_README.replace("policy `llf` in real time, ", "")), _MISSING),
    (_tree(readme="# A\n\npolicy `llf` in real time\n"), _MISSING),
    (_tree(code=_CODE + '  refuse_key(a, "magic", task);\n'),
     f'{REFUSALS}: no phrase is known here for the refusal refuse_key(a, "magic", task'),
    (_tree(table=_TABLE.replace("4", "8")),
     "docs/formats/table.md: says 8 MiB for all outputs, the rule table-limit has 4"),
)

if __name__ == "__main__":
    sources.run(check, PLANTED)
