# SPDX-License-Identifier: Apache-2.0
"""Attacks the socket of a running subsystem: mutated lines, lines that do not end, connections that come and go or
never read, by its own user and by two users with the role observe. The last line counts lines and has the cycles that
were lost. How long the owner waits: bench row 21.

usage: door_campaign.py --build TREE --seconds N
"""
import argparse
import atexit
import copy
import grp
import json
import os
import pathlib
import random
import resource
import socket
import subprocess
import sys
import time

import campaigns

OBSERVERS = 61001  # the first of two users whose group has the role observe
GROUP = next(g for g in grp.getgrall() if g.gr_gid not in (0, 65534))
ROUND, CLEAN = 12.0, 6.0  # seconds of attack, and without
HIGHEST_MIB, GROWTH_MIB = 256, 32

TEXT = """
subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}}
tasks: {steady: {component: t_counter, rtpu: first, rate: 1 kHz}}
configurations: {all: [steady]}
start: all
"""

# Correct requests, before mutation. Neither they nor mixtures of them change the tasks.
RIGHT = [("hello", {}), ("status", {}), ("describe", {}), ("get", {"variables": ["count"]}), ("profile", {}),
         ("events", {"since": 0, "limit": 10}), ("why", {"variable": "count"}), ("unsubscribe", {"subscription": 1}),
         ("subscribe", {"to": "values", "period_ms": 20, "variables": ["count"], "since": 0}),
         ("check", {"text": "subsystem: a", "file": "a.yaml"}), ("schedule", {"text": "subsystem: a"}),
         ("signal", {"signal": "on", "tasks": ["absent"]}), ("ring", {"tasks": ["absent"]}),
         ("set", {"values": {"nothing": 2}}), ("flag", {"up": False}), ("save", {})]
ODD = [None, True, False, "", "count", "absent", [], {}, [[]], {"a": {}}, 0, -1, 1, 2 ** 31, 2 ** 63, 2 ** 64, -2 ** 63,
       1e308, 1.5, "\ud800", "\u0000", "\u202e", "é" * 50, "x" * 5000, ["count"] * 300]
SIGNS = [b"\x00", b"\xff", b"\xc0\x80", b"\xed\xa0\x80", b"\xf4\x90\x80\x80", b"{", b"}", b"[", b"]", b'"', b"\\", b",",
         b":", b"\\ud800", b"1e400", b"NaN", b"-", b"\r", b"\xef\xbb\xbf", b"\n"]


def mutated(dice):
    """One line with its end. Most lines are almost right."""
    kind = dice.random()
    if kind < 0.05:
        return bytes(dice.randrange(256) for _ in range(dice.randrange(80))).replace(b"\n", b" ") + b"\n"
    if kind < 0.06:
        depth = dice.choice((30, 31, 32, 33, 500))
        return b'{"jsonrpc":"2.0","id":1,"method":"set","params":' + b"[" * depth + b"]" * depth + b"}\n"
    method, parameters = dice.choice(RIGHT)
    request = {"jsonrpc": "2.0", "id": dice.choice((1, "a", 2 ** 60)), "method": method, "params": dict(parameters)}
    for _ in range(dice.randrange(3)):
        inside = dice.choice((request, request["params"])) if isinstance(request.get("params"), dict) else request
        key = dice.choice([*inside, "more"])
        if dice.random() < 0.3:
            inside.pop(key, None)
        else:
            inside[key] = copy.deepcopy(dice.choice(ODD))
    line = json.dumps(request).encode("utf-8", "surrogatepass")
    if dice.random() < 0.1:  # a key twice
        line = line[:-1] + b',"id":2}'
    for _ in range(dice.choice((0, 0, 1, 3))):
        at = dice.randrange(len(line))
        line = line[:at] + dice.choice(SIGNS) + line[at + dice.randrange(3):]
    return line + b"\n"


def connected(path):
    one = socket.socket(socket.AF_UNIX)
    one.connect(path)
    one.settimeout(60)
    return one


class Mutator:
    """A connection that is answered: each of its lines in time, in words of the protocol."""

    def __init__(self, path, dice):
        self.path, self.dice, self.lines, self.faults, self.number = path, dice, 0, [], 0
        self.socket, self.rest = None, b""

    def answers(self, until):
        """Whole lines until the one with that id, or until the server closes the connection."""
        while True:
            *lines, self.rest = self.rest.split(b"\n") if b"\n" in self.rest else [self.rest]
            for line in lines:
                message = json.loads(line)
                if message.get("jsonrpc") != "2.0" or not {"result", "error", "method"} & set(message):
                    self.faults.append(f"no JSON-RPC: {line[:200]}")
                if message.get("id") == until and "method" not in message:
                    return True
            got = self.socket.recv(1 << 16)
            if not got:
                return False
            self.rest += got

    def turn(self):
        try:
            if self.socket is None:
                self.socket, self.rest = connected(self.path), b""
            self.number += 1
            mark = f"mark {self.number}"
            batch = [mutated(self.dice) for _ in range(100)]
            self.lines += len(batch)
            self.socket.sendall(b"".join(batch) + b"\n" + json.dumps(
                {"jsonrpc": "2.0", "id": mark, "method": "hello"}).encode() + b"\n")
            if self.answers(mark):
                return
        except socket.timeout:
            self.faults.append("no answer within 60 s")
        except (BrokenPipeError, ConnectionError):
            pass  # a line beyond a limit ends a connection, and so does another that needs its place
        except ValueError as wrong:
            self.faults.append(f"no JSON: {wrong}")
        self.socket.close()
        self.socket = None


def mutate(path, end, dice):
    peers = [Mutator(path, dice) for _ in range(4)]
    while time.monotonic() < end:
        for peer in peers:
            peer.turn()
    return sum(peer.lines for peer in peers), [fault for peer in peers for fault in peer.faults]


