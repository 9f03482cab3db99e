# SPDX-License-Identifier: Apache-2.0
"""The most costly questions that the limits of the control protocol allow, asked without a pause."""
import json
import random
import select
import socket
import threading

TASKS = 256

# Two rtpus, and in a third values of 3.9 MiB: nearly what all outputs of an application together may have.
LARGE_VALUES = """
subsystem: subject
rtpus:
  first: {cpu: 0, policy: edf}
  second: {cpu: 1, policy: edf}
  third: {cpu: 1, policy: edf}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  beside: {component: t_source, rtpu: second, rate: 100 Hz}
  large: {component: t_large, rtpu: third, rate: 1 Hz}
  reader: {component: t_reads_large, rtpu: third, rate: 1 Hz}
configurations: {all: [steady, beside, large, reader]}
start: all
"""


def loops(inputs=16, configurations=80):
    """256 joins of 16 inputs each, all in loops, in 80 configurations: 160 kB."""
    chosen = random.Random(3)
    lines = ["subsystem: costly", "tasks:"]
    for task in range(TASKS):
        read = ["base"] * (task == 0) + [f"j{chosen.randrange(TASKS)}" for _ in range(inputs - (task == 0))]
        lines.append(f"  t{task}: {{component: join_mean, rate: 10 Hz, initial: {{out: 0 rad}}, "
                     f"alias: {{out: j{task}, in: [{', '.join(read)}]}}}}")
    return "\n".join([*lines, "operator: {base: 1 rad}", *sets(configurations)]) + "\n"


def schedules(configurations=90):
    """256 tasks with budgets in 90 configurations: the answer of `schedule` has 6 MB."""
    lines = ["subsystem: costly", "tasks:"]
    for task in range(TASKS):
        lines.append(f"  t{task}: {{component: gain, rate: {10 + task % 90} Hz, budget: {10 + task % 7} us, "
                     f"alias: {{x: x, y: y{task}}}}}")
    return "\n".join([*lines, "operator: {x: 1}", *sets(configurations)]) + "\n"


def sets(configurations):
    names = ", ".join(f"t{task}" for task in range(TASKS))
    return ["configurations:", *[f"  c{number}: [{names}]" for number in range(configurations)], "start: c0"]


def request(method, **parameters):
    return json.dumps({"jsonrpc": "2.0", "id": 1, "method": method, "params": parameters}).encode() + b"\n"


class Load:
    """Connections that ask as much as they may: each has `ahead` requests under way and reads what comes back."""

    def __init__(self, path, asked):
        """`asked`: [(request line, how many connections, how many ahead)]"""
        self.stops, self.answers = False, 0
        self.threads = []
        for line, connections, ahead in asked:
            for _ in range(connections):
                opened = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
                opened.connect(str(path))
                opened.setblocking(False)
                self.threads.append(threading.Thread(target=self.ask, args=(opened, line, ahead)))
        for thread in self.threads:
            thread.start()

    def ask(self, opened, line, ahead):
        waiting, under_way = b"", 0
        with opened:
            while not self.stops:
                if not waiting and under_way < ahead:
                    waiting, under_way = line, under_way + 1
                readable, writable, _ = select.select([opened], [opened] if waiting else [], [], 0.1)
                try:
                    if writable:
                        waiting = waiting[opened.send(waiting):]
                    if readable:
                        got = opened.recv(1 << 18)
                        if not got:
                            return
                        ended = got.count(b"\n")
                        self.answers, under_way = self.answers + ended, under_way - ended
                except BlockingIOError:
                    pass
                except ConnectionError:
                    return

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stops = True
        for thread in self.threads:
            thread.join()


def worst_of_values():
    """As many connections, all for the values of LARGE_VALUES: all at once, one a thousand times, each value's reason,
    how old the inputs are, and each publication."""
    again = request("get", variables=["a"] * 9000)
    return [(request("get"), 5, 32), (again, 2, 8), (request("why", variable="sum"), 2, 32), (request("status"), 1, 32),
            (request("subscribe", to="values", period_ms=20), 2, 12), (request("subscribe", to="tap",
             variables=["n", "count", "x"]), 1, 12), (request("get", variables=["g"]), 1, 32)]


def worst():
    """14 connections: with the face and the one that acts all that one user may have."""
    check, schedule = request("check", text=loops()), request("schedule", text=schedules())
    return [(check, 5, 2), (schedule, 2, 2), (request("library"), 2, 32), (request("describe"), 1, 32),
            (request("status"), 2, 32), (request("events", since=0), 1, 32), (request("get"), 1, 32)]
