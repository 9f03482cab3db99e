#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What the commands print with --json satisfies docs/formats/run.schema.json, for outputs of every kind.

usage: run_schema.py PROGRAM SOURCE
"""
import copy
import json
import pathlib
import subprocess
import sys

import jsonschema


KINDS = ("run", "check", "list", "test", "cases", "sweep", "schedule", "modes", "error")


def definition(schema, name):
    return jsonschema.Draft7Validator({"$ref": f"#/definitions/{name}", "definitions": schema["definitions"]})


def outputs(source):
    """(kind, exit code, words of the command line)"""
    examples = sorted((source / "examples").glob("01_*/*.yaml"))
    examples = [path for path in examples if not path.name.endswith(".cases.yaml")]
    good, faulty = sorted((source / "tests/verify/good").glob("*.yaml")), sorted(
        (source / "tests/verify/faulty").glob("*.yaml"))
    faults = source / "tests/commands/faults/faults.yaml"
    yield "list", 0, ["list"]
    yield "descriptor", 0, ["describe", "gain"]
    yield "error", 1, ["describe", "gian"]
    yield "test", 1, ["test", "accel", "--setup", source / "library/brake/brake.test.yaml"]
    yield "test", 0, ["test", "gain", "--cycles", "50"]
    yield "cases", 0, ["test", source / "examples/02_cruise_control"]
    yield "sweep", 0, ["sweep", source / "examples/02_cruise_control/cruise_control.yaml", "--over",
                       "car.start_speed = 80, 90 km/h", "--for", "20 ms", "--measure", "vz", "--expect", "vz >= 0 m/s"]
    yield "modes", 0, ["check", source / "examples/17_switch/switch.yaml", "--modes"]
    yield "modes", 0, ["check", source / "examples/18_tool_changer/tool_changer.yaml", "--modes"]
    yield "modes", 0, ["check", source / "examples/19_standby/standby.yaml", "--modes"]
    yield "modes", 0, ["check", examples[0], "--modes"]
    yield "check", 1, ["check", faulty[0], "--modes"]
    yield "schedule", 0, ["schedule", examples[0]]
    yield "schedule", 1, ["schedule", source / "examples/06_schedules/edf.yaml"]
    yield "schedule", 1, ["schedule", source / "examples/06_schedules/muf.yaml"]
    yield "check", 1, ["schedule", faulty[0]]
    yield "error", 1, ["schedule", examples[0], "--profile", source / "README.md"]
    yield "error", 2, ["run", examples[0], "--virtual", "--for", "1 s", "--expect", "nothing at all"]
    for path in examples:
        yield "check", 0, ["check", path]
        yield "run", None, ["run", path, "--virtual", "--for", "20 ms"]
    for path in faulty[::12] + good[:1]:
        yield "check", None, ["check", path]
    yield "check", 1, ["run", faulty[0], "--virtual", "--for", "1 s"]
    yield "run", 0, ["run", source / "docs/howto/reconfigure/switches.yaml", "--virtual", "--for", "40 ms",
                     "--at", "10 ms: switch quick", "--at", "20 ms: switch wild"]
    yield "run", 1, ["run", faults, "--virtual", "--for", "0.2 s", "--watch", "e_command", "--watch", "a_count",
                     "--expect", "a_count >= 1"]
    yield "run", 1, ["run", faults, "--virtual", "--for", "0.2 s", "--seed", "7", "--expect", "a_count < 1"]


def cut(value, path=()):
    """Copies of `value`, each without one key of one of its objects."""
    if isinstance(value, dict):
        for key in value:
            yield (*path, key), {k: v for k, v in value.items() if k != key}
            for at, smaller in cut(value[key], (*path, key)):
                yield at, {**value, key: smaller}
    elif isinstance(value, list) and value:
        for at, smaller in cut(value[0], (*path, 0)):
            yield at, [smaller, *copy.copy(value[1:])]


def main():
    program, source = sys.argv[1], pathlib.Path(sys.argv[2])
    schema = json.loads((source / "docs/formats/run.schema.json").read_text())
    jsonschema.Draft7Validator.check_schema(schema)
    judges = {kind: definition(schema, kind) for kind in KINDS}
    judges["descriptor"] = jsonschema.Draft7Validator(
        json.loads((source / "docs/formats/descriptor.schema.json").read_text()))
    any_output = jsonschema.Draft7Validator(schema)
    faults, texts, last = [], {}, {}
    for kind, code, words in outputs(source):
        run = subprocess.run([program, *map(str, words), "--json"], capture_output=True, text=True)
        called = " ".join(map(str, words))
        if run.returncode not in ((0, 1) if code is None else (code,)):
            faults.append(f"{called}: exit code {run.returncode}: {run.stderr}")
            continue
        printed = json.loads(run.stdout)
        faults += [f"{called}: {'/'.join(map(str, error.absolute_path))}: {error.message}"
                   for error in judges[kind].iter_errors(printed)]
        if kind != "descriptor" and not any_output.is_valid(printed):
            faults.append(f"{called}: is not exactly one kind of output")
        texts[called], last[kind] = run.stdout, printed
    # The schema itself: whatever is missing is noticed. Methods and variables are keys of the application's own.
    for kind in KINDS:
        for at, smaller in cut(last[kind]):
            free = at[-1] == "last_fault" or (len(at) > 1 and at[-2] in ("execution_ns", "variables", "set", "values"))
            if not free and judges[kind].is_valid(smaller):
                faults.append(f"{kind}: the schema does not miss {'/'.join(map(str, at))}")
    for fault in faults:
        print(fault)
    print(f"{len(texts)} outputs against the schema, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
