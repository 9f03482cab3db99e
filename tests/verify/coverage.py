#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Lists the legality rules and the keys of the grammar that no faulty description of tests/verify/faulty shows.

A rule is shown by a report with its [name]; a key by a report that speaks of the key by name. Fails on any that is not.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def array(text, name):
    """The strings of one constexpr array of a header, comments left out."""
    body = re.search(name + r"\s*=\s*\{(.*?)\};", text, re.S)
    if body is None:
        sys.exit(f"coverage: no array {name}")
    return re.findall(r'"([^"]+)"', re.sub(r"//.*", "", body.group(1)))


def uncovered(reports, rules, keys):
    """Names without a report. `keys` holds (name, pattern of the message that speaks of it)."""
    missing = [f"rule {rule}" for rule in rules if f"[{rule}]" not in reports]
    return missing + [f"key {name}" for name, pattern in keys if not re.search(pattern, reports)]


def key_patterns(text):
    patterns = []
    for array_name, place in (("kFileKeys", r"(?!\w)"), ("kRtpuKeys", " of rtpu"), ("kTaskKeys", " of task"),
                              ("kTolerateKeys", " in 'tolerate'"), ("kServerKeys", " in 'server'"),
                              ("kLinkKeys", " in 'link'"), ("kSetKeys", " of configuration"),
                              ("kSequenceKeys", " in 'sequence'"),
                              ("kStepKeys", " of step"),
                              ("kStandbyKeys", " in 'standby_for'")):
        for key in array(text, array_name):
            # `operator`, `tasks` and the like may be spoken of without quotes ("the version of the format").
            quote = "'?" if array_name == "kFileKeys" else "'"
            patterns.append((f"{key} ({array_name})", quote + re.escape(key) + quote + place))
    return patterns


def self_test():
    rules, keys = ["a-rule", "b-rule"], [("rate", "'rate' of task")]
    assert uncovered("x: error: 'rate' of task 'a' [a-rule]", rules, keys) == ["rule b-rule"]
    assert uncovered("x [a-rule] [b-rule]", rules, keys) == ["key rate"]


def main():
    self_test()
    description = ROOT / "chimera/description"
    rules = array((description / "rule_ids.h").read_text(), "kRules")
    keys = key_patterns((description / "keys.h").read_text())
    folder = ROOT / "tests/verify/faulty"
    reports = "\n".join(p.read_text(errors="replace") for p in sorted(folder.glob("*.expected")))
    # What no text can show (a file that is not there) is shown by a unit test that pins the report.
    reports += "\n".join(p.read_text() for p in sorted([*description.glob("draft*_test.cc"),
                                                        ROOT / "chimera/verify/objects_test.cc"]))
    missing = uncovered(reports, rules, keys)
    for name in missing:
        print(f"no faulty description shows {name}")
    for path in sorted(folder.glob("*.yaml")):
        if not path.with_suffix(".expected").exists():
            missing.append(path.name)
            print(f"{path.name} has no report")
    print(f"{len(rules)} rules and {len(keys)} keys, {len(missing)} not covered")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
