# SPDX-License-Identifier: Apache-2.0
"""Safe frames on real processes: a drive on a serial line goes on with the torque of the last frame. When the process
of its task is killed the guard writes a safe frame; when the keeper is killed with it, too."""
import os
import select
import signal
import socket
import struct
import threading
import time
import tty
import unittest

from system import RTPUS, System, await_that

TEXT = RTPUS + """
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
    """Turns by the torque of the last good frame, and answers each. `torques`: those of all good frames from the first
    that is not idle on, in order."""

    def __init__(self, axes):
        self.payload = 4 * axes
        self.master, self.slave = os.openpty()
        os.set_blocking(self.master, False)
        tty.setraw(self.slave)
        self.name = os.ttyname(self.slave)
        self.torques, self.fills, self.held = [], 0, b""
        self.is_deaf, self.is_over = False, False
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def end(self):
        self.is_over = True
        self.thread.join()
        os.close(self.master)
        os.close(self.slave)

    def run(self):
        while not self.is_over:
            if self.is_deaf or not select.select([self.master], [], [], 0.005)[0]:
                time.sleep(0.005 if self.is_deaf else 0)
                continue
            try:
                self.held += os.read(self.master, 65536)
            except (BlockingIOError, OSError):
                continue
            self.take()

    def take(self):
        """Reads a stream as a device does: skips a start byte that begins no frame."""
        self.fills += self.held.count(bytes(FILL))
        end = self.payload + 4
        while len(self.held) >= end:
            if self.held[0] != START or self.held[1] != self.payload:
                self.held = self.held[1:]
            elif crc16(self.held[1:end - 2]) != int.from_bytes(self.held[end - 2:end], "little"):
                self.held = self.held[1:]
            else:
                torque = struct.unpack("<f", self.held[2:6])[0]
                if torque != 0 or self.torques:
                    self.torques.append(torque)
                self.held = self.held[end:]
                self.answer()

    def answer(self):
        body = struct.pack("<Bf", 4, 0)
        try:
            os.write(self.master, bytes([START]) + body + struct.pack("<H", crc16(body)))
        except (BlockingIOError, OSError):
            pass

    def turns(self):
        return self.torques[-1:] == [3.0]

    def stands(self):
        return self.torques[-1:] == [0.0]


class ModbusDevice:
    """Holding registers behind TCP, for any number of connections. `writes`: (the connection, the first register), from
    the first value that is not idle on, in order."""

    def __init__(self):
        self.listening = socket.create_server(("127.0.0.1", 0))
        self.port, self.writes, self.n = self.listening.getsockname()[1], [], 0
        threading.Thread(target=self.run, daemon=True).start()

    def run(self):
        while True:
            try:
                client = self.listening.accept()[0]
            except OSError:
                return
            self.n += 1
            threading.Thread(target=self.serve, args=(client, self.n), daemon=True).start()

    def serve(self, client, connection):
        with client, client.makefile("rb") as stream:
            while len(head := stream.read(7)) == 7:
                request = stream.read(struct.unpack(">HHHB", head)[2] - 1)
                value = struct.unpack(">H", request[6:8])[0] if request[0] == 16 else 0
                if request[0] == 16 and (value != 0 or self.writes):
                    self.writes.append((connection, value))
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
        await_that(self.drive.turns, "the drive to turn")
        return system

    def kill_with_its_keeper(self, system):
        """The rtpu is stopped before: it would end in order when it sees that its keeper is dead."""
        pids = system.pids()
        for who, how in (("second", signal.SIGSTOP), ("keeper", signal.SIGKILL), ("second", signal.SIGKILL)):
            self.assertTrue(system.kill(pids[who], how), who)
        system.disconnect()

    def await_turning_again(self, system):
        system.await_state("drive", "ON")
        await_that(self.drive.turns, "the drive to turn again")

    def test_an_rtpu_that_is_killed_leaves_the_drive_at_rest_and_comes_back(self):
        with self.start() as system:
            self.assertEqual(self.drive.fills, 0)
            system.kill(system.pids()["second"])
            await_that(lambda: self.drive.fills == 1, "the safe frame")
            self.assertRegex(system.await_event(0, "safe", "written")["text"],
                             r"^1 safe frame written, the last byte [0-9.]+ ms after the guard saw")
            at = self.drive.torques.index(0.0)
            self.assertEqual(set(self.drive.torques[:at]), {3.0})
            self.await_turning_again(system)

    def test_with_the_keeper_killed_as_well_the_drive_stops(self):
        with self.start() as system:
            self.kill_with_its_keeper(system)
            await_that(self.drive.stands, "the safe frame")
            system.await_nothing_left()
            self.assertEqual((self.drive.fills, self.drive.torques[-1]), (1, 0.0))

    def test_without_the_guard_the_drive_goes_on(self):
        with self.start() as system:
            guard, = system.named("chimera-guard")
            system.kill(guard)
            await_that(lambda: "the guard is dead" in str(system.events()), "an event")
            self.kill_with_its_keeper(system)
            system.await_nothing_left()
            self.assertEqual(set(self.drive.torques), {3.0})

    def test_a_stopped_guard_is_reported_and_writes_no_late_frame(self):
        with self.start() as system:
            guard, = system.named("chimera-guard")
            self.assertEqual(system.call("status")["guard"]["pid"], guard)
            self.assertTrue(system.kill(guard, signal.SIGSTOP))
            system.await_event(0, "hang", "guard does not run: stopped by a signal (state T)")
            self.assertIn("guard: HANGS: does not run: stopped by", system.chimera("status", code=None).stdout)
            refused = system.chimera("drill", "--yes", "--kill", "second", code=1).stderr
            self.assertIn(f"`kill -CONT {guard}` continues a stopped one", refused)
            before = system.rtpu("second")
            system.kill(before["pid"])
            system.await_restart("second", before)
            self.await_turning_again(system)
            self.assertTrue(system.kill(guard, signal.SIGCONT))
            system.await_event(0, "hang", "guard runs again after")
            self.assertIn("0 safe frames written; 1 left out: the guard was late",
                          system.await_event(0, "safe", "left out")["text"])
            system.await_cycles("drive")
            self.assertEqual((self.drive.fills, self.drive.torques[-1]), (0, 3.0))

    def test_a_frame_that_was_cut_by_the_death_hides_nothing(self):
        with self.start(16, "1 kHz") as system:
            self.drive.is_deaf = True
            await_that(lambda: system.value("unsent") > 5, "a line that is full")
            self.kill_with_its_keeper(system)
            system.await_nothing_left()
            self.drive.is_deaf = False
            await_that(self.drive.stands, "the safe frame")

    def test_the_safe_frame_of_a_modbus_device_has_its_own_connection(self):
        device = ModbusDevice()
        self.addCleanup(device.listening.close)
        text = TEXT.replace("serial_frame", "modbus_io").replace(
            "alias: {command: torque}", "alias: {input: [level], contact: [], holding: [torque], coil: []}")
        text = text.replace("LINE", f"'tcp:127.0.0.1:{device.port}'").replace("RATE", "100 Hz").replace("TORQUE", "7")
        with System(text) as system:
            system.await_state("drive", "ON")
            await_that(lambda: device.writes and device.writes[-1][1] == 7, "the device to turn")
            # A device that does not answer within 200 ms is connected anew; the frame comes over another connection.
            self.assertTrue(system.kill(system.pids()["second"]))
            await_that(lambda: 0 in (value for _, value in device.writes), "the safe frame")
            safe = next(at for at, (_, value) in enumerate(device.writes) if value == 0)
            self.assertNotIn(device.writes[safe][0], {connection for connection, _ in device.writes[:safe]})
            self.assertEqual({value for _, value in device.writes[:safe]}, {7})
            system.await_state("drive", "ON")
            await_that(lambda: device.writes[-1][1] == 7, "the device to turn again")


if __name__ == "__main__":
    unittest.main(verbosity=1)
