# SPDX-License-Identifier: Apache-2.0
"""Builds the image of a board of a description, and starts it in QEMU (docs/formats/link.md).
usage: board.py CHIMERA FILE RTPU OUT         bakes and links OUT/image.elf
       board.py CHIMERA FILE RTPU OUT start   and runs it in QEMU until this process or its parent ends"""
import contextlib
import os
import pathlib
import re
import selectors
import socket
import subprocess
import sys
import threading
import tty

import build
import yaml


class BoardError(Exception):
    """What the user reads."""


def bake(chimera, file, rtpu, out):
    command = [str(chimera), "bake", str(file), "--rtpu", rtpu, "--out", str(out / "baked")]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode != 0:
        raise BoardError(done.stdout + done.stderr)


def image(chimera, file, rtpu, out):
    """OUT/image.elf, up to date."""
    bake(chimera, file, rtpu, out)
    board = re.search(r'\.board = "([\w-]+)"', (out / "baked" / "tables.cc").read_text())[1]
    return build.build(out / "baked", out, board, [pathlib.Path(file).resolve().parent])


def machine(out):
    """QEMU's machine for the image."""
    board = re.search(r'\.board = "([\w-]+)"', (out / "baked" / "tables.cc").read_text())[1]
    cpu = re.search(r"-mcpu=([\w-]+)", (out / "baked" / "cpu.flags").read_text())[1]
    found = build.SIMULATED.get(board, {}).get(cpu)
    if found is None:
        raise BoardError(f"QEMU has no board {board} with {cpu}: load {out}/image.elf with your programmer")
    return found


def link_of(file, rtpu):
    return yaml.safe_load(pathlib.Path(file).read_text())["rtpus"][rtpu]["link"]


def command(machine_name, elf):
    """Time passes as on the machine below, because Linux is at the other end."""
    return ["qemu-system-arm", "-M", machine_name, "-kernel", str(elf), "-nographic", "-nodefaults",
            "-monitor", "none", "-semihosting-config", "enable=on,target=native", "-serial", "stdio"]


class Line:
    """A line to the board: bytes go through `damage`, a function of (to the board?, bytes)."""

    def __init__(self):
        self.damage = lambda to_board, data: data

    def serve(self, process):
        """Until the process ends its output."""
        streams = selectors.DefaultSelector()
        streams.register(self.fileno(), selectors.EVENT_READ)
        streams.register(process.stdout, selectors.EVENT_READ)
        while True:
            for key, _ in streams.select():
                to_board = key.fileobj == self.fileno()
                data = self.read() if to_board else os.read(process.stdout.fileno(), 4096)
                if not data:
                    return
                data = self.damage(to_board, data)
                try:
                    if to_board:
                        os.write(process.stdin.fileno(), data)
                    elif data:
                        self.write(data)
                except BrokenPipeError:
                    return


class Pty(Line):
    """A serial device: a pseudo terminal behind a path."""

    def __init__(self, path):
        super().__init__()
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        is_ours = path.is_symlink() and os.readlink(path).startswith("/dev/pts/")
        if path.exists() and not is_ours:
            raise BoardError(f"{path}: is there already. For a board in QEMU name a path that is free; to a board at "
                             "this one load image.elf with your programmer, and run without --flash")
        path.unlink(missing_ok=True)
        path.symlink_to(os.ttyname(self.slave))

    def fileno(self):
        return self.master

    def read(self):
        return os.read(self.master, 4096)

    def write(self, data):
        os.write(self.master, data)


class Udp(Line):
    """UDP. QEMU has it, too, but is deaf after it sent to a port that nothing listened at."""

    def __init__(self, address):
        super().__init__()
        there, _, local = address.partition("@")
        host, port = there.rsplit(":", 1)
        self.linux = (host, int(local)) if local else None  # None: unknown before it sends
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind((host, int(port)))

    def fileno(self):
        return self.socket.fileno()

    def read(self):
        data, self.linux = self.socket.recvfrom(4096)
        return data

    def write(self, data):
        if self.linux is not None:
            self.socket.sendto(data, self.linux)


class Qemu:
    """The image in QEMU, at the line of `link`. `line` may be of an earlier start."""

    def __init__(self, machine_name, elf, link, line=None):
        self.line = line or (Udp(link["udp"]) if "udp" in link else Pty(pathlib.Path(link["serial"])))
        self.process = subprocess.Popen(command(machine_name, elf), stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        bufsize=0)
        threading.Thread(target=self.line.serve, args=(self.process,), daemon=True).start()

    def stop(self):
        self.process.kill()
        self.process.wait()


def serve(qemu, parent):
    while os.getppid() == parent:
        try:
            qemu.process.wait(0.2)
            return
        except subprocess.TimeoutExpired:
            pass
    qemu.stop()


def main():
    parent = os.getppid()
    chimera, file, rtpu, out = map(pathlib.Path, sys.argv[1:5])
    rtpu = str(rtpu)
    try:
        elf = image(chimera, file, rtpu, out)
        if len(sys.argv) == 5:
            print(elf)
            return
        if os.getppid() != parent:  # `chimera run` was interrupted
            return
        qemu = Qemu(machine(out), elf, link_of(file, rtpu))
    except (BoardError, build.BuildError) as error:
        sys.exit(str(error))
    with contextlib.suppress(BrokenPipeError):
        os.write(sys.stdout.fileno(), b"started\n")
    serve(qemu, parent)


if __name__ == "__main__":
    main()
