#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Holds docs/formats/description.schema.json against the reader and the descriptions.

The schema is a schema; it has the keys of chimera/description/keys.h and no other; every example and every good
description satisfies it; and it refuses the descriptions that a reader refuses for their keys alone.
"""
import json
import pathlib
import re
import sys

import jsonschema
import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from coverage import ROOT, array  # noqa: E402


class Yaml12(yaml.SafeLoader):
    """PyYAML speaks YAML 1.1; here `on` and `yes` are texts and 010 is ten."""


YAML_1_1 = tuple(f"tag:yaml.org,2002:{name}" for name in ("bool", "int", "timestamp"))
Yaml12.yaml_implicit_resolvers = {first: [rule for rule in rules if rule[0] not in YAML_1_1]
                                  for first, rules in yaml.SafeLoader.yaml_implicit_resolvers.items()}
Yaml12.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile("^(true|false)$"), list("tf"))
Yaml12.add_implicit_resolver("tag:yaml.org,2002:int", re.compile("^[-+]?[0-9]+$"), list("-+0123456789"))
Yaml12.add_constructor("tag:yaml.org,2002:int", lambda loader, node: int(node.value, 10))


def keys_of(schema):
    task = schema["definitions"]["task"]["properties"]
    rtpu = schema["properties"]["rtpus"]["additionalProperties"]["properties"]
    return {"kFileKeys": schema["properties"], "kRtpuKeys": rtpu,
            "kLinkKeys": rtpu["link"]["properties"], "kTaskKeys": task,
            "kTolerateKeys": task["tolerate"]["properties"], "kServerKeys": task["server"]["properties"],
            "kSetKeys": schema["properties"]["configurations"]["additionalProperties"]["oneOf"][1]["properties"],
            "kSequenceKeys": schema["properties"]["sequence"]["oneOf"][1]["properties"],
            "kStepKeys": schema["definitions"]["step"]["properties"]}


def main():
    schema = json.loads((ROOT / "docs/formats/description.schema.json").read_text())
    jsonschema.Draft7Validator.check_schema(schema)
    judge = jsonschema.Draft7Validator(schema)
    faults = []
    header = (ROOT / "chimera/description/keys.h").read_text()
    document = "".join((ROOT / f"docs/formats/{name}.md").read_text() for name in ("description", "sequence"))
    for name, properties in keys_of(schema).items():
        reader = set(array(header, name))
        faults += [f"{name}: {key} is in the reader or in the schema only" for key in sorted(reader ^ set(properties))]
        faults += [f"{name}: {key} is in neither description.md nor sequence.md" for key in sorted(reader)
                   if f"| `{key}` |" not in document]
    good = sorted((ROOT / "tests/verify/good").glob("*.yaml")) + sorted((ROOT / "examples").glob("**/*.yaml"))
    cases = json.loads((ROOT / "docs/formats/cases.schema.json").read_text())
    jsonschema.Draft7Validator.check_schema(cases)
    known = cases["definitions"]["case"]["properties"]
    header = (ROOT / "chimera/cli/batch/case_file.h").read_text()
    for name, properties in (("kCaseFileKeys", cases["properties"]), ("kCaseKeys", known)):
        faults += [f"{name}: {key} is in the reader or in the schema only"
                   for key in sorted(set(array(header, name)) ^ set(properties))]
    files = [path for path in good if path.name.endswith(".cases.yaml")]
    good = [path for path in good if path not in files]
    if not files:
        faults.append("no example has a file of cases")
    for path in files:
        for error in jsonschema.Draft7Validator(cases).iter_errors(yaml.load(path.read_text(), Yaml12)):
            faults.append(f"{path.relative_to(ROOT)}: {'/'.join(map(str, error.absolute_path))}: {error.message}")
    for path in good:
        for error in judge.iter_errors(yaml.load(path.read_text(), Yaml12)):
            faults.append(f"{path.relative_to(ROOT)}: {'/'.join(map(str, error.absolute_path))}: {error.message}")
    bad = [ROOT / f"tests/verify/faulty/{name}.yaml"
           for name in ("keys_unknown", "key_values", "keys_missing", "not_a_map")]
    for path in bad:
        if judge.is_valid(yaml.load(path.read_text(), Yaml12)):
            faults.append(f"{path.relative_to(ROOT)}: the schema accepts it")
    for fault in faults:
        print(fault)
    print(f"{len(good)} descriptions against the schema, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
