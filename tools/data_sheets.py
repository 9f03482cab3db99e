# SPDX-License-Identifier: Apache-2.0
"""Data sheets: library/NAME/README.md has its sections, and its table of ports is what the descriptor says;
library/README.md lists each in the words of its descriptor.

usage: data_sheets.py COMPONENTS [--library FOLDER] [--write] [--measure PROGRAM] [NAME...]

COMPONENTS is the folder of a build tree with NAME.component.json. --write puts the tables right instead of complaining.
--measure runs `PROGRAM test NAME` and writes the first paragraph under Execution time.
docs/howto/write-a-component.md shows the form."""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

REQUIRED = ("Equation", "Ports", "Refused", "Execution time", "Source")
HEAD = ("port", "type", "values", "what it is")
TIME = re.compile(r"\d[\d.]* (ns|us|ms)\b")


def number(value):
    return value if isinstance(value, str) else f"{value:g}" if abs(value) < 1e6 else f"{value:.17g}"


def initial(port):
    """The initial value of an out-var, the default of an input: one for all elements, or the list."""
    texts = [("true" if v else "false") if isinstance(v, bool) else f'"{v}"' if isinstance(v, str) else
             "given" if isinstance(v, dict) else number(v) for v in port.get("initial", [])]
    return texts[0] if len(set(texts)) == 1 else ", ".join(texts)


def marks(port):
    """The end of the second column, after kind, type, unit and frame."""
    if port.get("safety"):
        yield "safety"
    if port.get("safe_state") and port["kind"] != "resource":
        yield "safe state"
    if port.get("shared"):
        yield "shared"
    if port.get("intermittent"):
        yield "intermittent"
    if "max_instances" in port:
        yield f"up to {port['max_instances']}"


def kind_of(port):
    if port["kind"] == "resource":
        return ", ".join(["resource", *marks(port)])
    type_name = port.get("type_name") or port["type"]
    if port["type"] == "any":
        type_name = f"any {type_name}"
    unit = [port["unit"]] if port["unit"] not in ("", "1") else []
    frame = [port["frame"]] if port.get("frame") else []
    return ", ".join([f"{port['kind']} {type_name}{port['shape']}", *unit, *frame, *marks(port)])


def values_of(port):
    parts = [" to ".join(number(end) for end in port["range"])] if "range" in port else []
    if "at_least" in port:
        parts.append(f"at least `{port['at_least']}`")
    if "one_of" in port:
        parts.append(" ".join(f"`{word}`" for word in port["one_of"]))
    if port.get("initial"):
        parts.append(("initially " if port["kind"] == "out-var" else "default ") + initial(port))
    return ", ".join(parts)


def row(port):
    name = f"`{port['name']}{'*' if 'max_instances' in port else ''}`"
    return name, kind_of(port), values_of(port), port.get("doc", "")


def table_line(cells):
    """One line of a Markdown table. An empty cell has no blanks."""
    return re.sub(r"\|  +\|", "||", " | ".join(re.sub(r"  +", " ", cell.replace("|", "\\|")) for cell in cells))


def table(descriptor):
    """The table of ports as Markdown lines."""
    rows = [row(port) for port in descriptor["ports"]]
    if not rows:
        return ["It has no ports."]
    return [table_line(HEAD), "|".join(["---"] * len(HEAD)), *map(table_line, rows)]


def sections(lines):
    """[(heading, first line, behind the last line)]; code blocks are not looked into."""
    found, fenced = [], False
    for i, line in enumerate(lines):
        fenced ^= line.startswith("```")
        if line.startswith("## ") and not fenced:
            if found:
                found[-1][2] = i
            found.append([line[3:].strip(), i + 1, len(lines)])
    return found


def body(lines, section):
    return [line for line in lines[section[1]:section[2]] if line.strip()]


def uncited(descriptor, said):
    """Authors and years of the `source` of the code that the sheet does not name."""
    words = re.findall(r"\b[A-Z][a-z]+\b|\b\d{4}\b", descriptor.get("source", ""))
    return [word for word in words if word.lower() not in said.lower()]


