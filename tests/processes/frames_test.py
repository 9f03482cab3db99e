# SPDX-License-Identifier: Apache-2.0
"""Safe frames on real processes: a drive on a serial line goes on with the torque that it was told last, until somebody
tells it another one. When its task is killed the guard does; when the keeper is killed with it, too."""
import os
import pathlib
import select
import signal
import socket
import struct
import threading
import time
import tty
import unittest

from system import BUILD, UNITS, System, await_that

TEXT = UNITS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  drive:
    {component: serial_frame, rtpu: second, rate: RATE, alias: {command: torque}, constants: {timeout: 60 s},
     resources: {device: LINE}}
operator: {torque: TORQUE}
configurations: {all: [steady, drive]}
start: all
"""
START, FILL = 0xA5, 132


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


class Drive:
    """Turns by the torque of the last good frame, for ever. `torques`: of every good frame, in order."""

    def __init__(self, axes):
        self.payload = 4 * axes
        self.master, self.slave = os.openpty()
        os.set_blocking(self.master, False)
        tty.setraw(self.slave)
        self.name = os.ttyname(self.slave)
        self.torques, self.fills, self.angle, self.held = [], 0, 0.0, b""
        self.is_deaf, self.is_over = False, False
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def end(self):
        self.is_over = True
        self.thread.join()
        os.close(self.master)
        os.close(self.slave)

    def run(self):
        last = time.monotonic()
        while not self.is_over:
            now = time.monotonic()
            self.angle += (self.torques[-1] if self.torques else 0) * (now - last)
            last = now
            if self.is_deaf or not select.select([self.master], [], [], 0.005)[0]:
                time.sleep(0.005 if self.is_deaf else 0)
                continue
            try:
                self.held += os.read(self.master, 65536)
            except (BlockingIOError, OSError):
                continue
            self.take()

    def take(self):
        """As a device takes a stream: a start byte that begins no frame is passed over."""
        self.fills += self.held.count(bytes(FILL))
        end = self.payload + 4
        while len(self.held) >= end:
            if self.held[0] != START or self.held[1] != self.payload:
                self.held = self.held[1:]
            elif crc16(self.held[1:end - 2]) != int.from_bytes(self.held[end - 2:end], "little"):
                self.held = self.held[1:]
            else:
                self.torques.append(struct.unpack("<f", self.held[2:6])[0])
                self.held = self.held[end:]

    def moves(self):
        before = self.angle
        time.sleep(0.1)
        return abs(self.angle - before) > 1e-9


class ModbusDevice:
    """Holding registers behind TCP, for any number of connections. `writes`: (the connection, the first register), in
    order; what it was told last it does for ever."""

    def __init__(self):
        self.door = socket.create_server(("127.0.0.1", 0))
        self.port, self.writes, self.n = self.door.getsockname()[1], [], 0
        threading.Thread(target=self.run, daemon=True).start()

    def run(self):
        while True:
            try:
                client = self.door.accept()[0]
            except OSError:
                return
            self.n += 1
            threading.Thread(target=self.serve, args=(client, self.n), daemon=True).start()

    def serve(self, client, connection):
        with client, client.makefile("rb") as stream:
            while len(head := stream.read(7)) == 7:
                request = stream.read(struct.unpack(">HHHB", head)[2] - 1)
                if request[0] == 16:
                    self.writes.append((connection, struct.unpack(">H", request[6:8])[0]))
                said = request[:5] if request[0] == 16 else bytes((request[0], 2, 0, 0))
                try:
                    client.sendall(head[:4] + struct.pack(">HB", len(said) + 1, head[6]) + said)
                except OSError:
                    return


class Frames(unittest.TestCase):
    def start(self, axes=1, rate="100 Hz"):
        self.drive = Drive(axes)
        self.addCleanup(self.drive.end)
        text = TEXT.replace("LINE", self.drive.name).replace("RATE", rate)
        system = System(text.replace("TORQUE", str([3] * axes)))
        system.await_state("drive", "ON")
        await_that(lambda: self.drive.torques[-1:] == [3.0], 10, "the drive to turn")
        return system

    def kill_with_its_keeper(self, system):
        """The unit is stopped before: it would end in order when it sees that its keeper is dead."""
        pids = system.pids()
        for who, how in (("second", signal.SIGSTOP), ("keeper", signal.SIGKILL), ("second", signal.SIGKILL)):
            self.assertTrue(system.kill(pids[who], how), who)

    def guard(self, system):
        return next(pid for pid in system.left_over()
                    if pathlib.Path(f"/proc/{pid}/comm").read_text().strip() == "chimera-guard")

    def test_an_rtpu_that_is_killed_leaves_the_drive_at_rest_and_comes_back(self):
        with self.start() as system:
            self.assertEqual(self.drive.fills, 0)
            system.kill(system.pids()["second"])
            await_that(lambda: self.drive.fills == 1, 10, "the safe frame")
            told = await_that(lambda: [e["text"] for e in system.events() if e["kind"] == "safe" and "written" in
                                       e["text"]], 10, "the event")
            self.assertRegex(told[0], r"^1 safe frame written, the last byte [0-9.]+ ms after the guard saw")
            at = self.drive.torques.index(0.0)
            self.assertEqual(set(self.drive.torques[:at]), {3.0})
            system.await_state("drive", "ON")
            await_that(lambda: self.drive.torques[-1] == 3.0, 10, "the drive to turn again")

    def test_with_the_keeper_killed_as_well_the_drive_stops(self):
        system = self.start()
        try:
            self.kill_with_its_keeper(system)
            await_that(lambda: self.drive.torques[-1] == 0.0, 10, "the safe frame")
            self.assertFalse(self.drive.moves())
            system.await_nothing_left(20)
            self.assertEqual((self.drive.fills, self.drive.torques[-1]), (1, 0.0))
        finally:
            system.end()

    def test_without_the_guard_the_drive_goes_on(self):
        system = self.start()
        try:
            system.kill(self.guard(system))
            await_that(lambda: [e for e in system.events() if e["text"].startswith("the guard is dead")], 9, "an event")
            self.kill_with_its_keeper(system)
            system.await_nothing_left(20)
            self.assertTrue(self.drive.moves())
            self.assertEqual(set(self.drive.torques), {3.0})
        finally:
            system.end()

    def test_a_frame_that_was_cut_by_the_death_hides_nothing(self):
        system = self.start(16, "1 kHz")
        try:
            self.drive.is_deaf = True
            await_that(lambda: system.call("get", variables=["unsent"])["values"]["unsent"]["value"] > 5, 60,
                       "a line that is full")
            self.kill_with_its_keeper(system)
            system.await_nothing_left(20)
            self.drive.is_deaf = False
            await_that(lambda: self.drive.torques[-1] == 0.0, 10, "the safe frame")
            self.assertFalse(self.drive.moves())
        finally:
            system.end()

    def test_a_drill_kills_and_tells_when_the_frame_was_written(self):
        with self.start() as system:
            answer = system.call("drill", kill="second")
            self.assertEqual([(t["task"], t["verdict"]) for t in answer["tasks"]], [("drive", "safe")])
            self.assertEqual((answer["killed"]["written"], answer["killed"]["lost"]), (1, 0))
            self.assertGreater(answer["killed"]["after_ns"], 0)
            self.assertTrue(answer["safe"])
            await_that(lambda: self.drive.fills == 1, 10, "the safe frame")
            system.await_state("drive", "ON")
            await_that(lambda: self.drive.torques[-1] == 3.0, 10, "the drive to turn again")

    def test_a_task_that_is_silent_for_too_long_is_ended_and_its_frame_written(self):
        self.drive = Drive(1)
        self.addCleanup(self.drive.end)
        text = TEXT.replace("LINE", self.drive.name).replace("RATE", "100 Hz").replace("TORQUE", "[3]")
        text = text.replace("    {component: serial_frame, rtpu: second,",
                            "    {component: serial_frame, rtpu: second, safe_after: 20,")
        with System(text) as system:
            system.await_state("drive", "ON")
            await_that(lambda: self.drive.torques[-1:] == [3.0], 10, "the drive to turn")
            pid = system.pids()["second"]
            system.kill(pid, signal.SIGSTOP)  # it publishes nothing any more, and would be found after 3 s
            began = time.monotonic()
            await_that(lambda: self.drive.fills == 1, 10, "the safe frame")
            self.assertLess(time.monotonic() - began, 2)
            await_that(lambda: [e for e in system.events() if e["kind"] == "safe" and e.get("task") == "drive" and
                                "safe_after" in e["text"]], 10, "the event")
            system.await_state("drive", "ON")

    @unittest.skipUnless((BUILD / "components/modbus_io.so").exists(), "modbus_io is not built")
    def test_a_modbus_device_is_told_over_a_connection_of_its_own(self):
        for _ in range(3):  # one that does not answer within 200 ms is connected anew, and has no safe frame then
            if self.is_told_over_a_connection_of_its_own():
                return
        self.fail("the device stalled each time")

    def is_told_over_a_connection_of_its_own(self):
        device = ModbusDevice()
        self.addCleanup(device.door.close)
        text = TEXT.replace("serial_frame", "modbus_io").replace(
            "alias: {command: torque}", "alias: {input: [level], contact: [], holding: [torque], coil: []}")
        text = text.replace("LINE", f"'tcp:127.0.0.1:{device.port}'").replace("RATE", "100 Hz").replace("TORQUE", "7")
        with System(text) as system:
            system.await_state("drive", "ON")
            await_that(lambda: device.writes and device.writes[-1][1] == 7, 10, "the device to turn")
            second = system.pids()["second"]
            self.assertTrue(system.kill(second, signal.SIGSTOP))  # nothing is connected anew from here on
            if device.n > 2:
                return False
            self.assertTrue(system.kill(second))
            await_that(lambda: (2, 0) in device.writes, 10, "the safe frame")
            self.assertEqual(set(device.writes[:device.writes.index((2, 0))]), {(1, 7)})
            system.await_state("drive", "ON")
            await_that(lambda: device.writes[-1][0] >= 3 and device.writes[-1][1] == 7, 10, "the device to turn again")
            return True

    def test_a_task_that_was_turned_off_leaves_nothing_to_write(self):
        with self.start() as system:
            system.signal("off", "drive")
            await_that(lambda: self.drive.torques[-1] == 0.0, 10, "the frame of off")
            system.kill(system.pids()["second"])
            system.await_state("drive", "OFF")
            self.assertEqual(self.drive.fills, 0)


if __name__ == "__main__":
    unittest.main(verbosity=1)
