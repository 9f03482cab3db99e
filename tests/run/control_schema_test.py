# SPDX-License-Identifier: Apache-2.0
"""Real exchanges with a running subsystem, right and wrong ones, against docs/formats/control.schema.json: every line
in both directions, and of every answer what its method promises."""
import json
import os
import pathlib
import sys
import unittest

import jsonschema

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "processes"))
from system import Client, Refused, System  # noqa: E402

SOURCE = pathlib.Path(os.environ.get("CHIMERA_SOURCE", pathlib.Path(__file__).parents[2]))
SCHEMA = json.loads((SOURCE / "docs" / "formats" / "control.schema.json").read_text())
TEXT = """
subsystem: subject
rtpus:
  first: {cpu: 0, policy: edf}
  second: {cpu: 1, policy: edf}
tasks:
  a: {component: t_recorder, rtpu: first, rate: 200 Hz, alias: {x: x0, y: x1}}
  b: {component: t_recorder, rtpu: second, rate: 200 Hz, alias: {x: x1, y: x2}}
operator: {x0: 0}
configurations: {all: [a, b]}
start: all
"""


def judge(message, definition=None):
    schema = SCHEMA if definition is None else {"$ref": f"#/definitions/{definition}",
                                                "definitions": SCHEMA["definitions"]}
    jsonschema.Draft7Validator(schema).validate(message)


class Judged(Client):
    """A client every line of which is held against the schema."""

    def line(self):
        message = super().line()
        judge(message)
        return message


class Exchanges(unittest.TestCase):
    def test_every_method_and_subscription(self):
        with System(TEXT, ("--priority", "0")) as system:
            client = Judged(system.socket)
            calls = [("hello", {}), ("status", {}), ("describe", {}), ("get", {}), ("get", {"variables": ["x1"]}),
                     ("profile", {}), ("events", {"since": 0, "limit": 5}), ("why", {"variable": "x2"}),
                     ("library", {}),
                     ("check", {"text": TEXT}), ("check", {"text": "nonsense", "file": "n.yaml"}),
                     ("set", {"values": {"x0": 1.5}}), ("save", {}), ("flag", {"up": True}), ("flag", {"up": False}),
                     ("signal", {"signal": "off", "tasks": ["b"]}), ("signal", {"signal": "on", "tasks": ["b"]}),
                     ("why", {"variable": "x0"}), ("events", {})]
            for method, parameters in calls:
                judge({"jsonrpc": "2.0", "id": 1, "method": method, "params": parameters})
                judge(client.call(method, **parameters), method)
            for parameters in ({"to": "status", "period_ms": 20}, {"to": "values", "variables": ["x1"]},
                               {"to": "events", "since": 0}, {"to": "tap", "variables": ["x1", "x2"]}, {"to": "tap"}):
                judge({"jsonrpc": "2.0", "id": 1, "method": "subscribe", "params": parameters})
                number = client.call("subscribe", **parameters)
                judge(number, "subscribe")
                while client.note()["params"]["subscription"] != number["subscription"]:
                    pass
                judge(client.call("unsubscribe", **number), "unsubscribe")
            judge(client.call("end"), "end")
            client.close()
            system.disconnect()
            system.process.wait(10)

    def test_refusals(self):
        with System(TEXT, ("--priority", "0")) as system:
            client = Judged(system.socket)
            for method, parameters in (("nonsense", {}), ("get", {"variables": ["x9"]}), ("get", {"variable": 1}),
                                       ("signal", {"signal": "on", "tasks": ["a"]}), ("set", {"values": {"x1": 1}}),
                                       ("signal", {"signal": "wakeup", "tasks": ["a"]}), ("why", {}),
                                       ("subscribe", {"to": "all"}), ("unsubscribe", {"subscription": 99}),
                                       ("signal", {"signal": "off", "tasks": ["nobody"]})):
                with self.subTest(method=method, parameters=parameters), self.assertRaises(Refused):
                    client.call(method, **parameters)
            client.close()

    def test_the_schema_can_refuse(self):
        for wrong in ({"jsonrpc": "2.0", "id": 1, "method": "get", "params": {"variable": "x"}}, {"id": 1},
                      {"jsonrpc": "2.0", "id": 1, "result": {}, "error": {}}):
            with self.assertRaises(jsonschema.ValidationError):
                judge(wrong)
        with self.assertRaises(jsonschema.ValidationError):
            judge({"up": 1}, "flag")


if __name__ == "__main__":
    unittest.main(verbosity=1)
