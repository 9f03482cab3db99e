# SPDX-License-Identifier: Apache-2.0
"""A running subsystem sends and accepts messages as docs/formats/control.schema.json says, in real exchanges of every
kind: all methods, all notifications, refusals, and requests that are almost right."""
import copy
import json
import pathlib
import re
import sys
import time
import unittest

import jsonschema

from system import TOO_FAST, Client, System, await_that

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests/install"))
from run_schema import cut  # noqa: E402

FORMATS = SOURCE / "docs/formats"
SCHEMA = json.loads((FORMATS / "control.schema.json").read_text())
BASE = "file:///control.schema.json"
STORE = {BASE: SCHEMA, "file:///run.schema.json": json.loads((FORMATS / "run.schema.json").read_text())}
METHODS = [name.removesuffix("_parameters") for name in SCHEMA["definitions"] if name.endswith("_parameters")]
BAD_REQUEST, NO_METHOD, BAD_PARAMETERS = -32600, -32601, -32602

APPLICATION = """
subsystem: subject
rtpus:
  first: {cpu: 0, policy: edf}
  second: {cpu: 1, policy: muf}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 100 Hz}
  adder: {component: t_recorder, rtpu: first, rate: 100 Hz, alias: {x: level}}
  victim:
    component: t_crash
    rtpu: second
    rate: 100 Hz
    alias: {y: y_victim}
    constants: {where: cycle, how: nan}
    resources: {armed: ARMED}
  spare: {component: t_source, rtpu: second, rate: 100 Hz}
operator: {level: 1}
configurations:
  all: [steady, adder, victim]
  less: [steady, adder]
start: all
"""


def judge(name):
    resolver = jsonschema.RefResolver(BASE, SCHEMA, store=STORE)
    return jsonschema.Draft7Validator({"$ref": f"#/definitions/{name}"}, resolver=resolver)


JUDGES = {name: judge(name) for name in SCHEMA["definitions"]}


class Judged(Client):
    """A connection that checks every line against the schema. It collects faults and does not raise them."""

    def __init__(self, path):
        super().__init__(path)
        self.faults, self.last, self.codes = [], {}, set()

    def hold(self, name, what, where):
        self.faults += [f"{where}: {name}: {'/'.join(map(str, e.absolute_path))}: {e.message}"
                        for e in JUDGES[name].iter_errors(what)]
        self.last[name] = what

    def line(self):
        message = super().line()
        if "method" in message:
            self.hold("notification", message, "a notification")
            if message["method"] in ("status", "events", "values", "tap"):
                name = message["method"] + "_note"
                if name == "tap_note":
                    name = "tap_rows" if "rows" in message["params"] else "tap_records"
                self.hold(name, message["params"], "a notification")
        else:
            self.hold("answer", message, "an answer")
        return message

    def raw(self, text):
        """The answer to a line of bytes."""
        self.socket.sendall(text if isinstance(text, bytes) else text.encode() + b"\n")
        while "method" in (answer := self.line()):
            self.notes.append(answer)
        if "error" in answer:
            self.hold("error", answer["error"], str(text)[:60])
            self.codes.add(answer["error"]["code"])
        return answer

    def ask(self, request):
        while True:
            answer = self.raw(json.dumps(request))
            if answer.get("error", {}).get("code") != TOO_FAST:
                return answer
            time.sleep(answer["error"]["data"]["retry_ms"] / 1e3)

    def exchange(self, method, **parameters):
        """A request within the schema. Returns its result, or None if it was refused for its meaning."""
        self.number += 1
        request = {"jsonrpc": "2.0", "id": self.number, "method": method, "params": parameters}
        self.hold("request", request, method)
        self.hold(f"{method}_parameters", parameters, method)
        answer = self.ask(request)
        if answer["id"] != self.number:
            self.faults.append(f"{method}: another id: {answer}")
        if "result" in answer:
            self.hold(f"{method}_result", answer["result"], method)
        return answer.get("result")


GOOD = {"hello": {}, "status": {}, "describe": {"picture": True, "configuration": "all"},
        "get": {"variables": ["count"]}, "profile": {},
        "events": {"since": 0, "limit": 10}, "receipts": {"last": 20}, "why": {"variable": "count"},
        "plan": {"configuration": "all"},
        "subscribe": {"to": "values", "period_ms": 20, "variables": ["count"], "since": 0},
        "unsubscribe": {"subscription": 1}, "check": {"text": "subsystem: a", "file": "a.yaml"},
        "schedule": {"text": "subsystem: a", "file": "a.yaml"}, "library": {}, "text": {},
        "signal": {"signal": "on", "tasks": ["steady"]}, "ring": {"tasks": ["steady"]},
        "set": {"values": {"level": 2}}, "flag": {"up": False},
        "switch": {"configuration": "all", "wait_ms": 1000}, "cancel": {}, "drill": {"wait_ms": 100}, "save": {},
        "end": {"code": 0}, "machines": {}, "draft": {}, "edit": {"version": 1, "acts": [{"act": "remove"}]},
        "replace": {"version": 1, "text": "a"}, "remedies": {"version": 1}, "transitions": {"version": 1},
        "differences": {"text": "a"},
        "write": {"version": 1}, "keep": {"what": "file"}, "start": {}, "output": {},
        "sheet": {"component": "counter"}, "document": {"name": "README.md"},
        "values": {"component": "counter", "port": "count"},
        "try": {"version": 1, "duration": "1 s", "watch": ["q"]}, "scope": {"machine": "arm", "channels": ["q"]},
        "result": {"number": 1}, "halt": {"number": 1}}
