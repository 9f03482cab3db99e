# SPDX-License-Identifier: Apache-2.0
"""Bytes of an image by part, from the map of the linker; and what an image must not have.
usage: sizes.py IMAGE.elf   (reads IMAGE.elf.map)"""
import collections
import pathlib
import re
import subprocess
import sys

# `.text.name  0xaddress  0xsize  object`; the linker breaks a line behind a long name.
PIECE = re.compile(r"^ (\.[\w.$]+|COMMON)\s+0x[0-9a-f]+\s+0x([0-9a-f]+) (\S.*)$")
OUTPUT = re.compile(r"^(\.[\w.]+)(\s|$)")
IN_FLASH, IN_RAM = {".text", ".data", ".init_array", ".ARM.exidx"}, {".data", ".bss", ".kept"}
# Functions of an allocator, of exceptions, of static objects that are constructed at run time, and of a C library.
FOREIGN = re.compile(r"(malloc|calloc|realloc|free|_sbrk|_Znw|_Zna|_Zdl|_Zda|__cxa_throw|__cxa_allocate|__cxa_guard|"
                     r"__cxa_begin_catch|__gxx_personality|_Unwind_|__aeabi_unwind|atexit|printf|snprintf|puts|"
                     r"_impure_ptr|errno|__errno|std::ios)")


def pieces(text):
    """(output section, bytes, object) of each linked piece."""
    begin = text.find("Linker script and memory map")
    joined = re.sub(r"\n (\.[\w.$]+)\n\s+(0x)", r"\n \1 \2", text[begin:])
    output = ""
    for line in joined.splitlines():
        if found := OUTPUT.match(line):
            output = found[1]
        elif (found := PIECE.match(line)) and output in IN_FLASH | IN_RAM:
            yield output, int(found[2], 16), found[3]


def part(name):
    """The part of the image that an object belongs to: (group, name in it)."""
    if "libgcc" in name:
        return "libgcc", re.sub(r".*\((.*)\)", r"\1", name)
    if name.startswith("components/"):
        return "component", pathlib.PurePath(name).stem
    if name.startswith("baked/"):
        return "tables", "tables"
    path = re.sub(r"^kernel/|/\d+\.o$", "", name)
    return ("firmware" if path.startswith(("firmware", "platform/")) else "kernel"), path


def table(map_path):
    """{(group, name): [flash bytes, RAM bytes]}"""
    sizes = collections.defaultdict(lambda: [0, 0])
    for output, size, name in pieces(map_path.read_text()):
        entry = sizes[part(name)]
        entry[0] += size if output in IN_FLASH else 0
        entry[1] += size if output in IN_RAM else 0
    return sizes


def totals(sizes):
    groups = collections.defaultdict(lambda: [0, 0])
    for (group, _), (flash, ram) in sizes.items():
        groups[group][0] += flash
        groups[group][1] += ram
    return groups


def text(sizes, detail=False):
    """Lines for the user, the largest part first."""
    lines = [f"   {'part':<44} {'flash':>8} {'RAM':>8}"]
    groups = sorted(totals(sizes).items(), key=lambda each: -each[1][0])
    for group, (flash, ram) in groups:
        lines.append(f"   {group:<44} {flash:>8,} {ram:>8,}")
        if group == "component" or detail:
            inside = sorted(((name, size) for (its, name), size in sizes.items() if its == group and any(size)),
                            key=lambda each: -each[1][0])
            lines += [f"     {name:<42} {flash:>8,} {ram:>8,}" for name, (flash, ram) in inside]
    lines.append(f"   {'all':<44} {sum(g[1][0] for g in groups):>8,} {sum(g[1][1] for g in groups):>8,}")
    return lines


def complaints(image):
    """What the image has and must not have: code before main, an allocator, exceptions, objects of a C library."""
    sections = subprocess.run(["arm-none-eabi-size", "-A", str(image)], capture_output=True, text=True, check=True)
    for line in sections.stdout.splitlines():
        words = line.split()
        if words and re.match(r"\.(preinit_array|init_array|ctors)", words[0]) and words[1] != "0":
            yield f"{image}: has {words[1]} bytes of {words[0]}: a static object is constructed before main"
    symbols = subprocess.run(["arm-none-eabi-nm", str(image)], capture_output=True, text=True, check=True)
    for line in symbols.stdout.splitlines():
        name = line.split()[-1]
        if FOREIGN.match(name):
            yield f"{image}: has the symbol {name}, which needs an allocator, exceptions or a C library"
    for _, _, name in pieces(pathlib.Path(f"{image}.map").read_text()):
        if ".a(" in name and "libgcc.a(" not in name:
            yield f"{image}: links {name}; only libgcc may be linked"


def main():
    image = pathlib.Path(sys.argv[1])
    print("\n".join(text(table(pathlib.Path(f"{image}.map")), detail=True)))
    found = list(complaints(image))
    print("\n".join(found) or "no code before main, no allocator, no foreign symbol")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
