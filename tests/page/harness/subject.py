# SPDX-License-Identifier: Apache-2.0
"""The state of a subsystem that does not run: what door.py answers from. Each message has the form that a real
`chimera run` gives it; the schema judges each one when the page receives it."""
import time

STATES = ("NOT-CREATED", "OFF", "ON", "ERROR")
WIDTH, HEIGHT, GAP = 120, 60, 80  # of a box of the picture, and between two, in pixels


def port(name, kind, variable, unit="1", type_="float64"):
    return {"port": name, "kind": kind, "variable": variable, "type": type_, "unit": unit, "shape": "", "frame": None}


class Subject:
    """Tasks in the order of the description. `values`: name -> number; `operator`: names that a person sets."""

    def __init__(self, name="plant"):
        self.name, self.role, self.file = name, "configure", f"/machines/{name}.yaml"
        self.tasks, self.rtpus, self.values, self.operator = {}, {}, {}, set()
        self.configurations, self.configuration, self.flag_by = {}, "", []
        self.events, self.lost, self.published = [], 0, {}
        self.sequence = None
        self.switch, self.way = None, "fast"  # the switch under way; the way of the next one

    @staticmethod
    def chain(name="plant", length=3, doc="Adds one."):
        """TASK0 -> TASK1 -> ...; each reads the variable of the one before; the first reads the operator variable."""
        subject = Subject(name)
        subject.rtpus["servo"] = True
        subject.values["wish"], subject.operator = 1.0, {"wish"}
        before = "wish"
        for number in range(length):
            task, variable = f"task{number}", f"v{number}"
            subject.add(task, doc, [port("x", "in-var", before), port("y", "out-var", variable)])
            subject.values[variable] = float(number)
            before = variable
        subject.configurations = {"all": list(subject.tasks), "first": ["task0"]}
        subject.configuration = "all"
        return subject

    @staticmethod
    def steps():
        """A chain with a sequence whose second step runs."""
        subject = Subject.chain()
        outputs = {"sequence_step": 2.0, "sequence_state": 2.0, "sequence_waited": 4.0}
        subject.values.update(sequence_go=1.0, **outputs)
        subject.operator.add("sequence_go")
        subject.add("sequence", "Goes through steps.", [port("sequence_go", "in-var", "sequence_go"),
                                                        *(port(name, "out-var", name) for name in outputs)])
        keys = ("name", "switch", "until", "for", "within", "else")
        subject.sequence = {"line": 9, "path": "sequence", "repeat": False, "steps": [
            {**dict.fromkeys(keys), "number": number, "confirm": False, "reentry": number == 2, **words}
            for number, words in enumerate(({"switch": "near", "until": "v0 >= 1", "within": "10 s", "else": "far"},
                                            {"switch": "far", "until": "v1 >= 2", "within": "10 s"},
                                            {"name": "rest", "switch": "near"}), 1)]}
        return subject

    def add(self, task, doc, ports, state="ON", rtpu="servo"):
        self.tasks[task] = {"doc": doc, "ports": ports, "state": state, "rtpu": rtpu, "fault": None}

    # ---- changes

    def event(self, kind, text, **about):
        now = time.monotonic_ns()
        self.events.append({"number": len(self.events) + 1, "origin_ns": 1, "at_ns": now, "wall_ns": time.time_ns(),
                            "kind": kind, "text": text, **about})

    def to(self, task, state, fault=None):
        """Brings a task into a state, with its event. Returns what `signal` answers about it."""
        entry = self.tasks[task]
        before, entry["state"], entry["fault"] = entry["state"], state, fault
        self.event("fault" if state == "ERROR" else "state", fault or f"{before} -> {state}", task=task,
                   rtpu=entry["rtpu"])
        self.configuration = next((name for name, its in self.configurations.items() if set(its) == self.on()), "")
        return {"task": task, "before": before, "after": state}

    def on(self):
        return {name for name, task in self.tasks.items() if task["state"] == "ON"}

    # ---- answers

    def hello(self):
        return {"protocol": 1, "program": "0.1.0", "subsystem": self.name, "role": self.role, "file": self.file,
                "keeper_pid": 10, "session": 1, "folder": "/machines", "manager": {"pid": 11, "starts": 1}}

    def status(self):
        return {"subsystem": self.name, "configuration": self.configuration, "now_ns": time.monotonic_ns(),
                "origin_ns": 1, "started_ns": 2, "ending": False,
                "flag": {"up": bool(self.flag_by), "by": self.flag_by}, "switch": self.switch,
                "keeper": {"pid": 10, "hang": None}, "guard": None,
                "face": {"deaths": 0, "last_end": None, "lost_output": None},
                "cpus": [{"cpu": 1, "budgets": 0.005 * len(self.on()), "capacity": 0.93}],
                "rtpus": [self.rtpu(name, alive) for name, alive in self.rtpus.items()],
                "tasks": [self.task(name, task) for name, task in self.tasks.items()]}

    @staticmethod
    def rtpu(name, alive):
        return {"name": name, "cpu": 1, "policy": "edf", "executor": "executive", "pid": 12 if alive else 0,
                "incarnation": 1, "alive": alive, "phase": "serving" if alive else "ended", "grant": "",
                "running": None, "hang": None, "restarts": 0, "last_end": None if alive else "was killed by SIGKILL",
                "given_up": False, "remedy": None, "lost_events": 0, "resident_bytes": 20000000 if alive else 0,
                "first_resident_bytes": 20000000, "not_real_time": None, "lost_rights": None, "unguarded": None,
                "flag": False}

    @staticmethod
    def task(name, task):
        counts = ("cycles", "missed", "overrun", "dropped", "partial", "tolerated", "stale", "rejected", "preempted",
                  "demoted", "events", "events_lost", "exhausted", "faults")
        return {"task": name, "component": "adder", "rtpu": task["rtpu"], "state": task["state"], "in_service": False,
                "incarnation": 1, "standby_for": None, "rate_hz": 100.0, "period_ns": 10000000, "budget_ns": 50000,
                "server": None, "has_doorbell": False, "on_ns": 1000000000, "busy_ns": 20000000,
                "execution_ns": {"mean": 20000, "max": 40000},
                "response_ns": {"max": 50000}, "jitter_ns": 1000, "fault": task["fault"],
                "inputs": [{"port": p["port"], "variable": p["variable"], "age_ns": 1000000}
                           for p in task["ports"] if p["kind"] == "in-var"], **dict.fromkeys(counts, 0)}

    def describe(self, picture=False):
        tasks = [{"task": name, "component": "adder", "doc": task["doc"], "rtpu": task["rtpu"], "rate_hz": 100.0,
                  "aperiodic": False, "hardware": False, "standby_for": "", "stale_after_ns": 0, "hot": False,
                  "ports": task["ports"]} for name, task in self.tasks.items()]
        configurations = [{"name": name, "tasks": its} for name, its in self.configurations.items()]
        answer = {"tasks": tasks, "variables": [self.variable(name) for name in self.values],
                  "configurations": configurations, "start": next(iter(self.configurations), ""),
                  "sequence": self.sequence}
        return {**answer, "picture": self.picture()} if picture else answer

    def ends(self, variable, kind):
        return [{"task": name, "port": p["port"]} for name, task in self.tasks.items() for p in task["ports"]
                if p["variable"] == variable and p["kind"] == kind]

    def variable(self, name):
        return {"variable": name, "constant": False, "given": name in self.operator, "operator": name in self.operator,
                "least": None, "most": None, "type": "float64", "unit": "1",
                "shape": "", "producers": self.ends(name, "out-var"), "consumers": self.ends(name, "in-var")}

    def reading(self, name):
        producer = next((end["task"] for end in self.ends(name, "out-var")), "operator")
        value, now = self.values[name], time.monotonic_ns()
        task = self.tasks.get(producer)
        if task is None or task["state"] == "ON" and self.rtpus[task["rtpu"]]:
            self.published[name] = now - 1000000
        published = self.published.get(name, now)
        return {"value": value, "text": "never written" if value is None else f"{value:g}", "unit": "1",
                "type": "float64", "shape": "", "producer": producer,
                "state": "ON" if task is None else task["state"], "published_ns": published,
                "age_ns": now - published, "sequence": 1,
                "valid": value is not None}

    def readings(self, names=()):
        return {name: self.reading(name) for name in names or self.values}

    def picture(self):
        """Boxes in rows of ten, a straight line from each producer to each consumer."""
        place = {name: (GAP + i % 10 * (WIDTH + GAP), GAP + i // 10 * (HEIGHT + GAP))
                 for i, name in enumerate(self.tasks)}
        boxes = [{"task": name, "x": x, "y": y, "width": WIDTH, "height": HEIGHT} for name, (x, y) in place.items()]
        ports, lines, labels = [], [], [self.label(self.name, GAP, 20, "title")]
        for name, task in self.tasks.items():
            x, y = place[name]
            labels.append(self.label(name, x + WIDTH // 2, y + HEIGHT // 2, "name", task=name))
            for p in task["ports"]:
                at = x + (WIDTH if p["kind"] == "out-var" else 0)
                ports.append({"task": name, "port": p["port"], "kind": p["kind"], "variable": p["variable"], "x": at,
                              "y": y + HEIGHT // 2})
                labels.append(self.label(p["variable"], at, y - 4, "port", task=name, variable=p["variable"]))
        for start in (p for p in ports if p["kind"] == "out-var"):
            for end in (p for p in ports if p["kind"] == "in-var" and p["variable"] == start["variable"]):
                lines.append({"variable": start["variable"], "x1": start["x"], "y1": start["y"], "x2": end["x"],
                              "y2": end["y"], "arrow": "end"})
        size = (GAP + 10 * (WIDTH + GAP), 2 * GAP + (len(self.tasks) + 9) // 10 * (HEIGHT + GAP))
        return {"title": self.name, "width": size[0], "height": size[1], "boxes": boxes, "ports": ports,
                "lines": lines, "dots": [], "labels": labels}

    @staticmethod
    def label(text, x, y, style, task=None, variable=None):
        return {"text": text, "x": x, "y": y, "style": style, "anchor": "middle", "task": task, "variable": variable}

    def plan(self, on, to=None):
        now = self.on()
        return {"from": self.configuration or None, "to": to, "end": "nothing-to-do" if on == now else "possible",
                "reason": None, "why": None, "remedy": None, "way": self.way,
                "slow_because": [] if self.way == "fast" else ["no-gap"],
                "slow_why": None if self.way == "fast" else "init of task1 fits no gap",
                "expected_ns": 1100000, "late_off": None, "arrives": sorted(on - now), "leaves": sorted(now - on),
                "stays": sorted(on & now), "variables": []}

    def why(self, variable):
        reading = self.reading(variable)
        producer = "" if reading["producer"] == "operator" else reading["producer"]
        state = reading["state"]
        verdict = {"ON": "ok", "ERROR": "producer-error"}.get(state, "producer-off")
        link = {"depth": 0, "variable": variable, "producer": reading["producer"], "component": "adder",
                "rtpu": self.tasks[producer]["rtpu"] if producer else "", "state": state, "period_ns": 10000000,
                "published_ns": reading["published_ns"], "age_ns": 1000000, "valid": reading["valid"],
                "value": reading["text"], "verdict": verdict, "timing": "", "late": "", "inputs": []}
        return {"variable": variable, "chain": [link], "verdict": f"{variable} is {verdict}: {producer} is {state}"}
