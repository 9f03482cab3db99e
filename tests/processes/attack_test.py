# SPDX-License-Identifier: Apache-2.0
"""A second user without rights tries everything it can reach: nothing succeeds and no task loses anything. And the
roles of those who were given one. Needs root, to become another user."""
import grp
import json
import os
import re
import subprocess
import sys
import unittest

from protocol_test import FORMATS, GOOD, METHODS
from system import HANG, TWO_RTPUS, System

NOBODY, STRANGERS = 65534, 65534
OPERATORS = next(g for g in grp.getgrall() if g.gr_gid not in (0, STRANGERS))

# Run as the stranger, with the pids and the socket as arguments; prints what succeeded.
ATTACK = r'''
import ctypes, json, os, resource, signal, socket, sys
path, pids = sys.argv[1], [int(p) for p in sys.argv[2:]]
libc = ctypes.CDLL(None, use_errno=True)
won = []
def attempt(what, act):
    try:
        if act() is not False:
            won.append(what)
    except (OSError, PermissionError, ValueError):
        pass
def system_call(number, *arguments):
    got = libc.syscall(number, *arguments)
    if got < 0:
        raise OSError(ctypes.get_errno(), "refused")
    return got
def read_memory(pid):
    at = int(open(f"/proc/{pid}/maps").read().split("-")[0], 16)
    mine = ctypes.create_string_buffer(16)
    class Piece(ctypes.Structure):
        _fields_ = [("base", ctypes.c_void_p), ("bytes", ctypes.c_size_t)]
    here, there = Piece(ctypes.addressof(mine), 16), Piece(at, 16)
    return libc.process_vm_readv(pid, ctypes.byref(here), 1, ctypes.byref(there), 1, 0) == 16
def talk(to=path, limit=60):
    s = socket.socket(socket.AF_UNIX)
    s.settimeout(limit)
    s.connect(to)
    s.sendall(b'{"jsonrpc":"2.0","id":1,"method":"status"}\n')
    said = b""
    while not said.endswith(b"\n"):
        got = s.recv(65536)
        if not got:
            break
        said += got
    return b'"result"' in said
attempt("talk", talk)
attempt("unlink the socket", lambda: os.unlink(path))
attempt("a file in the folder", lambda: open(os.path.dirname(path) + "/x", "w"))
for name in os.listdir("/dev/shm"):
    if "chimera" in name:
        attempt("shared memory", lambda: open("/dev/shm/" + name))
for line in open("/proc/net/unix").read().splitlines()[1:]:
    name = line.split()[-1]
    # The claim of a CPU or of a subsystem's name takes a connection, which shows its holder, and answers nothing.
    if name.startswith("@") and "chimera" in name:
        attempt("abstract socket", lambda: talk("\0" + name[1:], 0.2))
for pid in pids:
    attempt("memory", lambda: open(f"/proc/{pid}/mem", "r+b"))
    attempt("list of descriptors", lambda: bool(os.listdir(f"/proc/{pid}/fd")))
    pidfd = system_call(434, pid, 0)
    for fd in range(3, 40):
        for mode in (os.O_RDONLY, os.O_RDWR):
            attempt("descriptor", lambda: os.open(f"/proc/{pid}/fd/{fd}", mode))
        attempt("copy of a descriptor", lambda: system_call(438, pidfd, fd, 0))
    attempt("priority", lambda: os.setpriority(os.PRIO_PROCESS, pid, 10))
    attempt("affinity", lambda: os.sched_setaffinity(pid, {0}))
    attempt("trace", lambda: libc.ptrace(16, pid, 0, 0) == 0)
    for what in ("environ", "maps", "stack", "root", "cwd"):
        attempt(f"/proc: {what}", lambda: os.path.exists(os.readlink(f"/proc/{pid}/{what}"))
                if what in ("root", "cwd") else bool(open(f"/proc/{pid}/{what}").read()))
    attempt("memfd by its mapping", lambda: bool(os.listdir(f"/proc/{pid}/map_files")))
    attempt("memory of another", lambda: read_memory(pid))
    attempt("limits", lambda: resource.prlimit(pid, resource.RLIMIT_NOFILE) and False or
            resource.prlimit(pid, resource.RLIMIT_NOFILE, resource.prlimit(pid, resource.RLIMIT_NOFILE)))
    attempt("policy", lambda: os.sched_setscheduler(pid, os.SCHED_OTHER, os.sched_param(0)))
    attempt("signal by number", lambda: os.kill(pid, 0))
    attempt("signal by pidfd", lambda: system_call(424, pidfd, 9, 0, 0))
print(json.dumps(sorted(set(won))))
'''

# Run as the user of the system: seals hold for every user. The decision page is writable for all processes of the
# system by design: a wrong value there costs a check (docs/formats/processes.md).
OWN_USER = r'''
import json, mmap, os, sys
won, seen = [], 0
for pid in sys.argv[1:]:
    for fd in os.listdir(f"/proc/{pid}/fd"):
        try:
            name = os.readlink(f"/proc/{pid}/fd/{fd}")
            if "memfd:" not in name or "decision" in name or "face" in name:
                continue
            seen += 1
            got = os.open(f"/proc/{pid}/fd/{fd}", os.O_RDWR)
        except OSError:
            continue
        for what, act in (("write", lambda: os.pwrite(got, b"x", 0)), ("truncate", lambda: os.ftruncate(got, 0)),
                          ("map", lambda: mmap.mmap(got, 4096, mmap.MAP_SHARED, mmap.PROT_WRITE | mmap.PROT_READ))):
            try:
                act()
                won.append(f"{what} {name} of {pid}")
            except (OSError, ValueError):
                pass
print(json.dumps([won, seen]))
'''

