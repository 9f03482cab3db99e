# SPDX-License-Identifier: Apache-2.0
"""A device that goes away while its task is ON, and comes back: the task is in ERROR with a sentence that says what to
do, its outputs are what its data sheet says, other tasks go on, and `clear` and `on` bring it back."""
import os
import pathlib
import select
import subprocess
import sys
import threading
import tty
import unittest

LIBRARY = pathlib.Path(__file__).resolve().parents[2] / "library"
sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "processes"))
from system import BUILD, RTPUS, Refused, System, await_that  # noqa: E402

APPLICATION = RTPUS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  driver: {component: COMPONENT, rtpu: second, rate: 100 Hz, MORE}
configurations:
  all: [steady, driver]
start: all
"""


class Line:
    """A pseudo terminal with a name that stays when it is unplugged and plugged in again."""

    def __init__(self, name, echo):
        self.name, self.echo, self.heard, self.is_plugged = pathlib.Path(name), echo, b"", False

    def plug(self):
        self.master, self.slave = os.openpty()  # the slave stays open: without one a master is always readable
        os.set_blocking(self.master, False)
        tty.setraw(self.slave)
        self.name.unlink(missing_ok=True)
        self.name.symlink_to(os.ttyname(self.slave))
        self.is_plugged = True
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def unplug(self):
        self.is_plugged = False
        self.thread.join()
        os.close(self.master)
        os.close(self.slave)
        self.name.unlink()

    def end(self):
        if self.is_plugged:
            self.unplug()

    def run(self):
        while self.is_plugged:
            if not select.select([self.master], [], [], 0.01)[0]:
                continue
            try:
                got = os.read(self.master, 4096)
            except BlockingIOError:
                continue
            self.heard = (self.heard + got)[-4096:]
            if self.echo:
                os.write(self.master, got)

    def say(self, text):
        os.write(self.master, text)


class Devices(unittest.TestCase):
    def setUp(self):
        self.name = f"/tmp/chimera-line-{os.getpid()}"
        self.line = Line(self.name, True)
        self.addCleanup(self.line.end)

    def goes_and_comes_back(self, system, go, fault, come, while_gone=lambda: None):
        before, driver = system.task("steady"), system.task("driver")
        go()
        system.await_state("driver", "ERROR")
        self.assertIn(fault, system.task("driver")["fault"])
        self.assertIn("bring it back, then `clear` and `on`", system.task("driver")["fault"])
        while_gone()
        try:
            system.signal("clear", "driver")
        except Refused:
            pass
        self.assertEqual(system.state("driver"), "ERROR")
        come()

        def is_cleared():
            try:
                system.signal("clear", "driver")
            except Refused:
                return False
            return system.state("driver") == "OFF"
        await_that(is_cleared, "clear")
        system.signal("on", "driver")
        system.await_state("driver", "ON")
        self.assertEqual(system.task("driver")["incarnation"], driver["incarnation"])
        after = system.await_cycles("steady")
        self.assertEqual((after["state"], after["faults"], after["incarnation"]), ("ON", 0, before["incarnation"]))

    def test_a_serial_device_that_is_unplugged(self):
        self.line.plug()
        text = APPLICATION.replace("COMPONENT", "serial_frame").replace(
            "MORE", f"constants: {{timeout: 1 s}}, resources: {{device: {self.name}}}")
        with System(text + "operator: {command: [0.5]}\n") as system:
            system.await_value("state", [0.5])
            self.goes_and_comes_back(
                system, self.line.unplug, "is gone", self.line.plug,
                lambda: (self.assertEqual(system.value("state"), [0.5]),
                         self.assertFalse(system.value("connected"))))
            system.call("set", values={"command": [0.25]})
            system.await_value("state", [0.25])

    def test_a_silent_serial_device_gets_the_idle_frame(self):
        self.line.plug()
        text = APPLICATION.replace("COMPONENT", "serial_frame").replace(
            "MORE", f"constants: {{timeout: 2 s}}, resources: {{device: {self.name}}}")
        with System(text + "operator: {command: [0.5]}\n") as system:
            system.await_value("state", [0.5])
            self.line.echo = False
            system.await_state("driver", "ERROR")
            self.assertIn("is silent", system.task("driver")["fault"])
            idle = bytes([0xA5, 4, 0, 0, 0, 0])
            await_that(lambda: self.line.heard[-8:].startswith(idle), "idle")
            self.line.echo = True
            system.signal("clear", "driver")
            system.signal("on", "driver")
            system.await_value("connected", True)

    def test_menus_on_a_terminal(self):
        self.line.echo = False
        self.line.plug()
        text = RTPUS.replace("  second: {cpu: 1, policy: edf}\n", "") + (
            LIBRARY / "display_manager" / "display_manager.test.yaml").read_text().split("tasks:\n")[1]
        text = text.replace("  display_manager:", f"""tasks:
  terminal: {{rtpu: first, rate: 20 Hz, resources: {{device: {self.name}}}}}
  display_manager:
    rtpu: first""", 1)
        with System(text) as system:
            await_that(lambda: b"21.5" in self.line.heard, system.told)
            self.line.say(b"j\r")  # to the settings
            await_that(lambda: b"wanted" in self.line.heard, system.told)
            self.line.say(b"\r27.25\r")
            system.await_value("wanted", 27.25)

    def test_a_terminal_that_hangs_up(self):
        self.line.echo = False
        self.line.plug()
        text = APPLICATION.replace("COMPONENT", "tball").replace(
            "MORE", f"alias: {{xm: []}}, constants: {{hold: 10 s}}, resources: {{device: {self.name}}}")
        with System(text) as system:
            self.line.say(b"d")
            system.await_value("motion", [1, 0, 0, 0, 0, 0])
            self.goes_and_comes_back(system, self.line.unplug, "is gone", self.line.plug,
                                     lambda: self.assertEqual(system.value("motion"), [0] * 6))
            self.line.say(b"s")
            system.await_value("motion", [0, -1, 0, 0, 0, 0])

    def test_a_modbus_device_that_is_switched_off(self):
        partner = str(BUILD / "components/modbus_io.test.partner")
        device = subprocess.Popen([partner], stdout=subprocess.PIPE, text=True)
        port = device.stdout.readline().strip()
        text = APPLICATION.replace("COMPONENT", "modbus_io").replace(
            "MORE", "alias: {input: [level], contact: [], holding: [speed], coil: []}, "
                    f"resources: {{device: 'tcp:127.0.0.1:{port}'}}")

        def go():
            device.kill()
            device.wait()
            device.stdout.close()

        def come():
            nonlocal device
            device = subprocess.Popen([partner, port], stdout=subprocess.PIPE, text=True)
        try:
            with System(text + "operator: {speed: 7}\n") as system:
                system.await_value("level", 7)
                self.goes_and_comes_back(system, go, "does not answer", come,
                                         lambda: self.assertFalse(system.value("connected")))
                system.call("set", values={"speed": 9})
                system.await_value("level", 9)
        finally:
            go()


if __name__ == "__main__":
    unittest.main(verbosity=1)
