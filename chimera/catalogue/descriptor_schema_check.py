# SPDX-License-Identifier: Apache-2.0
"""Checks descriptor files against docs/formats/descriptor.schema.json, and that the schema refuses faulty ones.

usage: descriptor_schema_check.py SOURCE [FOLDER-WITH-COMPONENTS]
"""
import copy
import json
import pathlib
import sys

import jsonschema

LEGAL = ("smallest", "generic", "values")
SPOIL = (
    ("an unknown key", lambda d: d.update(colour="red")),
    ("a missing key", lambda d: d.pop("methods")),
    ("no cycle", lambda d: d.update(methods=["on"])),
    ("an unknown method", lambda d: d["methods"].append("cycel")),
    ("an unknown kind", lambda d: d["ports"][0].update(kind="invar")),
    ("a capital name", lambda d: d["ports"][0].update(name="X")),
    ("an extent without maximum", lambda d: d["ports"][0].update(shape="[n]")),
    ("a text for a size", lambda d: d["ports"][0].update(element_size="8")),
    ("an unknown port key", lambda d: d["ports"][0].update(units="m")),
    ("another format", lambda d: d.update(format=2)),
    ("a field of a struct in a struct", lambda d: d["ports"][5]["fields"][0].update(type="struct")),
)


def main():
    source = pathlib.Path(sys.argv[1])
    schema = json.loads((source / "docs/formats/descriptor.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    corpus = source / "chimera/catalogue/descriptor_json_corpus"
    files = [corpus / f"{name}.json" for name in LEGAL]
    if len(sys.argv) > 2:
        files += sorted(pathlib.Path(sys.argv[2]).glob("*.component.json"))
    failed = 0
    for file in files:
        for error in validator.iter_errors(json.loads(file.read_text(encoding="utf-8"))):
            print(f"{file}: {error.json_path}: {error.message}")
            failed += 1
    values = json.loads((corpus / "values.json").read_text(encoding="utf-8"))
    for what, spoil in SPOIL:
        spoiled = copy.deepcopy(values)
        spoil(spoiled)
        if validator.is_valid(spoiled):
            print(f"the schema accepts {what}")
            failed += 1
    print(f"{len(files)} descriptors and {len(SPOIL)} faulty ones judged, {failed} wrongly")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
