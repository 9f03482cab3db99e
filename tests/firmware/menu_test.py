# SPDX-License-Identifier: Apache-2.0
"""A person at the screen and the keys of a menu, which an image shows on its serial line.
usage: menu_test.py BUILD_TREE"""
import pathlib
import re
import select
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "firmware"))
import image as images  # noqa: E402
import qemu  # noqa: E402

PIECE = re.compile(rb"\x1b\[(?:(\d+);(\d+)H|(2J)|\?25l)|([ -~])|[\r\n]")


class Screen:
    """What a terminal with 8 rows of 32 columns shows."""

    def __init__(self, process):
        self.process, self.bytes = process, b""
        self.rows = [[" "] * 32 for _ in range(8)]
        self.row = self.column = 0

    def press(self, keys):
        self.process.stdin.write(keys)
        self.process.stdin.flush()

    def take(self, data):
        self.bytes += data
        at = 0
        while piece := PIECE.match(self.bytes, at):
            at = piece.end()
            if piece[1]:
                self.row, self.column = int(piece[1]) - 1, int(piece[2]) - 1
            elif piece[3]:
                self.rows = [[" "] * 32 for _ in range(8)]
            elif piece[4] and self.column < 32:
                self.rows[self.row][self.column] = piece[4].decode()
                self.column += 1
        self.bytes = self.bytes[at:]

    def text(self):
        return "\n".join("".join(row).rstrip() for row in self.rows)

    def await_row(self, pattern):
        """Returns when a row matches. Raises if none does within the limit of a hang."""
        until = time.monotonic() + qemu.HANG_S
        while not re.search(pattern, self.text(), re.MULTILINE):
            if not select.select([self.process.stdout], [], [], max(0, until - time.monotonic()))[0]:
                raise AssertionError(f"no row is {pattern!r}; the screen:\n{self.text()}\n{self.bytes!r}")
            self.take(self.process.stdout.read1(4096))


def main():
    for program in ("arm-none-eabi-g++", "qemu-system-arm", "ninja"):
        if shutil.which(program) is None:
            print(f"{program} is not installed")
            return 77
    tree = pathlib.Path(sys.argv[1]).resolve()
    image = images.Image.of_file(ROOT / "tests" / "firmware" / "menu" / "image.yaml")
    built = images.Built(image, image.targets[0], tree, tree / "firmware")
    built.bake()
    built.link()
    with subprocess.Popen(qemu.command(built.machine(), built.elf, image.instruction_ns), stdin=subprocess.PIPE,
                          stdout=subprocess.PIPE) as process:
        try:
            screen = Screen(process)
            screen.await_row(r"doubled +40\b")
            screen.press(b"j\r")
            screen.await_row(r"wanted +20\b")
            screen.press(b"\r27.25\r")
            screen.await_row(r"wanted +27\.25")
            screen.press(b"q")
            screen.await_row(r"doubled +54\.5")
            screen.press(bytes(range(128, 256)) * 100 + b"\f")  # no key; the port holds what has no room
            screen.await_row(r"doubled +54\.5")
            print(screen.text())
        finally:
            process.kill()
    return 0


if __name__ == "__main__":
    sys.exit(main())
