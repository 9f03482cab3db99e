# SPDX-License-Identifier: Apache-2.0
"""Counts the instructions of an image by part in QEMU, per job, from the start of the loop to the end of the run.
usage: instructions.py MACHINE IMAGE.elf [NS]   (reads IMAGE.elf.map; NS of an instruction, as `instruction_ns`)
Dispatch is all of the runtime but the digest, with the clock and divisions; floating point belongs to components."""
import bisect
import collections
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import qemu
import sizes

PIECE = re.compile(r"^ \.text\S*\s+0x([0-9a-f]+)\s+0x([0-9a-f]+) (\S.*)$", re.MULTILINE)
INSTRUCTION = re.compile(r"0x([0-9a-f]{8}):\s")
BLOCK = re.compile(r"Trace \d+: 0x[0-9a-f]+ \[[0-9a-f]+/([0-9a-f]+)/")
CYCLES = re.compile(r"^task \S+ cycles (\d+)", re.MULTILINE)
DIVISION, MEMORY = re.compile(r"ldivmod|udivmod|dvmd"), "firmware/boot"


class Places:
    """Which part of the image an address belongs to: (group, name), as sizes.part()."""

    def __init__(self, map_path):
        text = map_path.read_text()
        text = re.sub(r"\n (\.text\S*)\n\s+(0x)", r"\n \1 \2", text[text.find("Linker script and memory map"):])
        self.pieces = sorted((int(begin, 16), int(size, 16), sizes.part(name))
                             for begin, size, name in PIECE.findall(text) if int(size, 16) > 0)
        self.begins = [begin for begin, _, _ in self.pieces]

    def of(self, address):
        begin, size, part = self.pieces[max(bisect.bisect_right(self.begins, address) - 1, 0)]
        return part if begin <= address < begin + size else ("other", "other")


def start_of_loop(elf):
    symbols = subprocess.run(["arm-none-eabi-nm", "-C", str(elf)], capture_output=True, text=True, check=True).stdout
    return int(re.search(r"^([0-9a-f]+) \w chimera::Executive::run\(", symbols, re.MULTILINE)[1], 16) & ~1


def executed(log, start):
    """{address of a block: instructions} from the first block at `start` on."""
    lengths, runs = {}, collections.Counter()
    block, counts = None, False
    for line in log:
        if line.startswith("IN:"):
            block = None
        elif found := INSTRUCTION.match(line):
            if block is None:
                block = int(found[1], 16)
                lengths[block] = 0
            lengths[block] += 1
        elif found := BLOCK.match(line):
            address = int(found[1], 16)
            counts = counts or address == start
            runs[address] += counts
    return {address: n * lengths.get(address, 0) for address, n in runs.items()}


def run(machine, elf, instruction_ns):
    """(instructions by block, output of the image)"""
    with tempfile.TemporaryDirectory() as folder:
        pipe = os.path.join(folder, "log")
        os.mkfifo(pipe)
        command = [*qemu.command(machine, elf, instruction_ns), "-d", "in_asm,exec,nochain", "-D", pipe]
        with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True) as process:
            with open(pipe, errors="replace") as log:
                blocks = executed(log, start_of_loop(elf))
            return blocks, process.communicate()[0]


def is_dispatch(group, name):
    if group == "kernel":
        return name != "runtime/record"
    return name == "platform/bare" or (group == "libgcc" and DIVISION.search(name)) or name == MEMORY


def main():
    machine, elf = sys.argv[1], pathlib.Path(sys.argv[2])
    places = Places(pathlib.Path(f"{elf}.map"))
    blocks, output = run(machine, elf, int(sys.argv[3]) if len(sys.argv) > 3 else qemu.INSTRUCTION_NS)
    jobs = sum(map(int, CYCLES.findall(output)))
    parts = collections.Counter()
    for address, n in blocks.items():
        parts[places.of(address)] += n
    for (group, name), n in parts.most_common():
        print(f"   {group:<10} {name:<32} {n / jobs:>10,.1f} a job")
    dispatch = sum(n for part, n in parts.items() if is_dispatch(*part))
    print(f"{jobs} jobs, dispatch {dispatch / jobs:,.0f} instructions a job")


if __name__ == "__main__":
    main()
