# SPDX-License-Identifier: Apache-2.0
"""A second user without rights tries everything it can reach: nothing succeeds and no task loses anything. And the
roles of those who were given one. Needs root, to become somebody else."""
import grp
import json
import os
import subprocess
import sys
import unittest

from system import BUILD, Refused, System, await_that

NOBODY, STRANGERS = 65534, 65534
OPERATORS = next(g for g in grp.getgrall() if g.gr_gid not in (0, STRANGERS))

APPLICATION = """
subsystem: subject
rtpus:
  first: {cpu: 0, policy: edf}
  second: {cpu: 1, policy: edf}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  beside: {component: t_source, rtpu: second, rate: 100 Hz}
configurations: {all: [steady, beside]}
start: all
"""

# Run as the stranger, with the pids and the socket as arguments; prints what succeeded.
ATTACK = r'''
import ctypes, json, os, signal, socket, sys
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
def talk():
    s = socket.socket(socket.AF_UNIX)
    s.settimeout(2)
    s.connect(path)
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
    attempt("signal by number", lambda: os.kill(pid, 0))
    attempt("signal by pidfd", lambda: system_call(424, pidfd, 9, 0, 0))
print(json.dumps(sorted(set(won))))
'''

# Run as the user of the system itself: seals do not ask who knocks. The decision page is writable for all processes of
# the system by design: a wrong value there costs a look (docs/formats/processes.md).
OWN_USER = r'''
import json, mmap, os, sys
won, seen = [], 0
for pid in sys.argv[1:]:
    for fd in os.listdir(f"/proc/{pid}/fd"):
        try:
            name = os.readlink(f"/proc/{pid}/fd/{fd}")
            if "memfd:" not in name or "decision" in name:
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

# Calls one method and prints the code of its error, or "good".
CALL = r'''
import json, socket, sys
s = socket.socket(socket.AF_UNIX)
s.settimeout(5)
s.connect(sys.argv[1])
request = {"jsonrpc": "2.0", "id": 1, "method": sys.argv[2], "params": json.loads(sys.argv[3])}
s.sendall(json.dumps(request).encode() + b"\n")
said = b""
while not said.endswith(b"\n"):
    said += s.recv(65536) or b"\n"
answer = json.loads(said)
print(answer["error"]["code"] if "error" in answer else "good")
'''


@unittest.skipUnless(os.getuid() == 0, "only root can become somebody else")
class Attack(unittest.TestCase):
    def as_stranger(self, code, *arguments, groups=()):
        done = subprocess.run(["/usr/bin/python3", "-c", code, *map(str, arguments)], user=NOBODY, group=STRANGERS,
                              extra_groups=list(groups), capture_output=True, text=True, timeout=60, cwd="/")
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.strip()

    def open_folders(self, system):
        """As an administrator would who wants others in: the way to the socket may be passed."""
        for folder in (system.place, system.runtime):
            folder.chmod(0o711)

    def test_row_23_a_stranger_gets_nowhere(self):
        for arguments in ((), ("--observe-group", OPERATORS.gr_name)):
            with self.subTest(arguments), System(APPLICATION, arguments) as system:
                self.open_folders(system)
                before = {t["task"]: t for t in system.call("status")["tasks"]}
                pids = system.pids().values()
                self.assertEqual(json.loads(self.as_stranger(ATTACK, system.socket, *pids)), [])
                for task in system.call("status")["tasks"]:
                    self.assertEqual((task["state"], task["incarnation"], task["faults"]),
                                     ("ON", before[task["task"]]["incarnation"], 0))
                # Somebody who may do it all succeeds with each: the attempts are real ones.
                with open(system.file) as held, subprocess.Popen(["sleep", "60"], pass_fds=[held.fileno()]) as victim:
                    done = subprocess.run(["/usr/bin/python3", "-c", ATTACK, str(system.socket), str(victim.pid)],
                                          capture_output=True)
                self.assertEqual(json.loads(done.stdout),
                                 ["a file in the folder", "affinity", "copy of a descriptor", "descriptor",
                                  "list of descriptors", "memory", "priority", "signal by number", "signal by pidfd",
                                  "talk", "trace", "unlink the socket"])

    def test_seals_hold_against_the_systems_own_user(self):
        with System(APPLICATION) as system:
            done = subprocess.run([sys.executable, "-c", OWN_USER, *map(str, system.pids().values())],
                                  capture_output=True, text=True, timeout=60)
            won, seen = json.loads(done.stdout)
            self.assertGreater(seen, 5)
            self.assertEqual(won, [])

    def test_a_group_gets_its_role_and_no_more(self):
        with System(APPLICATION, ("--observe-group", OPERATORS.gr_name)) as system:
            self.open_folders(system)
            def call(method, **parameters):
                return self.as_stranger(CALL, system.socket, method, json.dumps(parameters), groups=[OPERATORS.gr_gid])
            self.assertEqual(call("status"), "good")
            self.assertEqual(call("signal", signal="off", tasks=["steady"]), "-32004")
            self.assertEqual(call("set", values={}), "-32004")
            self.assertEqual(call("end"), "-32004")
            self.assertEqual(system.state("steady"), "ON")
        with System(APPLICATION, ("--operate-group", OPERATORS.gr_name)) as system:
            self.open_folders(system)
            self.assertEqual(self.as_stranger(CALL, system.socket, "signal", '{"signal": "off", "tasks": ["beside"]}',
                                              groups=[OPERATORS.gr_gid]), "good")
            self.assertEqual(system.state("beside"), "OFF")
            self.assertEqual(self.as_stranger(CALL, system.socket, "end", "{}", groups=[OPERATORS.gr_gid]), "-32004")


if __name__ == "__main__":
    unittest.main(verbosity=1)
