# SPDX-License-Identifier: Apache-2.0
"""Attacks the door of a running subsystem for a time: mutated lines, lines that do not end, connections that come and
go or never read, by its own user and by two who may only look. Its last line says how many lines and what failed.

usage: door_campaign.py --build TREE --seconds N
"""
import argparse
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

PROCESSES = pathlib.Path(__file__).resolve().parents[1] / "processes"
OBSERVERS = 61001  # the first of two users whose group has the role observe
GROUP = next(g for g in grp.getgrall() if g.gr_gid not in (0, 65534))
ROUND, CLEAN = 12.0, 6.0  # seconds of attack, and without
NOISE = 1e-3  # share of cycles that a virtual machine loses by itself
LIMIT_MS, HIGHEST_MIB, GROWTH_MIB = 100, 256, 32

TEXT = """
subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}}
tasks: {steady: {component: t_counter, rtpu: first, rate: 1 kHz}}
configurations: {all: [steady]}
start: all
"""

# What is right, before it is mutated. None of it, nor a mixture of it, changes what the tasks do.
RIGHT = [("hello", {}), ("status", {}), ("describe", {}), ("get", {"variables": ["count"]}), ("profile", {}),
         ("events", {"since": 0, "limit": 10}), ("why", {"variable": "count"}), ("unsubscribe", {"subscription": 1}),
         ("subscribe", {"to": "values", "period_ms": 20, "variables": ["count"], "since": 0}),
         ("check", {"text": "subsystem: a", "file": "a.yaml"}), ("schedule", {"text": "subsystem: a"}),
         ("signal", {"signal": "on", "tasks": ["nobody"]}), ("ring", {"tasks": ["nobody"]}),
         ("set", {"values": {"nothing": 2}}), ("flag", {"up": False}), ("save", {})]
ODD = [None, True, False, "", "count", "nobody", [], {}, [[]], {"a": {}}, 0, -1, 1, 2 ** 31, 2 ** 63, 2 ** 64, -2 ** 63,
       1e308, 1.5, "\ud800", "\u0000", "\u202e", "é" * 50, "x" * 5000, ["count"] * 300]
SIGNS = [b"\x00", b"\xff", b"\xc0\x80", b"\xed\xa0\x80", b"\xf4\x90\x80\x80", b"{", b"}", b"[", b"]", b'"', b"\\", b",",
         b":", b"\\ud800", b"1e400", b"NaN", b"-", b"\r", b"\xef\xbb\xbf", b"\n"]


def mutated(dice):
    """One line with its end, of which most are almost right."""
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
    one.settimeout(5)
    return one


class Mutator:
    """A connection that is answered: each of its lines in time, in words of the protocol."""

    def __init__(self, path, dice):
        self.path, self.dice, self.lines, self.faults, self.number = path, dice, 0, [], 0
        self.socket, self.rest = None, b""

    def answers(self, until):
        """Whole lines until the one with that id, or until the door closes."""
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
            self.faults.append("no answer within 5 s")
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


def probe(path, end, dice):
    """What the owner gets meanwhile: `status` over one connection, `flag` over a new one each time; both are sent again
    over another connection, as every client may, when the door has closed theirs without an answer."""
    kept, took, faults = None, [], []
    while time.monotonic() < end:
        for method, parameters in (("status", {}), ("flag", {"up": False})):
            line = json.dumps({"jsonrpc": "2.0", "id": 1, "method": method, "params": parameters}).encode() + b"\n"
            begun = time.monotonic()
            one, said = (kept if method == "status" else None), b"nothing"
            while b'"result"' not in said and time.monotonic() - begun < 5:
                try:
                    one, said = one or connected(path), b""
                    one.sendall(line)
                    while b"\n" not in said:
                        said += one.recv(1 << 16) or b"\n"
                except OSError as wrong:
                    said = str(wrong).encode()
                if b'"result"' not in said:
                    one = None
            if one is None:
                faults.append(f"{method}: {said[:200]!r}")
            elif method == "status":
                kept = one
            else:
                one.close()
            took.append((time.monotonic() - begun) * 1e3)
        time.sleep(0.01 * dice.random())
    return took, faults


KINDS = {"mutate": mutate, "crowd": crowd, "probe": probe}


def begun(kind, path, seconds, seed, user=None):
    who = {"user": user, "group": user, "extra_groups": [GROUP.gr_gid]} if user else {}
    words = ["--kind", kind, "--socket", path, "--seconds", str(seconds), "--seed", str(seed)]
    return kind, subprocess.Popen([sys.executable, __file__, *words], stdout=subprocess.PIPE, cwd="/", **who)


def attacked(path, seed, is_root):
    """One round: {kind: [(count, faults)]}"""
    users = [None, OBSERVERS, OBSERVERS + 1] if is_root else [None]
    running = [begun(kind, path, ROUND, seed + 10 * i, user) for i, user in enumerate(users)
               for kind in ("mutate", "crowd") if user is None or (kind == "crowd") == (user > OBSERVERS)]
    running.append(begun("probe", path, ROUND, seed))
    results = {}
    for kind, process in running:
        out = process.communicate(timeout=60 + ROUND)[0]
        results.setdefault(kind, []).append(json.loads(out) if process.returncode == 0
                                            else [[] if kind == "probe" else 0, [f"{kind} failed"]])
    return results