def check(name, text, descriptor):
    """Errors of a sheet, as sentences."""
    lines = text.split("\n")
    if lines[0] != f"# {name}":
        yield f"the first line is not '# {name}'"
    found = sections(lines)
    headings = [s[0] for s in found]
    present = [h for h in headings if h in REQUIRED]
    for heading in REQUIRED:
        if headings.count(heading) != 1:
            yield f"there is {'no' if heading not in headings else 'more than one'} section '## {heading}'"
    if len(present) == len(REQUIRED) and tuple(present) != REQUIRED:
        yield "the sections stand in another order than " + ", ".join(REQUIRED)
    first = found[0][1] - 1 if found else len(lines)
    if not any(line.strip() for line in lines[1:first]):
        yield "it does not say what the component is for"
    for section in found:
        if section[0] in REQUIRED and not body(lines, section):
            yield f"section '## {section[0]}' is empty"
        if section[0] == "Execution time" and not (TIME.search(" ".join(body(lines, section)))
                                                    and "chimera test" in " ".join(body(lines, section))):
            yield "section '## Execution time' states no time with its unit, or not the command `chimera test NAME`"
        if section[0] == "Source" and (unknown := uncited(descriptor, " ".join(body(lines, section)))):
            yield f"section '## Source' does not name {', '.join(unknown)}, which the code cites"
        if section[0] == "Ports" and body(lines, section) != table(descriptor):
            yield "the table of ports is not what the descriptor says: tools/data_sheets.py --write"
    for port in descriptor["ports"]:
        if not port.get("doc"):
            yield f"port {port['name']}: the code has no doc = \"...\""


SIMULATED_HARDWARE = ("car", "electric_car", "mujoco_robot", "mujoco_robot_torque", "mujoco_robot_velocity", "puma",
                      "puma_torque", "rmms")


def unsafe(name, descriptor):
    """A component that moves hardware says when it is safe, for a drill: docs/howto/drill.md."""
    ports = descriptor["ports"]
    resources = [port for port in ports if port["kind"] == "resource"]
    tells = [port["name"] for port in ports if port.get("safe_state") and port["kind"] == "out-var"]
    moves = name in SIMULATED_HARDWARE or any(not port.get("safe_state") for port in resources)
    if moves and not tells:
        yield ("its code has hardware and no safe_state: on an output that says it is safe, or on a resource that "
               "moves nothing")


def pictures(folder, text):
    """Errors in the pictures of a sheet: a missing file, or a file that the sheet does not show."""
    shown = set(re.findall(r"!\[[^\]]+\]\(([^)]+)\)", text))
    for picture in sorted(shown):
        if not (folder / picture).is_file():
            yield f"there is no picture {picture}"
    for picture in sorted(file.name for file in folder.glob("*.svg")):
        if picture not in shown:
            yield f"it does not show {picture}"


def with_table(text, descriptor):
    lines = text.split("\n")
    for heading, start, end in sections(lines):
        if heading == "Ports":
            return "\n".join(lines[:start] + ["", *table(descriptor), ""] + lines[end:])
    return text


