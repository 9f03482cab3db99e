# SPDX-License-Identifier: Apache-2.0
"""Talks to an image in QEMU over its serial line: commands, noise, tasks that fail, a pin, interrupts.
usage: workbench_test.py BUILD_TREE [CASE ...]"""
import contextlib
import pathlib
import random
import re
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "firmware"))
import digest  # noqa: E402
import image as images  # noqa: E402
import qemu  # noqa: E402

TASKS = ("fw_fault", "fw_lamp", "button", "fw_timer")
NOISE_BYTES = 1 << 20


class Wrong(Exception):
    """What the image said in place of what it must say."""


def expect(rows, pattern):
    """The first of the rows that begins with the pattern."""
    for row in rows:
        if re.match(pattern, row):
            return row
    raise Wrong(f"no line begins with {pattern!r}:\n  " + "\n  ".join(rows))


def value(session, variable):
    row = expect(session.ask(f"get {variable}"), rf"{variable} = ")
    return re.match(r"\S+ = ([^ ,]+)", row)[1]


def await_value(session, variable, is_reached):
    while not is_reached(found := value(session, variable)):
        pass
    return found


@contextlib.contextmanager
def started(built):
    with built.session() as session:
        session.wait_for("memory setup ")
        yield session


def commands(built):
    with started(built) as s:
        rows = s.ask("status")
        for pattern in (r"workbench at \d", *(f"{task} ON cycles" for task in TASKS), "stack program: ",
                        "stack handlers: ", "watchdog: healthy", "cold boot", "ok$"):
            expect(rows, pattern)
        expect(s.ask("set lamp true"), "ok$")
        await_value(s, "lamp", lambda found: found == "true")
        s.ask("events")
        for command in ("off fw_lamp", "on fw_lamp", "off fw_lamp", "kill fw_lamp", "spawn fw_lamp", "reinit fw_lamp",
                        "on fw_lamp"):
            expect(s.ask(command), "ok$")
        expect(s.ask("events"), r"\S+ s fw_lamp: ON -> OFF")
        expect(s.ask("profile fw_lamp"), "fw_lamp ON cycles")
        if len(s.ask("help")) != 14:
            raise Wrong("help does not list 13 commands")
        for line, answer in (("switch none", "no: no configuration 'none'"),
                             ("frob", "no: no command 'frob': try help"),
                             ("off nothing", "no: no task 'nothing'"), ("set way far", "no: way has "),
                             ("set way 1 2", "no: way has 1 element"), ("get", "no: get takes VARIABLE"),
                             ("clear fw_lamp", "no: "), ("x" * 97, "no: a line has at most 96 bytes, not 97"),
                             ("on \x07", "no: byte 7 is no character of a command")):
            expect(s.ask(line)[-1:], answer)
        expect(s.ask("status"), "ok$")


def failures(built):
    ends = {1: "watchdog", 2: "stack overflow", 3: "processor fault", 4: "processor fault"}
    for way, cause in ends.items():
        with started(built) as s:
            await_value(s, "safe_word", lambda found: found == "0")
            s.send(f"set way {way}\n")
            boot = expect([s.wait_for("warm boot ")], f"warm boot 1: {cause} in cycle of task fw_fault")
            s.wait_for("memory setup ")
            expect(s.ask("status"), re.escape(boot))
            await_value(s, "safe_word", lambda found: found == "42")
    with started(built) as s:
        s.send("set way 5\n")
        for boots in (1, 2):
            expect([s.wait_for("warm boot ")], f"warm boot {boots}: watchdog in cycle of task fw_fault at 0x\\w+$")
        expect([s.wait_for("warm boot ")], "warm boot 3: watchdog in cycle .*; no task is started$")
        s.wait_for("memory setup ")
        expect(s.ask("status"), "fw_fault NOT-CREATED ")
        for command in ("spawn fw_fault", "on fw_fault"):
            expect(s.ask(command), "ok$")
        expect(s.ask("status"), "fw_fault ON ")


def interrupts(built):
    with started(built) as s:
        await_value(s, "interrupts", lambda found: int(found) >= 10_000)
        if (lost := value(s, "lost")) != "0":
            raise Wrong(f"{lost} interrupts are lost")
        expect(s.ask("profile fw_timer"), ".*events lost 0 ")


def pin(built):
    with started(built) as s:
        s.ask("events")
        for lamp, state in (("true", "ON -> OFF"), ("false", "OFF -> ON")):
            expect(s.ask(f"set lamp {lamp}"), "ok$")
            await_value(s, "pressed", lambda found, lamp=lamp: found == lamp)
            rows = []
            while not any(f"fw_fault: {state}" in row for row in rows):
                rows += s.ask("events")
        if (presses := value(s, "presses")) != "1":
            raise Wrong(f"the button was pressed {presses} times")


def seconds_of(session, until):
    """The digest up to that second."""
    while int(session.wait_for("digest ").split()[1]) < until:
        pass
    return digest.of_image(session.lines)


def noise(built):
    """The answers to noise come between the hashes, and leave them as they are. The instants of interrupts are not
    equal: bytes shift them."""
    dice = random.Random(30)
    data = bytes(dice.choices([*range(256), *b"\n\n\n"], k=NOISE_BYTES))
    with started(built) as s:
        n_sent = 0
        while n_sent < len(data):
            s.send(data[n_sent:n_sent + 65536])
            n_sent += 65536
        s.send("\n")
        rows = s.ask("status")
        while not rows[0].startswith("workbench at "):
            rows = s.ask("status")
        last = int(re.match(r"workbench at (\d+)", rows[0])[1])
        noisy = seconds_of(s, last + 3)
        print(f"{len(data)} bytes of noise in the first {last} s of the image; " +
              next((row for row in rows if row.startswith("input: ")), "no byte lost"))
    with started(built) as s:
        quiet = seconds_of(s, last + 3)
    for key in noisy:
        if int(key[0]) <= last + 1 and key[1] != "fw_timer" and noisy[key] != quiet.get(key):
            raise Wrong(f"second {key[0]}, task {key[1]}: {noisy[key]} with noise, {quiet.get(key)} without")


CASES = {"commands": commands, "failures": failures, "interrupts": interrupts, "pin": pin, "noise": noise}


def main():
    for program in ("arm-none-eabi-g++", "qemu-system-arm", "ninja"):
        if shutil.which(program) is None:
            print(f"{program} is not installed")
            return 77
    tree = pathlib.Path(sys.argv[1]).resolve()
    image = images.Image.of_file(ROOT / "tests" / "firmware" / "workbench" / "image.yaml")
    built = images.Built(image, image.targets[0], tree, tree / "firmware")
    built.bake()
    built.link()
    n_wrong = 0
    for name in sys.argv[2:] or CASES:
        try:
            CASES[name](built)
            print(f"{name}: as it must be")
        except (Wrong, qemu.QemuError) as error:
            n_wrong += 1
            print(f"{name}: {error}")
    return 1 if n_wrong else 0


if __name__ == "__main__":
    sys.exit(main())
