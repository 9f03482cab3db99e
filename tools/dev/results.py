# SPDX-License-Identifier: Apache-2.0
"""Reads what ctest and the gtest binaries left behind into one list of cases."""
import dataclasses
import re
import xml.etree.ElementTree as xml

PASSED, FAILED, SKIPPED = "passed", "failed", "skipped"


@dataclasses.dataclass
class Case:
    name: str
    outcome: str
    said: str = ""     # failed: the output; skipped: the reason
    program: str = ""  # the ctest entry it belongs to
    flaky: str = ""    # what it said when it failed, of a case that passed in a later try


def _text(element):
    return (element.text or "") if element is not None else ""


def _gtest_cases(tree_root, program):
    for suite in tree_root.iter("testsuite"):
        for case in suite.iter("testcase"):
            name = f"{case.get('classname')}.{case.get('name')}"
            failures = case.findall("failure")
            skipped = case.find("skipped")
            if failures:
                yield Case(name, FAILED, "\n".join(f.get("message", "") or _text(f) for f in failures))
            elif skipped is not None:
                yield Case(name, SKIPPED, _skip_reason(skipped.get("message") or _text(skipped)))
            elif case.get("status") == "notrun" or case.get("result") == "suppressed":
                yield Case(name, SKIPPED, "disabled in the source")
            elif case.get("result") == "completed":
                yield Case(name, PASSED)
            else:
                yield Case(name, FAILED, f"{program} left an unknown result: {case.attrib}")


def _skip_reason(message):
    """gtest puts 'file:line' on the first line."""
    lines = [line.strip() for line in message.strip().splitlines() if line.strip()]
    if len(lines) > 1 and re.search(r":\d+$", lines[0]):
        lines = lines[1:]
    return " ".join(lines) or "no reason given"


def _last_line(text):
    lines = [line for line in text.strip().splitlines() if line.strip()]
    return lines[-1].strip() if lines else "no reason given"


def _program_cases(test, results):
    """The cases of one ctest entry: those of its gtest file, and one for the program itself where it adds something."""
    name, status, output = test.get("name"), test.get("status"), _text(test.find("system-out"))
    file = results / f"{name}.xml"
    cases = []
    if file.exists():
        try:
            cases = list(_gtest_cases(xml.parse(file).getroot(), name))
        except xml.ParseError as error:
            return [Case(name, FAILED, f"unreadable {file.name}: {error}\n{output}")]
    if status == "run":
        if file.exists() and not cases:
            return [Case(name, FAILED, f"{name} ran no test")]
        return cases or [Case(name, PASSED)]
    skipped = test.find("skipped")
    if status == "notrun" and skipped is not None and "SKIP_RETURN_CODE" in skipped.get("message", ""):
        return [Case(name, SKIPPED, _last_line(output))]
    if any(case.outcome == FAILED for case in cases):
        return cases
    why = test.find("failure")
    reason = why.get("message", "") if why is not None else status
    return cases + [Case(name, FAILED, f"{name}: {reason or status}\n{output}")]


def read(junit, results):
    """All cases of one ctest run. `junit` is ctest's file, `results` the folder of the gtest files."""
    cases = []
    for test in xml.parse(junit).getroot().iter("testcase"):
        for case in _program_cases(test, results):
            case.program = test.get("name")
            cases.append(case)
    return cases


def merge(before, again, programs):
    """The cases after `programs` ran again. What failed before and fails no more is flaky."""
    failed = {(case.program, case.name): case.said or "failed" for case in before if case.outcome == FAILED}
    flaky = {(case.program, case.name): case.flaky for case in before if case.flaky}
    cases = [case for case in before if case.program not in programs]
    for program in programs:
        found = [case for case in again if case.program == program]
        if not found:
            found = [Case(program, FAILED, "it did not run again", program)]
        names = {case.name for case in found}
        for (of, name), said in failed.items():
            if of == program and name not in names:  # the program itself, which died before; or it died sooner now
                found.append(Case(name, PASSED if name == program else FAILED, said, program))
        for case in found:
            key = (program, case.name)
            if case.outcome != FAILED:
                case.flaky = flaky.get(key) or failed.get(key, "")
        cases += found
    return cases