VALUES = [None, True, "", "nothing", [], ["count", 1], {}, -1, 0, 1, 1.5, 19, 20, 255, 256, 1000, 1001, 60000, 60001,
          2 ** 63 - 1]


def almost_right():
    """Requests that are one step away from a correct one."""
    for method, parameters in GOOD.items():
        request = {"jsonrpc": "2.0", "id": 1, "method": method, "params": parameters}
        yield {**request, "more": 1}
        yield {**request, "jsonrpc": "1.0"}
        yield {**request, "method": method + "s"}
        for missing in ("jsonrpc", "method", "params"):
            yield {k: v for k, v in request.items() if k != missing}
        for wrong in (None, [], 1):
            yield {**request, "params": wrong}
        for _, smaller in cut(parameters):
            yield {**request, "params": smaller}
        yield {**request, "params": {**parameters, "more": 1}}
        for key in parameters:
            for value in VALUES:
                yield {**request, "params": {**parameters, key: value}}


def ends(request):
    return request.get("method") == "end" and JUDGES["request"].is_valid(request)


class Protocol(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        self.system = System(APPLICATION)
        self.addCleanup(self.system.end)
        self.client = Judged(self.system.socket)
        self.addCleanup(self.client.close)

    def tearDown(self):
        self.assertEqual(self.client.faults, [])

    def read_all(self):
        for method in ("hello", "status", "describe", "profile", "events", "library", "text", "get", "save",
                       "receipts"):
            self.assertIsNotNone(self.client.exchange(method), method)
        self.assertIsNotNone(self.client.exchange("describe", picture=True, configuration="less"))
        for variable in ("count", "level", "x", "y_victim"):
            self.assertIsNotNone(self.client.exchange("why", variable=variable))
        self.assertTrue(self.client.exchange("get")["values"]["count"]["valid"])
        self.assertIsNotNone(self.client.exchange("plan", configuration="all"))
        for text in (APPLICATION, "subsystem: [", ""):
            self.assertIsNotNone(self.client.exchange("check", text=text, file="a.yaml"))
            self.assertIsNotNone(self.client.exchange("schedule", text=text, file="a.yaml"))

    def test_answers_fit_the_schema_before_and_after_faults(self):
        self.read_all()
        self.system.arm()
        self.system.await_state("victim", "ERROR")
        self.system.disarm()
        self.assertEqual(self.client.exchange("why", variable="y_victim")["chain"][0]["verdict"], "producer-error")
        self.read_all()
        self.system.kill(self.system.pids()["first"])
        await_that(lambda: self.client.exchange("status")["rtpus"][0]["restarts"] == 1, "a restart")
        self.system.await_state("steady", "ON")
        self.read_all()
        kinds = {event["kind"] for event in self.client.exchange("events")["events"]}
        self.assertLessEqual({"manager-started", "started", "state", "fault", "rtpu-ended", "rtpu-restarted"}, kinds)

    def test_acts_and_their_refusals_are_within_the_schema(self):
        self.assertIsNone(self.client.exchange("signal", signal="off", tasks=["stedy"]))
        self.assertIsNone(self.client.exchange("signal", signal="clear", tasks=["steady"]))
        self.assertIsNone(self.client.exchange("why", variable="z"))
        outcomes = self.client.exchange("signal", signal="off", tasks=["steady", "adder"])["tasks"]
        self.assertEqual(sorted(outcomes, key=lambda o: o["task"]),
                         [{"task": t, "before": "ON", "after": "OFF"} for t in ("adder", "steady")])
        self.assertIsNotNone(self.client.exchange("signal", signal="on", tasks=["adder", "steady"]))
        self.assertEqual(self.client.exchange("set", values={"level": "3"})["values"]["level"]["text"], "3")
        self.assertEqual(self.client.exchange("set", values={"level": 4})["values"]["level"]["value"], 4)
        for wrong in ({"level": "3 m"}, {"level": [1, 2]}, {"count": 1}, {"lvel": 1}):
            self.assertIsNone(self.client.exchange("set", values=wrong))
        self.assertIn("end", self.client.exchange("switch", configuration="less"))
        self.assertIn("end", self.client.exchange("plan", configuration="all"))
        self.assertIsNone(self.client.exchange("plan", configuration="al"))
        self.assertIsNone(self.client.exchange("cancel"))
        self.assertGreaterEqual(len(self.client.exchange("receipts")["receipts"]), 1)
        self.assertIsNotNone(self.client.exchange("flag", up=True))
        self.assertEqual(self.client.exchange("status")["flag"], {"up": True, "by": ["operator"]})
        self.assertIsNotNone(self.client.exchange("flag", up=False))
        for text in ("no json", "[]", "7", '{"jsonrpc":"2.0","id":1,"method":"helo"}'):
            self.client.raw(text)
        flood, asked = b'{"jsonrpc":"2.0","id":1,"method":"cancel"}\n' * 100, 0
        while -32003 not in self.client.codes:  # until they come faster than 100 acts a second
            self.client.socket.sendall(flood)
            asked += 100
            for _ in range(100):
                self.client.codes.add(self.client.line().get("error", {}).get("code"))
            self.assertLess(asked, 100_000, "no act came too fast")
        self.client.raw("[" * 33)
        self.assertLessEqual({-32700, -32600, -32601, -32602, -32000, -32001, -32003, -32005}, self.client.codes)

    def test_notifications_are_within_the_schema_and_without_a_gap(self):
        numbers = {}
        for to, more in (("status", {}), ("values", {"period_ms": 20}), ("events", {"since": 0}),
                         ("tap", {"variables": ["count", "y_victim"]}), ("tap", {})):
            numbers[to] = self.client.exchange("subscribe", to=to, **more)["subscription"]
        self.assertIsNotNone(self.client.exchange("unsubscribe", subscription=numbers["status"]))
        self.assertIsNone(self.client.exchange("unsubscribe", subscription=numbers["status"]))
        wanted, follows, rows = {"status_note", "values_note", "events_note", "tap_rows", "tap_records"}, {}, 0
        while rows < 100 or not wanted <= self.client.last.keys():
            note = self.client.note()["params"]
            numbered = note.get("rows", note.get("records"))
            if numbered is None:
                continue
            of = (note["rtpu"], note.get("task"))
            self.assertEqual(note["first"], follows.get(of, 0))
            follows[of] = note["first"] + note["lost"] + len(numbered)
            rows += len(note.get("rows", []))

    def test_a_request_is_accepted_exactly_when_it_is_within_the_schema(self):
        judged = refused = 0
        for request in almost_right():
            if ends(request):
                continue
            is_within = JUDGES["request"].is_valid(request)
            answer = self.client.ask(request)
            code = answer.get("error", {}).get("code")
            is_form = code in (BAD_REQUEST, NO_METHOD, BAD_PARAMETERS)
            # The meaning of a value for this application is not in the schema.
            by_meaning = code == BAD_PARAMETERS and request["method"] == "set"
            if is_form == is_within and not by_meaning:
                self.client.faults.append(f"{'within' if is_within else 'outside'}: {request}: {answer}")
            if request.get("method") == "subscribe" and "result" in answer:
                self.client.ask({"jsonrpc": "2.0", "id": 2, "method": "unsubscribe", "params": answer["result"]})
            judged, refused = judged + 1, refused + is_form
        self.assertGreater(refused, 200)
        self.assertGreater(judged - refused, 30)


class Schema(unittest.TestCase):
    def test_it_is_a_schema_and_every_definition_is_used(self):
        jsonschema.Draft7Validator.check_schema(SCHEMA)
        text = json.dumps(SCHEMA)
        for name in SCHEMA["definitions"]:
            used = f'"#/definitions/{name}"' in text
            self.assertTrue(used, name)

    def test_methods_and_parameters_agree_with_the_document(self):
        rows = re.findall(r"^\| `([a-z]+)` \|(.*?)(?<!\\)\|", (FORMATS / "control.md").read_text(), re.M)
        told = {name: row for name, row in rows if name in METHODS or f"{name}_result" in SCHEMA["definitions"]}
        self.assertEqual(sorted(told), sorted(METHODS))
        self.assertEqual(sorted(METHODS), sorted(GOOD))
        for method in METHODS:
            for parameter in SCHEMA["definitions"][f"{method}_parameters"].get("properties", {}):
                self.assertIn(f'"{parameter}"', told[method], method)

    def test_the_schema_misses_each_key_that_is_left_out(self):
        with System(APPLICATION) as system:
            client = Judged(system.socket)
            more = {"why": {"variable": "y"}, "describe": {"picture": True}}
            for method in ("hello", "status", "describe", "get", "events", "why", "library"):
                client.exchange(method, **more.get(method, {}))
            client.close()
        # Keys that are there only where they apply:
        free = {("events_result", "task"), ("events_result", "rtpu"), ("describe_result", "picture")}
        for name, sample in copy.copy(client.last).items():
            if not name.endswith("_result"):
                continue
            for at, smaller in cut(sample):
                is_own = len(at) > 1 and at[-2] == "values"
                if not is_own and (name, at[-1]) not in free:
                    self.assertFalse(JUDGES[name].is_valid(smaller), f"{name} does not miss {at}")


if __name__ == "__main__":
    unittest.main(verbosity=1)
