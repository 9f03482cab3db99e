# SPDX-License-Identifier: Apache-2.0
"""The frames of the WebSockets of a page, held against the schemas of docs/formats."""
import json
import os
import pathlib
import re

import jsonschema

FORMATS = pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "docs" / "formats"
BASE = "file:///control.schema.json"
SCHEMA = json.loads((FORMATS / "control.schema.json").read_text())
STORE = {BASE: SCHEMA, "file:///run.schema.json": json.loads((FORMATS / "run.schema.json").read_text())}
KEY = re.compile(r"[A-Za-z0-9_-]{43}")
BENCH = {"hello_result": "bench_hello", "library_result": "bench_library"}  # two servers answer these
JUDGES = {}


def misfit(name, value):
    """Why the value is not what the definition says, or ""."""
    if name not in JUDGES:
        resolver = jsonschema.RefResolver(BASE, SCHEMA, store=STORE)
        JUDGES[name] = jsonschema.Draft7Validator({"$ref": f"#/definitions/{name}"}, resolver=resolver)
    fault = jsonschema.exceptions.best_match(JUDGES[name].iter_errors(value))
    return "" if fault is None else f"{name}: {fault.message[:300]} at {list(fault.absolute_path)}"


class Socket:
    """One WebSocket. `path`: the end of its address; `sent`, `received`: its lines without the key, in order."""

    def __init__(self, address):
        self.path = "/" + address.split("/", 3)[3]
        self.key, self.sent, self.received, self.asked, self.faults = None, [], [], {}, []

    def judge(self, name, value):
        fault = misfit(BENCH.get(name, name) if self.path == "/bench" else name, value)
        if fault:
            self.faults.append(f"{self.path}: {fault}: {json.dumps(value)[:400]}")

    def send(self, text):
        """A frame of the page: its key first, then requests."""
        if self.key is None:
            self.key = text
            if not KEY.fullmatch(text):
                self.faults.append(f"{self.path}: the first frame is no key: {text[:80]}")
            return
        request = json.loads(text)
        self.sent.append(request)
        self.asked[request.get("id")] = request["method"]
        self.judge("request", request)

    def receive(self, text):
        """A frame of the server: an answer, or a notification."""
        line = json.loads(text)
        self.received.append(line)
        if "method" in line:
            self.judge(line["method"] + "_note", line["params"])
        elif "error" in line:
            self.judge("answer", line)
        else:
            self.judge(self.asked.get(line["id"], "answer") + "_result", line["result"])


class Frames:
    """All WebSockets of a tab, in the order in which they were opened."""

    def __init__(self):
        self.sockets = {}

    def add(self, notices):
        """Takes what the browser reported: see Browser.notices()."""
        for method, facts in notices:
            if method == "Network.webSocketCreated":
                self.sockets[facts["requestId"]] = Socket(facts["url"])
            elif method in ("Network.webSocketFrameSent", "Network.webSocketFrameReceived"):
                frame, socket = facts["response"], self.sockets.get(facts["requestId"])
                if socket is not None and frame["opcode"] == 1:  # text; the others are pings and ends
                    (socket.send if method.endswith("Sent") else socket.receive)(frame["payloadData"])

    def faults(self):
        return [fault for socket in self.sockets.values() for fault in socket.faults]

    def of(self, path):
        return [socket for socket in self.sockets.values() if socket.path == path]

    def sent(self, path, method):
        """Parameters of the requests of this method, over all connections to the path."""
        return [request.get("params", {}) for socket in self.of(path) for request in socket.sent
                if request["method"] == method]

    def lines(self):
        """All frames as text, for people."""
        for socket in self.sockets.values():
            yield from (f"{socket.path} > {json.dumps(line)}" for line in socket.sent)
            yield from (f"{socket.path} < {json.dumps(line)}" for line in socket.received)