RANKS = ("observe", "operate", "configure")
PARAMETERS = {**GOOD, "set": {"values": {}}, "unsubscribe": {"subscription": 1}}


def roles():
    """Role of each method: the heading under which docs/formats/control.md has it."""
    found, role = {}, None
    for line in (FORMATS / "control.md").read_text().splitlines():
        if heading := re.match(r"### (\w+)", line):
            role = heading[1] if heading[1] in RANKS else None
        elif role and (row := re.match(r"\| `([a-z]+)` \|", line)):
            found[row[1]] = role
    return found


ROLES = roles()

# Calls one method and prints its error, or "good", also if only its meaning for this application was refused.
CALL = r'''
import json, socket, sys
s = socket.socket(socket.AF_UNIX)
s.settimeout(60)
s.connect(sys.argv[1])
request = {"jsonrpc": "2.0", "id": 1, "method": sys.argv[2], "params": json.loads(sys.argv[3])}
try:
    s.sendall(json.dumps(request).encode() + b"\n")
except BrokenPipeError:
    pass  # the server refuses a stranger before it asks
said = b""
while not said.endswith(b"\n"):
    said += s.recv(65536) or b"\n"
answer = json.loads(said.split(b"\n")[0])
error = answer.get("error", {"code": -32602})
print(json.dumps("good" if error["code"] in (-32000, -32005, -32602)
                 else [error["code"], error["message"], error["data"]]))
'''


@unittest.skipUnless(os.getuid() == 0, "only root can become another user")
class Attack(unittest.TestCase):
    def as_stranger(self, code, *arguments, groups=()):
        done = subprocess.run(["/usr/bin/python3", "-c", code, *map(str, arguments)], user=NOBODY, group=STRANGERS,
                              extra_groups=list(groups), capture_output=True, text=True, timeout=HANG, cwd="/")
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.strip()

    def open_folders(self, system):
        """Opens the folders of the socket to other users, as an administrator may."""
        for folder in (system.place, system.runtime):
            folder.chmod(0o711)

    def test_row_23_a_stranger_gets_nowhere(self):
        for arguments in ((), ("--observe-group", OPERATORS.gr_name)):
            with self.subTest(arguments), System(TWO_RTPUS, arguments) as system:
                self.open_folders(system)
                before = {t["task"]: t for t in system.call("status")["tasks"]}
                pids = system.pids().values()
                self.assertEqual(json.loads(self.as_stranger(ATTACK, system.socket, *pids)), [])
                for task in system.call("status")["tasks"]:
                    self.assertEqual((task["state"], task["incarnation"], task["faults"]),
                                     ("ON", before[task["task"]]["incarnation"], 0))
                # A user with all rights succeeds with each: the attempts are real ones.
                with open(system.file) as held, subprocess.Popen(["sleep", "60"], pass_fds=[held.fileno()]) as victim:
                    done = subprocess.run(["/usr/bin/python3", "-c", ATTACK, str(system.socket), str(victim.pid)],
                                          capture_output=True)
                self.assertEqual(json.loads(done.stdout),
                                 ["/proc: cwd", "/proc: environ", "/proc: maps", "/proc: root", "/proc: stack",
                                  "a file in the folder", "affinity", "copy of a descriptor", "descriptor", "limits",
                                  "list of descriptors", "memfd by its mapping", "memory", "memory of another",
                                  "policy", "priority", "signal by number", "signal by pidfd", "talk", "trace",
                                  "unlink the socket"])

    def test_seals_hold_against_the_systems_own_user(self):
        with System(TWO_RTPUS) as system:
            done = subprocess.run([sys.executable, "-c", OWN_USER, *map(str, system.pids().values())],
                                  capture_output=True, text=True, timeout=HANG)
            won, seen = json.loads(done.stdout)
            self.assertGreater(seen, 5)
            self.assertEqual(won, [])

    def test_a_group_gets_its_role_and_no_more_with_every_method_of_the_protocol(self):
        """Tries all methods of the schema, so a new one too, with the roles that the document states."""
        self.assertEqual(sorted(ROLES), sorted(METHODS))
        for has in (None, "observe", "operate", "configure"):
            arguments = (f"--{has}-group", OPERATORS.gr_name) if has else ()
            with self.subTest(has), System(TWO_RTPUS, arguments) as system:
                self.open_folders(system)
                if has is None:  # the administrator opened the way, the system did not
                    system.socket.parent.chmod(0o711)
                    system.socket.chmod(0o666)
                for method in sorted(METHODS, key=lambda m: m == "end"):
                    said = json.loads(self.as_stranger(CALL, system.socket, method, json.dumps(PARAMETERS[method]),
                                                       groups=[OPERATORS.gr_gid] if has else []))
                    self.assertEqual(said, self.expected(method, has), f"{method} with {has}")
                if has != "configure":
                    self.assertEqual([t["state"] for t in system.call("status")["tasks"]], ["ON", "ON"])

    def expected(self, method, has):
        if has is None:
            return [-32004, "you have no role in this subsystem: you are neither its user nor in a group that has a "
                    "role", {"needs": "observe", "has": "nothing"}]
        if RANKS.index(has) >= RANKS.index(ROLES[method]):
            return "good"
        return [-32004, f"'{method}' needs the role {ROLES[method]}, you have {has}",
                {"needs": ROLES[method], "has": has}]


if __name__ == "__main__":
    unittest.main(verbosity=1)