def memory_mib(pid, key):
    lines = pathlib.Path(f"/proc/{pid}/status").read_text().splitlines()
    return int(next(line for line in lines if line.startswith(key)).split()[1]) / 1024


class Campaign:
    def __init__(self, system, is_root):
        self.system, self.is_root = system, is_root
        self.path = str(system.socket)
        self.n = self.connections = 0
        self.faults, self.took, self.lost, self.cycles = [], [], [0, 0], [0, 0]  # lost and cycles: clean, attacked
        self.pids = system.pids()
        self.before = self.state()
        self.descriptors = self.open_descriptors()
        self.memory = memory_mib(self.pids["manager"], "VmRSS")

    def state(self):
        task = self.system.task("steady")
        return task["state"], task["incarnation"], task["faults"], self.system.call("hello")["manager"]["starts"]

    def open_descriptors(self):
        return len(os.listdir(f"/proc/{self.pids['manager']}/fd"))

    def span(self, is_attacked, act):
        before = self.system.task("steady")
        act()
        after = self.system.task("steady")
        self.lost[is_attacked] += after["missed"] - before["missed"]
        self.cycles[is_attacked] += after["cycles"] - before["cycles"]

    def round(self, seed):
        self.span(0, lambda: time.sleep(CLEAN))
        found = {}
        self.span(1, lambda: found.update(attacked(self.path, seed, self.is_root)))
        self.n += sum(count for count, _ in found["mutate"])
        self.connections += sum(count for count, _ in found["crowd"])
        for kind, results in found.items():
            self.faults += [f"seed {seed}: {kind}: {fault}" for _, faults in results for fault in faults]
        self.took += [ms for took, _ in found["probe"] for ms in took]
        self.judge(seed)

    def judge(self, seed):
        if self.system.pids() != self.pids or self.state() != self.before:
            self.faults.append(f"seed {seed}: {self.before} {self.pids} became {self.state()} {self.system.pids()}")
            self.pids, self.before = self.system.pids(), self.state()
        time.sleep(0.5)  # for the door to notice who is gone
        if self.open_descriptors() > self.descriptors + 1:
            self.faults.append(f"seed {seed}: {self.descriptors} descriptors became {self.open_descriptors()}")
        highest, growth = (memory_mib(self.pids["manager"], "VmHWM"),
                           memory_mib(self.pids["manager"], "VmRSS") - self.memory)
        if highest > HIGHEST_MIB or growth > GROWTH_MIB:
            self.faults.append(f"seed {seed}: manager {highest:.0f} MiB at most, {growth:.0f} MiB more than before")

    def p99(self):
        return sorted(self.took)[len(self.took) * 99 // 100] if self.took else float("inf")

    def end(self, judges_cycles):
        if self.p99() > LIMIT_MS:
            self.faults.append(f"the owner's status and flag: p99 {self.p99():.1f} ms")
        rates = [lost / max(cycles, 1) for lost, cycles in zip(self.lost, self.cycles)]
        if judges_cycles and rates[1] > max(rates[0], NOISE):
            self.faults.append(f"cycles lost: {self.lost} of {self.cycles}, clean and attacked")


def campaign(arguments):
    os.environ["CHIMERA_BUILD"] = arguments.build
    sys.path.insert(0, str(PROCESSES))
    from system import System
    is_root = os.getuid() == 0
    options = ["--priority", "60"] if is_root else []
    if is_root:
        options += ["--observe-group", GROUP.gr_name]
    with System(TEXT, options) as system:
        for folder in (system.place, system.runtime):
            folder.chmod(0o711)
        run = Campaign(system, is_root)
        end = time.monotonic() + arguments.seconds
        rounds = 0
        while rounds == 0 or time.monotonic() < end:
            run.round(arguments.seed + 1000 * rounds)
            rounds += 1
        run.end(judges_cycles=is_root)
        events = [e["text"] for e in system.events() if e["kind"] == "closed"]
        memory = memory_mib(run.pids["manager"], "VmHWM")
    for fault in run.faults[:50]:
        print(fault, flush=True)
    print(json.dumps({"name": "hostile_door", "n": run.n, "faults": len(run.faults), "counted": "lines",
                      "rounds": rounds, "connections": run.connections, "asked": len(run.took),
                      "p99_ms": round(run.p99(), 1), "max_ms": round(max(run.took, default=0), 1),
                      "lost_clean": run.lost[0], "cycles_clean": run.cycles[0], "lost": run.lost[1],
                      "cycles": run.cycles[1], "manager_mib": round(memory), "closed_events": len(events)}))
    return 1 if run.faults else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", help="the tree whose programs are attacked")
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(1 << 32))
    parser.add_argument("--kind", choices=KINDS, help="one attacker, for the campaign itself")
    parser.add_argument("--socket")
    arguments = parser.parse_args()
    if arguments.kind is None:
        return campaign(arguments)
    resource.setrlimit(resource.RLIMIT_NOFILE, (1024, 1024))
    print(json.dumps(KINDS[arguments.kind](arguments.socket, time.monotonic() + arguments.seconds,
                                           random.Random(arguments.seed))))
    return 0


if __name__ == "__main__":
    sys.exit(main())
