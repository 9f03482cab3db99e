# SPDX-License-Identifier: Apache-2.0
"""Random sets of the twins test, baked into one image, make the same records in QEMU as on this machine, on a clock
that steps. usage: random_sets_test.py BUILD_TREE SEED...   or, as a campaign: --build BUILD_TREE --seconds N"""
import argparse
import itertools
import json
import pathlib
import random
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "firmware"))
import build  # noqa: E402
import qemu  # noqa: E402
import sizes  # noqa: E402

HERE = ROOT / "tests" / "firmware" / "toys"
TARGET = ROOT / "firmware" / "targets" / "mps2-an385.yaml"
MEMORY = """MEMORY {
  FLASH (rx) : ORIGIN = 0x00000000, LENGTH = 4M
  RAM (rwx) : ORIGIN = 0x20000000, LENGTH = 4M
}
chimera_stack_bytes = 16384;
chimera_handler_stack_bytes = 2048;
"""
OF_CAMPAIGN = 8  # sets in one image


def make(tree, out, seeds):
    """The image with these sets, and the records that this machine makes of them."""
    baked = out / "baked"
    baked.mkdir(parents=True, exist_ok=True)
    subprocess.run([tree / "tests" / "firmware" / "toy_sets", TARGET, baked, *map(str, seeds)], check=True,
                   stdin=subprocess.DEVNULL)
    (baked / "memory.ld").write_text(MEMORY)
    (baked / "cpu.flags").write_text("-mcpu=cortex-m3 -mthumb\n")
    (baked / "components.txt").write_text("")
    shutil.copyfile(baked / f"{seeds[0]}.cc", baked / "tables.cc")  # its target is that of the board
    program = [(HERE / "main.cc", ""), (HERE / "toy.cc", ""), (baked / "toys.cc", "")]
    program += [(baked / f"{seed}.cc", f"-Dbaked=baked_{seed}") for seed in seeds]
    elf = build.build(baked, out, "mps2", program=program)
    return elf, (baked / "records.txt").read_text().splitlines()


def by_set(lines):
    """{line of the set: its lines}"""
    found, of = {}, None
    for line in lines:
        if line.startswith("set "):
            of = found.setdefault(line, [])
        elif of is not None and line.split()[0] in ("record", "refused"):
            of.append(line)
    return found


def complaints(tree, out, seeds):
    elf, expected = make(tree, out, seeds)
    yield from sizes.complaints(elf)
    lines, code = qemu.run("mps2-an385", elf)
    if code != 0:
        yield f"{elf}: exit {code}, its last lines: {lines[-5:]}"
    image, host = by_set(lines), by_set(expected)
    for name in host:
        pairs = itertools.zip_longest(image.get(name, []), host[name], fillvalue="nothing")
        n, differs = next(((n, pair) for n, pair in enumerate(pairs) if pair[0] != pair[1]), (0, None))
        if differs:
            yield f"{name}, record {n}: the image has '{differs[0]}', this machine has '{differs[1]}'"
    n = sum(map(len, host.values()))
    print(f"{len(host)} sets, {n} records")
    if n < 20 * len(host):
        yield f"{n} records are too few to compare"


def campaign(tree, seconds):
    end, n, faults = time.monotonic() + seconds, 0, []
    dice = random.Random()
    while n == 0 or time.monotonic() < end:
        seeds = [dice.randrange(1, 1 << 31) for _ in range(OF_CAMPAIGN)]
        faults += complaints(tree, tree / "firmware" / "toys_campaign", seeds)
        n += len(seeds)
    print("\n".join(faults))
    print(json.dumps({"name": "baked_sets", "n": n, "faults": len(faults)}))
    return 1 if faults else 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("words", nargs="*")
    parser.add_argument("--build")
    parser.add_argument("--seconds", type=float)
    arguments = parser.parse_args()
    for program in ("arm-none-eabi-g++", "qemu-system-arm", "ninja"):
        if shutil.which(program) is None:
            print(f"{program} is not installed")
            return 77
    if arguments.seconds is not None:
        return campaign(pathlib.Path(arguments.build).resolve(), arguments.seconds)
    tree = pathlib.Path(arguments.words[0]).resolve()
    found = list(complaints(tree, tree / "firmware" / "toys", [int(each) for each in arguments.words[1:]]))
    print("\n".join(found) or "the records of the image are those of this machine")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
