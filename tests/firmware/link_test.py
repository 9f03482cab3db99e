# SPDX-License-Identifier: Apache-2.0
"""A board in QEMU is an rtpu of a subsystem on Linux: its tasks go ON and OFF, its values arrive, a cut line ends its
rtpu, and all comes back by itself, also after a reset of the board; noise and a slow line change nothing but the number
of frames. usage: link_test.py BUILD_TREE serial|udp"""
import json
import os
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "firmware"))
import board  # noqa: E402
import build  # noqa: E402

HANG_S = 60
DESCRIPTION = """\
subsystem: {name}
rtpus:
  linux: {{}}
  board: {{target: {target}, link: {{{line}, rate: 50 Hz, stale_after: 2 s}}}}
tasks:
  signal_generator:
    {{rtpu: linux, rate: 100 Hz, alias: {{y: wave}}, constants: {{wave: sine, amplitude: 1 V, frequency: 1 Hz}}}}
  gain: {{rtpu: board, rate: 100 Hz, alias: {{x: wave, y: scaled}}, constants: {{k: 2}}}}
  limit: {{rtpu: linux, rate: 100 Hz, alias: {{x: scaled, y: limited}}, constants: {{low: -1 V, high: 1 V}}}}
"""


TARGET = "version: 1\nlike: mps2-an385\n"


class Hang(Exception):
    """What did not happen."""


class System:
    """`chimera run` of the description, and questions to it."""

    def __init__(self, tree, folder, name, file):
        self.tree, self.name = tree, name
        self.environment = dict(os.environ, ASAN_OPTIONS="detect_leaks=0", CHIMERA_PATH=str(tree / "components"),
                                XDG_RUNTIME_DIR=str(folder), XDG_STATE_HOME=str(folder))
        self.log = open(folder / "run.log", "w")
        self.run = subprocess.Popen([tree / "bin" / "chimera", "run", file, "--priority", "0"], env=self.environment,
                                    stdin=subprocess.DEVNULL, stdout=self.log, stderr=subprocess.STDOUT)

    def ask(self, *words):
        done = subprocess.run([self.tree / "bin" / "chimera", *words, "--subsystem", self.name, "--json"],
                              env=self.environment, capture_output=True, text=True)
        try:
            return json.loads(done.stdout.splitlines()[0])
        except (IndexError, ValueError):
            return {"said": done.stdout + done.stderr}

    def task(self, name):
        return next((task for task in self.ask("status").get("tasks", []) if task["task"] == name), {})

    def value(self, name):
        return self.ask("get", name).get("values", {}).get(name, {}).get("value")

    def events(self):
        return self.ask("events").get("events", [])

    def end(self):
        self.run.send_signal(signal.SIGINT)
        return self.run.wait(HANG_S)


def await_that(what, holds):
    until = time.monotonic() + HANG_S
    while not (found := holds()):
        if time.monotonic() > until:
            raise Hang(f"{what}: not after {HANG_S} s")
        time.sleep(0.05)
    return found


def is_moving(system):
    """Three different values of the board's variable, each of them twice the wave."""
    seen = set()

    def holds():
        value = system.value("scaled")
        if isinstance(value, (int, float)):
            seen.add(value)
        return len(seen) >= 3
    await_that("values of the board change", holds)


def is_on(system, name):
    await_that(f"{name} is ON", lambda: system.task(name).get("state") == "ON")


def ended(system):
    return [event for event in system.events() if event["kind"] == "rtpu-ended"]


def goes_down_and_comes_back(system, what, down, up):
    before = len(ended(system))
    down()
    await_that(f"{what}: the rtpu ends", lambda: len(ended(system)) > before)
    assert "board" in ended(system)[-1]["text"], ended(system)[-1]
    up()
    is_on(system, "gain")
    is_moving(system)


def judge(tree, folder, kind):
    if kind == "serial":
        line = f"serial: {folder}/board.tty"
    else:
        ports = []
        for _ in range(2):
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
                free.bind(("127.0.0.1", 0))
                ports.append(free.getsockname()[1])
        line = f'udp: "127.0.0.1:{ports[0]}@{ports[1]}"'
    name = f"link_{kind}"
    file = folder / "link.yaml"
    target = folder / "roomy.yaml"
    target.write_text(TARGET)
    file.write_text(DESCRIPTION.format(name=name, line=line, target=target))
    out = tree / "firmware" / f"link.{kind}"
    out.mkdir(parents=True, exist_ok=True)
    os.environ.update(ASAN_OPTIONS="detect_leaks=0", CHIMERA_PATH=str(tree / "components"))
    elf = board.image(tree / "bin" / "chimera", file, "board", out)
    machine, link = board.machine(out), board.link_of(file, "board")
    state = {"qemu": board.Qemu(machine, elf, link)}
    system = System(tree, folder, name, file)
    try:
        is_on(system, "gain")
        is_moving(system)
        assert system.ask("off", "gain").get("tasks"), "off is refused"
        is_off = await_that("gain is OFF", lambda: system.task("gain").get("state") == "OFF")
        assert is_off
        assert system.ask("on", "gain").get("tasks") or system.task("gain").get("state") == "ON", "on is refused"
        is_on(system, "gain")
        is_moving(system)

        def start_again():
            state["qemu"] = board.Qemu(machine, elf, link, state["qemu"].line)

        line = state["qemu"].line

        def damage(what):
            line.damage = what

        whole = line.damage
        goes_down_and_comes_back(system, "cut", lambda: damage(lambda to_board, data: b""), lambda: damage(whole))
        dice = random.Random(6)
        # One byte in 400 is another one: some frames are lost, most arrive.
        damage(lambda to_board, data: bytes(dice.randrange(256) if dice.random() < 1 / 400 else byte for byte in data))
        is_moving(system)
        damage(lambda to_board, data: (time.sleep(0.02), data)[1])  # slow
        is_moving(system)
        damage(whole)
        goes_down_and_comes_back(system, "restart", lambda: state["qemu"].stop(), start_again)
        system.end()
    finally:
        if system.run.poll() is None:
            system.run.kill()
        state["qemu"].stop()
        system.log.close()
        print((folder / "run.log").read_text())


def main():
    tree, kind = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    for program in ("arm-none-eabi-g++", "qemu-system-arm", "ninja"):
        if shutil.which(program) is None:
            print(f"{program} is not installed")
            return 77
    with tempfile.TemporaryDirectory() as folder:
        try:
            judge(tree, pathlib.Path(folder), kind)
        except (AssertionError, Hang, board.BoardError, build.BuildError) as error:
            print(f"{kind}: {error}")
            return 1
    print(f"{kind}: the board took part, was lost, and came back")
    return 0


if __name__ == "__main__":
    sys.exit(main())
