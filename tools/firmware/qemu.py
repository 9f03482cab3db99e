# SPDX-License-Identifier: Apache-2.0
"""Runs an image in QEMU. Each instruction takes the same time, so two runs are equal: 64 ns are those of a core of
15 million instructions a second. Idle time takes no time of the host.
usage: qemu.py MACHINE IMAGE [LIMIT_S]   prints the lines of the serial port"""
import shutil
import subprocess
import sys

LIMIT_S = 300
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
    return ["qemu-system-arm", "-M", machine, "-kernel", str(image), "-nographic", "-nodefaults", "-monitor", "none",
            "-icount", f"shift={shift},sleep=off,align=off", "-semihosting-config", "enable=on,target=native",
            "-serial", "stdio"]


def run(machine, image, limit_s=LIMIT_S, instruction_ns=INSTRUCTION_NS):
    """(lines of the serial port, exit code). Raises QemuError if the image does not end within the limit."""
    with subprocess.Popen(command(machine, image, instruction_ns), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, errors="replace") as process:
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


def main():
    lines, code = run(sys.argv[1], sys.argv[2], float(sys.argv[3]) if len(sys.argv) > 3 else LIMIT_S)
    print("\n".join(lines))
    sys.exit(code)


if __name__ == "__main__":
    main()
