# SPDX-License-Identifier: Apache-2.0
"""A server of the control protocol for pages: it listens where a subsystem would, and answers from a Subject. A test
changes the subject, refuses requests, lets the server stall, die and come back."""
import contextlib
import json
import socket
import threading

from browser import PATIENCE
from subject import Subject

ROLES = ("observe", "operate", "configure")
NEEDS = {"signal": "operate", "ring": "operate", "set": "operate", "switch": "operate", "cancel": "operate",
         "flag": "operate", "drill": "configure", "save": "configure", "end": "configure"}
AFTER = {"on": "ON", "off": "OFF", "kill": "NOT-CREATED", "clear": "OFF", "reinit": "OFF", "spawn": "OFF"}


class Refusal(Exception):
    """An error of the protocol as an answer."""

    def __init__(self, code, message, data=None):
        super().__init__(message)
        self.error = {"code": code, "message": message, **({} if data is None else {"data": data})}


class Connection(threading.Thread):
    """Reads the requests of one peer; `topics`: subscription -> parameters."""

    def __init__(self, door, peer):
        super().__init__(daemon=True)
        self.door, self.peer, self.topics, self.seen = door, peer, {}, {}
        self.start()

    def run(self):
        with contextlib.suppress(OSError, ValueError), self.peer.makefile("rb") as lines:
            for line in lines:
                self.answer(json.loads(line))
        self.door.forget(self)

    def send(self, **message):
        with contextlib.suppress(OSError):
            self.peer.sendall(json.dumps({"jsonrpc": "2.0", **message}).encode() + b"\n")

    def answer(self, request):
        with self.door.lock:
            self.door.requests.append(request)
            self.door.answering.notify_all()
            self.door.answering.wait_for(lambda: not self.door.stalled)
            try:
                self.send(id=request["id"], result=self.door.act(self, request["method"], request.get("params", {})))
            except Refusal as refusal:
                self.send(id=request["id"], error=refusal.error)
            self.door.publish()

    def publish(self, subject):
        """Sends what the subscriptions have not seen."""
        for number, topic in self.topics.items():
            if topic["to"] == "status":
                self.send(method="status", params={"subscription": number, **subject.status()})
            elif topic["to"] == "values":
                self.send(method="values", params={"subscription": number, "at_ns": subject.status()["now_ns"],
                                                   "values": subject.readings(topic.get("variables", ()))})
            elif topic["to"] == "events" and self.seen[number] < len(subject.events):
                events = subject.events[self.seen[number]:]
                self.seen[number] = len(subject.events)
                lost, subject.lost = subject.lost, 0
                self.send(method="events", params={"subscription": number, "events": events, "lost": lost})


