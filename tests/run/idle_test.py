# SPDX-License-Identifier: Apache-2.0
"""A subsystem with nothing loaded serves editors, and ends."""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "processes"))
from system import CHIMERA, HANG, Client, await_that  # noqa: E402


class Idle(unittest.TestCase):
    def test_it_checks_lists_and_ends(self):
        with tempfile.TemporaryDirectory() as place:
            environment = dict(os.environ, XDG_RUNTIME_DIR=place)
            socket = pathlib.Path(place) / "chimera" / "idle.sock"
            process = subprocess.Popen([str(CHIMERA), "idle"], env=environment, stdin=subprocess.DEVNULL,
                                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            self.addCleanup(lambda: process.poll() is None and (process.kill(), process.communicate()))

            def connected():
                try:
                    return Client(socket)
                except OSError:  # it is not there, or no process listens yet
                    return None
            client = await_that(connected, "the socket")
            self.addCleanup(client.close)
            self.assertIn("t_counter", [c["name"] for c in client.call("library")["components"]])
            self.assertIsNone(client.call("text")["text"])
            report = client.call("check", text="subsystem: x\ntasks: {a: {component: t_countr}}\n", file="x.yaml")
            self.assertEqual((report["legal"], report["faults"][0]["nearest"]), (False, "t_counter"))
            second = subprocess.run([str(CHIMERA), "idle"], env=environment, capture_output=True, text=True,
                                    timeout=HANG)
            self.assertEqual(second.returncode, 1)
            self.assertIn("a subsystem 'idle' runs already", second.stderr)
            process.send_signal(signal.SIGINT)
            process.communicate(timeout=HANG)
            self.assertFalse(socket.exists())


if __name__ == "__main__":
    unittest.main(verbosity=1)
