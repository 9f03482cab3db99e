# SPDX-License-Identifier: Apache-2.0
"""Sentences of README.md and docs/ that name limits of the code, held against the code."""
import json
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools" / "check"))
import sources  # noqa: E402

RECEIPT = "docs/formats/receipt.md"
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
    ("'link' of rtpu", "`link`"),
    ("\"isolation: process\", task", "`isolation: process` of a task"),
)
# Calls whose sentence stands in a variable: that of `what` in load() and in reaction().
ELSEWHERE = ("refuse(is_start ?", "refuse(reaction->at, what,", "refuse(at, \"'\" + std::string(key)")


def refusals(code):
    """The text of every call of refuse() and refuse_key(), and of each sentence made before its call."""
    for match in re.finditer(r"\b(refuse(?:_key)?\((?!Place).*?|\bwhat = .*?)\)?;\n", code, re.DOTALL):
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


def words_of(schema):
    """Every key that the schema of an object has, and every word that a value may be."""
    for key, value in schema.get("properties", {}).items():
        yield key
        yield from words_of(value)
    yield from words_of(schema.get("items", {})) if "items" in schema else ()
    yield from (word for word in schema.get("enum", []) if word)


def receipt_complaints(root):
    schema = json.loads(sources.text(root, "docs/formats/run.schema.json"))["definitions"]["receipt"]
    document = sources.text(root, RECEIPT)
    yield from (f"{RECEIPT}: does not say what `{word}` is" for word in words_of(schema) if f"`{word}`" not in document)
    reasons = {word for word in schema["properties"]["reason"]["enum"] if word}
    code = sources.text(root, "chimera/runtime/plan/switch_words.h")
    named = set(re.findall(r'case NoSwitch::k\w+: return "([a-z-]+)";', code)) - {"none"}
    yield from (f"{RECEIPT}: the code has no reason `{word}`" for word in sorted(reasons - named))
    rows = set(re.findall(r"^\| `([a-z]+(?:-[a-z]+)*)` \|", document.split("| reason |", 1)[-1], re.MULTILINE))
    yield from (f"{RECEIPT}: has a row for the reason `{word}`, which the schema has not"
                for word in sorted(rows - reasons))


def check(root):
    yield from refusal_complaints(root)
    yield from table_complaints(root)
    yield from receipt_complaints(root)


_README = "# A\n\n## Limits\n\n- Refused: policy `llf` in real time, `standby_for`.\n\n## More\n"
_CODE = ('  void refuse_key(Place at, const char* key) {\n    refuse(at, "\'" + std::string(key) + "\' of");\n  }\n'
         '  refuse(a, "policy llf in real time", "x");\n')
_ROOM = "  constexpr std::uint64_t kMaxTableBytes = 4 << 20;\n"
_SCHEMA = json.dumps({"definitions": {"receipt": {"properties": {
    "tries": {"type": "integer"}, "reason": {"enum": [None, "late"]}}}}})
_RECEIPT = "| key |\n| `tries` | x |\n| `reason` | x |\n\n| reason |\n|---|\n| `late` | x |\n"
_REASONS = '    case NoSwitch::kNone: return "none";\n    case NoSwitch::kLate: return "late";\n'
_TABLE = "outputs take more than\n4 MiB.\n"


def _tree(**other):
    files = {"README.md": _README, REFUSALS: _CODE, "chimera/verify/rules/rule_room.cc": _ROOM,
             "docs/formats/table.md": _TABLE, "docs/formats/run.schema.json": _SCHEMA, RECEIPT: _RECEIPT,
             "chimera/runtime/plan/switch_words.h": _REASONS}
    names = {"readme": "README.md", "code": REFUSALS, "table": "docs/formats/table.md", "receipt": RECEIPT,
             "reasons": "chimera/runtime/plan/switch_words.h"}
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
    (_tree(receipt=_RECEIPT.replace("`tries`", "tries")), f"{RECEIPT}: does not say what `tries` is"),
    (_tree(receipt=_RECEIPT + "| `early` | x |\n"),
     f"{RECEIPT}: has a row for the reason `early`, which the schema has not"),
    (_tree(reasons=_REASONS.replace('"late"', '"too-late"')), f"{RECEIPT}: the code has no reason `late`"),
)

if __name__ == "__main__":
    sources.run(check, PLANTED)