def crowd(path, end, dice):
    """Lines that do not end, of all lengths; connections that come and go; that ask or subscribe and never read."""
    ask = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "library"}).encode() + b"\n"
    listen = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "subscribe",
                         "params": {"to": "status", "period_ms": 20}}).encode() + b"\n"
    sayings = [b"{" * 40, b"", ask, ask * 300, listen * 8, listen * 40, b" " * (2 ** 20 - 1), b" " * 2 ** 20,
               b" " * (2 ** 20 + 1), b"[" * (2 ** 20 - 1) + b"\n", b" " * (2 ** 20 - 1) + b"\n", b" " * 2 ** 20 + b"\n"]
    held, made = [], 0
    while time.monotonic() < end:
        for _ in range(dice.choice((1, 20, 200))):
            made += 1
            one = socket.socket(socket.AF_UNIX)
            one.setblocking(False)
            try:
                one.connect(path)
                one.send(dice.choice(sayings))
            except OSError:
                pass
            held.append(one)
        dice.shuffle(held)
        while len(held) > 200 or (held and dice.random() < 0.5):
            held.pop().close()
        time.sleep(dice.choice((0.001, 0.01, 0.1)))
    return made, []


KINDS = {"mutate": mutate, "crowd": crowd}


def begun(kind, path, seconds, seed, user=None):
    who = {"user": user, "group": user, "extra_groups": [GROUP.gr_gid]} if user else {}
    words = ["--kind", kind, "--socket", path, "--seconds", str(seconds), "--seed", str(seed)]
    return kind, subprocess.Popen([sys.executable, __file__, *words], stdout=subprocess.PIPE, cwd="/", **who)


def attacked(path, seed, is_root):
    """One round: {kind: [(count, faults)]}"""
    users = [None, OBSERVERS, OBSERVERS + 1] if is_root else [None]
    running = [begun(kind, path, ROUND, seed + 10 * i, user) for i, user in enumerate(users)
               for kind in ("mutate", "crowd") if user is None or (kind == "crowd") == (user > OBSERVERS)]
    results = {}
    for kind, process in running:
        out = process.communicate(timeout=120 + ROUND)[0]
        results.setdefault(kind, []).append(json.loads(out) if process.returncode == 0 else [0, [f"{kind} failed"]])
    return results


def memory_mib(pid, key):
    lines = pathlib.Path(f"/proc/{pid}/status").read_text().splitlines()
    return int(next(line for line in lines if line.startswith(key)).split()[1]) / 1024


class Door:
    def __init__(self, _):
        from system import System
        self.is_root = os.getuid() == 0
        options = ("--priority", "60", "--observe-group", GROUP.gr_name) if self.is_root else ()
        self.system = System(TEXT, options)
        atexit.register(self.system.end)  # also when the campaign fails
        for folder in (self.system.place, self.system.runtime):
            folder.chmod(0o711)
        self.n = self.connections = 0
        self.lost, self.cycles = [0, 0], [0, 0]  # clean, attacked
        self.pids = self.system.pids()
        self.before = self.state()
        self.descriptors = self.system.descriptors(self.pids["manager"])
        self.memory = memory_mib(self.pids["manager"], "VmRSS")

    def state(self):
        task = self.system.task("steady")
        return task["state"], task["incarnation"], task["faults"], self.system.call("hello")["manager"]["starts"]

    def span(self, is_attacked, act):
        before = self.system.task("steady")
        result = act()
        after = self.system.task("steady")
        self.lost[is_attacked] += after["missed"] - before["missed"]
        self.cycles[is_attacked] += after["cycles"] - before["cycles"]
        return result

    def once(self, _):
        self.span(0, lambda: time.sleep(CLEAN))
        found = self.span(1, lambda: attacked(str(self.system.socket), random.randrange(1 << 31), self.is_root))
        self.n += sum(count for count, _ in found["mutate"])
        self.connections += sum(count for count, _ in found["crowd"])
        faults = [f"{kind}: {fault}" for kind, results in found.items() for _, faults in results for fault in faults]
        return faults + list(self.judge())

    def judge(self):
        if self.system.pids() != self.pids or self.state() != self.before:
            yield f"{self.before} {self.pids} became {self.state()} {self.system.pids()}"
            self.pids, self.before = self.system.pids(), self.state()
        end = time.monotonic() + 60
        while (now := self.system.descriptors(self.pids["manager"])) > self.descriptors + 1 and time.monotonic() < end:
            time.sleep(0.1)  # until the manager notices which clients are gone
        if now > self.descriptors + 1:
            yield f"{self.descriptors} descriptors became {now}"
        highest, growth = (memory_mib(self.pids["manager"], "VmHWM"),
                           memory_mib(self.pids["manager"], "VmRSS") - self.memory)
        if highest > HIGHEST_MIB or growth > GROWTH_MIB:
            yield f"manager {highest:.0f} MiB at most, {growth:.0f} MiB more than before"

    def figures(self):
        return {"n": self.n, "counted": "lines", "connections": self.connections, "lost_clean": self.lost[0],
                "cycles_clean": self.cycles[0], "lost": self.lost[1], "cycles": self.cycles[1]}


def attacker():
    """One kind of attack, as a program of its own; prints (count, faults)."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--kind", choices=KINDS)
    parser.add_argument("--socket")
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--seed", type=int)
    arguments = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_NOFILE, (1024, 1024))
    print(json.dumps(KINDS[arguments.kind](arguments.socket, time.monotonic() + arguments.seconds,
                                           random.Random(arguments.seed))))
    return 0


if __name__ == "__main__":
    sys.exit(attacker() if "--kind" in sys.argv else campaigns.run("hostile_door", __doc__, Door))
