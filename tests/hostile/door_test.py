# SPDX-License-Identifier: Apache-2.0
"""Connections to a running subsystem: its owner gets one, and a user with more rights before one with less; a command
ends when the manager hangs."""
import grp
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "processes"))
from system import CHIMERA, HANG, TWO_RTPUS, System, await_that  # noqa: E402

OBSERVERS = next(g for g in grp.getgrall() if g.gr_gid not in (0, 65534))

# Run as an observer: holds that many connections until its standard input ends.
HOLD = r'''
import socket, sys
held = []
for _ in range(int(sys.argv[2])):
    s = socket.socket(socket.AF_UNIX)
    s.connect(sys.argv[1])
    held.append(s)
    try:
        s.sendall(sys.argv[3].encode())
    except BrokenPipeError:
        pass  # it was idle and gave its place to one of the others
print("held", flush=True)
sys.stdin.read()
'''


def is_closed(one):
    """True if it is closed behind what was sent over it."""
    try:
        while one.recv(1 << 16, socket.MSG_DONTWAIT):
            pass
        return True
    except BlockingIOError:
        return False
    except ConnectionError:
        return True


class ControlServer(unittest.TestCase):
    """One subsystem for all tests: their attacks must not change it."""

    @classmethod
    def setUpClass(cls):
        cls.system = System(TWO_RTPUS, ("--observe-group", OBSERVERS.gr_name))
        for folder in (cls.system.place, cls.system.runtime):
            folder.chmod(0o711)
        cls.system.environment["CHIMERA_SUBSYSTEM"] = "subject"

    @classmethod
    def tearDownClass(cls):
        cls.system.end()

    def command(self, *words):
        return subprocess.Popen([str(CHIMERA), *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                env=self.system.environment, cwd=self.system.place)

    def says(self, *words):
        """(exit code, output)"""
        done = self.system.chimera(*words, code=None)
        return done.returncode, done.stdout + done.stderr

    def closings(self):
        return self.system.texts("closed")

    @unittest.skipUnless(os.getuid() == 0, "only root can become another user")
    def test_four_users_who_may_look_do_not_shut_out_the_owner(self):
        crowds = [subprocess.Popen(["/usr/bin/python3", "-c", HOLD, str(self.system.socket), "16", ""], user=user,
                                   group=65534, extra_groups=[OBSERVERS.gr_gid], stdin=subprocess.PIPE,
                                   stdout=subprocess.PIPE, cwd="/") for user in range(61001, 61005)]
        try:
            for crowd in crowds:
                self.assertEqual(crowd.stdout.readline(), b"held\n")
            self.assertEqual(self.says("off", "beside"), (0, "[subject] beside: ON -> OFF\n"))
            self.assertEqual(self.says("on", "beside"), (0, "[subject] beside: OFF -> ON\n"))
            gave_way = re.compile("of user 6100[1-4] .*its place was needed")
            self.assertTrue(any(gave_way.search(text) for text in self.closings()), self.closings())
        finally:
            for crowd in crowds:
                crowd.communicate()

    def test_a_manager_that_hangs_holds_no_command_longer_than_its_limit(self):
        """A line that does not end is closed afterwards, too."""
        pids = self.system.pids()
        half = socket.socket(socket.AF_UNIX)
        half.connect(str(self.system.socket))
        half.sendall(b'{"jsonrpc":"2.0",')
        self.system.call("status")
        self.system.disconnect()
        stopped = [pids["keeper"], pids["manager"]]  # the keeper: it would replace the manager
        waiting, asked = [], []
        try:
            for pid in stopped:
                self.assertTrue(self.system.kill(pid, signal.SIGSTOP))
            is_full = False
            while not is_full:  # the queue of the socket
                one = socket.socket(socket.AF_UNIX)
                one.setblocking(False)
                waiting.append(one)
                try:
                    one.connect(str(self.system.socket))
                except BlockingIOError:
                    is_full = True
                self.assertLess(len(waiting), 100, "the queue has no end")
            asked = [self.command(*words) for words in (("status",), ("off", "steady"), ("end",))]
            for one in asked:
                out, err = one.communicate(timeout=HANG)
                self.assertEqual((one.returncode, out), (1, ""))
                self.assertEqual(err, f"the manager (process {pids['manager']}) of 'subject' does not answer for 5 s: "
                                      f"it is stopped; its rtpus go on without it; try again; "
                                      f"`kill -KILL {pids['manager']}` has the keeper start another, "
                                      f"`kill {pids['keeper']}` ends everything in order\n")
        finally:
            for one in asked:
                one.kill()
            for one in waiting:
                one.close()
            for pid in reversed(stopped):
                self.system.kill(pid, signal.SIGCONT)
        await_that(lambda: is_closed(half), "the end of the half line")
        self.assertIn("the client sent a line without its end for 5 s", str(self.closings()))
        self.assertEqual(self.system.on(), {"steady", "beside"})


if __name__ == "__main__":
    unittest.main(verbosity=1)