class Door:
    """The server of one subject, and a beat that sends values and status as a manager does."""

    def __init__(self, runtime, subject=None):
        self.subject = subject or Subject.chain()
        self.path = runtime / "chimera" / f"{self.subject.name}.sock"
        self.lock = threading.RLock()
        self.answering = threading.Condition(self.lock)
        self.connections, self.requests, self.refusals, self.stalled = [], [], {}, False
        self.listening, self.ended, self.number = None, threading.Event(), 0

    def __enter__(self):
        self.path.parent.mkdir(mode=0o700, exist_ok=True)
        self.listen()
        threading.Thread(target=self.beat, daemon=True).start()
        return self

    def __exit__(self, *_):
        self.ended.set()
        self.die()

    # ---- what a test does

    def listen(self):
        """Begins, or begins again after die()."""
        self.path.unlink(missing_ok=True)
        self.listening = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.listening.bind(str(self.path))
        self.listening.listen(64)
        threading.Thread(target=self.accept, args=(self.listening,), daemon=True).start()

    def die(self):
        """Ends each connection, and the socket: as the end of a subsystem."""
        self.path.unlink(missing_ok=True)
        self.resume()
        with contextlib.suppress(OSError):
            self.listening.shutdown(socket.SHUT_RDWR)
        self.listening.close()
        self.cut()

    def cut(self):
        """Ends each connection; new ones are accepted: as the death of a manager."""
        with self.lock:
            cut, self.connections = self.connections, []
        for connection in cut:
            with contextlib.suppress(OSError):
                connection.peer.shutdown(socket.SHUT_RDWR)
            connection.peer.close()

    def stall(self):
        """Neither answers nor sends until resume()."""
        with self.lock:
            self.stalled = True

    def resume(self):
        with self.lock:
            self.stalled = False
            self.answering.notify_all()

    def refuse(self, method, code, message, data=None):
        """Each request of this method is refused; message None: not any more."""
        with self.lock:
            self.refusals.pop(method, None)
            if message is not None:
                self.refusals[method] = Refusal(code, message, data)

    @contextlib.contextmanager
    def change(self):
        """Gives the subject to be changed, then sends the change to the subscribers."""
        with self.lock:
            yield self.subject
            self.publish()

    def tap(self, *records, rtpu="servo", lost=0):
        """Sends scheduling records to each subscription to the tap."""
        with self.lock:
            for connection in self.connections:
                for number, topic in connection.topics.items():
                    if topic["to"] == "tap":
                        connection.send(method="tap", params={"subscription": number, "rtpu": rtpu, "first": 0,
                                                              "lost": lost, "records": list(records)})

    def asked(self, method):
        """Parameters of the requests of that method so far."""
        with self.lock:
            return [request.get("params", {}) for request in self.requests if request["method"] == method]

    def await_asked(self, method, times=1):
        """Until that many requests of the method have arrived."""
        with self.lock:
            came = self.answering.wait_for(lambda: len(self.asked(method)) >= times, PATIENCE)
        assert came, f"{times} requests '{method}' did not come within {PATIENCE:.0f} s"

    # ---- what the server does

    def accept(self, listening):
        with contextlib.suppress(OSError):
            while True:
                peer, _ = listening.accept()
                with self.lock:
                    self.connections.append(Connection(self, peer))

    def beat(self):
        while not self.ended.wait(0.1):
            with self.lock:
                self.publish()

    def publish(self):
        if not self.stalled:
            for connection in self.connections:
                connection.publish(self.subject)

    def forget(self, connection):
        with self.lock:
            if connection in self.connections:
                self.connections.remove(connection)
        connection.peer.close()

    def act(self, connection, method, parameters):
        """The result of a request."""
        needed = NEEDS.get(method, "observe")
        if ROLES.index(needed) > ROLES.index(self.subject.role):
            raise Refusal(-32004, f"'{method}' needs the role {needed}", {"needs": needed, "has": self.subject.role})
        if method in self.refusals:
            raise self.refusals[method]
        if method in ("hello", "status"):
            return getattr(self.subject, method)()
        answer = getattr(self, method, None)
        if method in ("subscribe", "unsubscribe"):
            return answer(connection, **parameters)
        if method not in ("describe", "get", "events", "receipts", "profile", "plan", "why", *NEEDS) or answer is None:
            raise Refusal(-32601, f"no method '{method}'", {"where": method})
        return answer(**parameters)

    def subscribe(self, connection, to, since=None, **more):
        self.number += 1
        connection.topics[self.number] = {"to": to, **more}
        connection.seen[self.number] = len(self.subject.events) if since is None else max(0, since - 1)
        return {"subscription": self.number}

    def unsubscribe(self, connection, subscription):
        connection.topics.pop(subscription, None)
        return {}

    def describe(self, picture=False, **_):
        return self.subject.describe(picture)

    def profile(self):
        return {"tasks": []}

    def get(self, variables=()):
        return {"values": self.subject.readings(variables)}

    def events(self, since=0, limit=1000):
        events = self.subject.events
        return {"events": [event for event in events if event["number"] >= since][:limit],
                "first": 1 if events else 0, "last": len(events)}

    def receipts(self, **_):
        return {"receipts": [], "file": None, "unfiled": 0, "fault": None}

    def wanted(self, configuration=None, on=(), off=()):
        if configuration is not None:
            return set(self.subject.configurations[configuration])
        return (self.subject.on() | set(on)) - set(off)

    def plan(self, configuration=None, on=(), off=()):
        return self.subject.plan(self.wanted(configuration, on, off), configuration)

    def why(self, variable):
        return self.subject.why(variable)

    def signal(self, signal, tasks):
        return {"tasks": [self.subject.to(task, AFTER[signal]) for task in tasks]}

    def set(self, values):
        for name, value in values.items():
            self.subject.values[name] = float(str(value).split()[0])  # a number, or a text with a unit
            self.subject.event("set", f"{name} = {value}", by="configure:ann")
        return {"values": self.subject.readings(values)}

    def flag(self, up):
        self.subject.flag_by = ["operator"] if up else []
        self.subject.event("flag", "up: operator" if up else "down", by="configure:ann")
        return {"up": up, "by": self.subject.flag_by}

    def end(self, **_):
        return {}
