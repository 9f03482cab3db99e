# SPDX-License-Identifier: Apache-2.0
"""A subsystem with nothing loaded serves editors, and ends."""
import pathlib
import signal
import subprocess
import sys
import tempfile
import os
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "processes"))
from system import CHIMERA, HANG, Client, Refused, await_that  # noqa: E402


class Idle(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.environment = dict(os.environ, XDG_RUNTIME_DIR=self.place.name)
        self.socket = pathlib.Path(self.place.name) / "chimera" / "idle.sock"
        self.process = subprocess.Popen([str(CHIMERA), "idle"], env=self.environment, stdin=subprocess.DEVNULL,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.addCleanup(lambda: self.process.poll() is None and (self.process.kill(), self.process.communicate()))
        self.client = await_that(self.connected, "the socket")

    def connected(self):
        try:
            return Client(self.socket)
        except OSError:  # it is not there, or no process listens yet
            return None

    def tearDown(self):
        self.client.close()
        self.process.send_signal(signal.SIGINT)
        self.process.communicate(timeout=HANG)
        self.assertFalse(self.socket.exists())
        self.place.cleanup()

    def test_it_checks_and_lists(self):
        self.assertEqual(self.client.call("hello")["subsystem"], "idle")
        self.assertIn("t_counter", [c["name"] for c in self.client.call("library")["components"]])
        report = self.client.call("check", text="subsystem: x\ntasks: {a: {component: t_countr}}\n", file="x.yaml")
        self.assertFalse(report["legal"])
        self.assertEqual(report["faults"][0]["nearest"], "t_counter")
        self.assertTrue(self.client.call("check", text="subsystem: x\ntasks: {a: {component: t_counter}}\n")["legal"])
        analysis = self.client.call("schedule", text="subsystem: x\ntasks: {a: {component: t_counter, budget: 1 us}}\n")
        self.assertTrue(analysis["fits"])
        self.assertEqual(self.client.call("status")["tasks"], [])

    def test_it_has_no_task_to_signal(self):
        with self.assertRaises(Refused) as refused:
            self.client.call("signal", signal="on", tasks=["pid"])
        self.assertIn("no task 'pid'", str(refused.exception))

    def test_a_second_one_of_its_name_is_refused(self):
        second = subprocess.run([str(CHIMERA), "idle"], env=self.environment, capture_output=True, text=True,
                                timeout=HANG)
        self.assertEqual(second.returncode, 1)
        self.assertIn("a subsystem 'idle' runs already", second.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=1)