def measured(program, name, components):
    """Result of `chimera test NAME` on this machine, as a sentence."""
    run = subprocess.run([program, "test", name, "--json"], capture_output=True, text=True, check=False,
                         env={**os.environ, "CHIMERA_PATH": str(components)})
    report = json.loads(run.stdout)["reports"][0]
    if not report["passes"]:
        sys.exit(f"{name} does not pass: chimera test {name}")
    cpu = re.search(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    def text(ns):
        return "less than 10 ns" if ns < 10 else f"{ns:.0f} ns" if ns < 1000 else f"{ns / 1000:.1f} us"

    return (f"{text(report['typical_ns'])} typical, {text(report['worst_ns'])} worst: `chimera test {name}`, "
            f"{cpu[1] if cpu else 'unknown processor'}.")


def with_time(text, sentence):
    lines = text.split("\n")
    for heading, start, end in sections(lines):
        if heading == "Execution time":
            paragraphs = "\n".join(lines[start:end]).strip().split("\n\n")
            return "\n".join([*lines[:start], "", "\n\n".join([sentence, *paragraphs[1:]]), "", *lines[end:]])
    return text


SHEET = """# t

For tests.

## Equation

    y = x

## Ports

port | type | values | what it is
---|---|---|---
`y` | out-var float64[2], m, safety | -1 to 1 | where

## Refused

Nothing.

## Execution time

0.1 us: `chimera test t`.

## Source

Ours.
"""
DESCRIPTOR = {"ports": [{"name": "y", "kind": "out-var", "type": "float64", "unit": "m", "shape": "[2]", "safety": True,
                         "range": [-1.0, 1.0], "doc": "where"}]}
PLANTED = (
    (SHEET, DESCRIPTOR, []),
    (SHEET.replace("# t\n", "# u\n", 1), DESCRIPTOR, ["the first line is not '# t'"]),
    (SHEET.replace("For tests.", ""), DESCRIPTOR, ["it does not say what the component is for"]),
    (SHEET.replace("## Source", "## Sources"), DESCRIPTOR, ["there is no section '## Source'"]),
    (SHEET.replace("Nothing.", ""), DESCRIPTOR, ["section '## Refused' is empty"]),
    (SHEET.replace(", m,", ", mm,"), DESCRIPTOR,
     ["the table of ports is not what the descriptor says: tools/data_sheets.py --write"]),
    (SHEET.replace("Ours.", "Meier 1999."), DESCRIPTOR | {"source": "Meier 1999, table 1"}, []),
    (SHEET, DESCRIPTOR | {"source": "Meier 1999, table 1"},
     ["section '## Source' does not name Meier, 1999, which the code cites"]),
    (SHEET.replace("0.1 us", "fast"), DESCRIPTOR,
     ["section '## Execution time' states no time with its unit, or not the command `chimera test NAME`"]),
    (SHEET.replace("## Equation", "## Refused", 1).replace("Refused\n\nNothing", "Equation\n\nNothing"), DESCRIPTOR,
     ["the sections stand in another order than Equation, Ports, Refused, Execution time, Source"]),
)


def listed(index, descriptors):
    """The list of components has a row for each, and none for what is not there."""
    wanted = [f"[{d['name']}]({d['name']}/README.md) | {d['doc']}" for d in descriptors]
    rows = [row for row in index.splitlines() if re.match(r"\[\w+\]\(\w+/README\.md\) \| ", row)]
    yield from (f"has no line {row}" for row in wanted if row not in rows)
    yield from (f"lists what is not there: {row}" for row in rows if row not in wanted)


def planted():
    for sheet, descriptor, expected in PLANTED:
        if list(check("t", sheet, descriptor)) != expected:
            yield f"a planted fault is not found: {expected}, but {list(check('t', sheet, descriptor))}"
    device, moved = {"name": "device", "kind": "resource"}, {"name": "held", "kind": "out-var", "safe_state": True}
    for name, ports, is_right in (("t", [device], False), ("t", [device, moved], True), ("t", [], True),
                                  ("puma", [], False), ("puma", [moved], True),
                                  ("t", [device | {"safe_state": True}], True),
                                  ("t", [device | {"safe_state": True}, device], False)):
        if (list(unsafe(name, {"ports": ports})) == []) != is_right:
            yield f"hardware without a safe state is judged wrongly: {name} {ports}"
    if list(listed("[a](a/README.md) | A.\n[b](b/README.md) | B.", [{"name": "a", "doc": "Another."}])) != [
            "has no line [a](a/README.md) | Another.", "lists what is not there: [a](a/README.md) | A.",
            "lists what is not there: [b](b/README.md) | B."]:
        yield "a list that is not right is not found"
    wrong = SHEET.replace(", m,", ", mm,")
    if with_table(wrong, DESCRIPTOR) != SHEET:
        yield "a table that is not right is not put right"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "a.svg").touch()
        if list(pictures(folder, "![a](a.svg)")) or list(pictures(folder, "![b](b.svg)")) != [
                "there is no picture b.svg", "it does not show a.svg"]:
            yield "a picture that is not there is not missed"


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("components", type=pathlib.Path)
    words.add_argument("names", nargs="*")
    words.add_argument("--library", type=pathlib.Path, default=pathlib.Path(__file__).parent.parent / "library")
    words.add_argument("--write", action="store_true")
    words.add_argument("--measure", metavar="PROGRAM")
    said = words.parse_intermixed_args()
    faults = [f"tools/data_sheets.py: {fault}" for fault in planted()]
    descriptors = []
    for file in sorted(said.components.glob("*.component.json")):
        name = file.name.removesuffix(".component.json")
        sheet = said.library / name / "README.md"
        if not (said.library / name).is_dir() or (said.names and name not in said.names):
            continue
        descriptor = json.loads(file.read_text())
        descriptors.append(descriptor)
        text = sheet.read_text() if sheet.exists() else ""
        if said.measure and text:
            text = with_time(text, measured(said.measure, name, said.components))
        if (said.write or said.measure) and text:
            text = with_table(text, descriptor)
            sheet.write_text(text)
        found = [*check(name, text, descriptor), *unsafe(name, descriptor), *pictures(sheet.parent, text)]
        faults += [f"library/{name}/README.md: {fault}" for fault in found]
    if not said.names:
        index = (said.library / "README.md").read_text()
        faults += [f"library/README.md: {fault}" for fault in listed(index, descriptors)]
    for fault in faults:
        print(fault)
    print(f"{len(descriptors)} data sheets, {len(faults)} faults")
    return 1 if faults or not descriptors else 0


if __name__ == "__main__":
    sys.exit(main())
