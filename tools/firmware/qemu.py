# SPDX-License-Identifier: Apache-2.0
"""Runs an image in QEMU. Each instruction takes the same time, so two runs are equal: 64 ns are those of a core of
15 million instructions a second. Idle time takes no time of the host.
usage: qemu.py MACHINE IMAGE [LIMIT_S]   prints the lines of the serial port"""
import queue
import shutil
import subprocess
import sys
import threading

LIMIT_S = 300
HANG_S = 60  # a test waits no longer for a line
INSTRUCTION_NS = 64


class QemuError(Exception):
    """What the user reads."""


def command(machine, image, instruction_ns):
    if shutil.which("qemu-system-arm") is None:
        raise QemuError("qemu-system-arm: not installed. On Debian or Ubuntu: sudo apt install --no-install-recommends "
                        "qemu-system-arm")
    shift = instruction_ns.bit_length() - 1
    if instruction_ns != 1 << shift or shift > 10:
        raise QemuError(f"instruction_ns {instruction_ns}: QEMU takes a power of two, 1 to 1024")
    return ["qemu-system-arm", "-M", machine, "-kernel", str(image), "-nographic", "-nodefaults",
            "-monitor", "none", "-serial", "stdio", "-icount", f"shift={shift},sleep=off,align=off",
            "-semihosting-config", "enable=on,target=native"]


def run(machine, image, limit_s=LIMIT_S, instruction_ns=INSTRUCTION_NS):
    """(lines of the serial port, exit code). Raises QemuError if the image does not end within the limit."""
    with subprocess.Popen([*command(machine, image, instruction_ns), "-no-reboot"], stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace") as process:
        try:
            out, err = process.communicate(timeout=limit_s)
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
            raise QemuError(f"{image}: has not ended after {limit_s} s; its last line: "
                            f"{(out.splitlines() or ['none'])[-1]}") from None
    if not out and err:
        raise QemuError(f"{image}: {err.strip()}")
    return out.splitlines(), process.returncode


class Session:
    """A running image, and the two ends of its serial line. Use it with `with`: then it ends."""

    def __init__(self, machine, image, instruction_ns=INSTRUCTION_NS):
        self.process = subprocess.Popen(command(machine, image, instruction_ns), stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.lines = []  # so far
        self.fresh = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    def _read(self):
        for line in self.process.stdout:
            self.fresh.put(line.decode(errors="replace").rstrip("\r\n"))
        self.fresh.put(None)

    def send(self, data):
        """Bytes or a text."""
        self.process.stdin.write(data.encode() if isinstance(data, str) else data)
        self.process.stdin.flush()

    def line(self):
        """The next line. Raises QemuError if the image ended or hangs."""
        try:
            line = self.fresh.get(timeout=HANG_S)
        except queue.Empty:
            line = None
        if line is None:
            raise QemuError(f"no line for {HANG_S} s, or the image ended; its last lines:\n  "
                            + "\n  ".join(self.lines[-8:]))
        self.lines.append(line)
        return line

    def wait_for(self, start):
        """The next line that begins so."""
        while not (line := self.line()).startswith(start):
            pass
        return line

    def ask(self, text):
        """The rows of a command and its answer, which is the last one: "ok" or "no: REASON"."""
        self.send(text + "\n")
        rows = []
        while not rows or (rows[-1] != "ok" and not rows[-1].startswith("no: ")):
            line = self.line()
            rows += [] if line.startswith("digest ") else [line]
        return rows


def main():
    lines, code = run(sys.argv[1], sys.argv[2], float(sys.argv[3]) if len(sys.argv) > 3 else LIMIT_S)
    print("\n".join(lines))
    sys.exit(code)


if __name__ == "__main__":
    main()
