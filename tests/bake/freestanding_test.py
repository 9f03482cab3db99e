# SPDX-License-Identifier: Apache-2.0
"""Baked tables compile for every core, need no RAM and no code, and a missing component is an undefined symbol.
usage: freestanding_test.py SOURCE FOLDER..."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ARM = "arm-none-eabi-g++"
FLAGS = ("-std=c++20", "-Os", "-mthumb", "-ffreestanding", "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics",
         "-ffp-contract=off", "-fsigned-char", "-ffunction-sections", "-fdata-sections", "-DCHIMERA_BARE", "-Wall",
         "-Wextra", "-Wno-missing-field-initializers", "-Werror")
CORES = ("cortex-m0plus", "cortex-m3", "cortex-m4")
NOT_CONSTANT = re.compile(r"\.(data(?!\.rel\.ro)|bss|init_array|ctors|text)")


def output(*words):
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout


def complaints(source, folder, core, made):
    done = subprocess.run([ARM, f"-mcpu={core}", *FLAGS, "-I", source, "-c", folder / "tables.cc", "-o", made],
                          capture_output=True, text=True)
    if done.returncode != 0:
        return [done.stderr]
    sections = [line.split() for line in output("arm-none-eabi-size", "-A", made).splitlines()]
    found = [f"{line[1]} bytes in {line[0]}" for line in sections
             if len(line) == 3 and NOT_CONSTANT.match(line[0]) and line[1] != "0"]
    asked = {line.split()[0] for line in output("arm-none-eabi-nm", "-u", "--format=posix", made).splitlines()}
    names = {"chimera_component_" + name for name in (folder / "components.txt").read_text().split()}
    if asked != names:
        found.append(f"asks for {sorted(asked ^ names)}")
    return found


def main():
    if not shutil.which(ARM):
        print(f"{ARM} is not installed")
        return 77
    found = []
    with tempfile.TemporaryDirectory() as scratch:
        for folder in map(pathlib.Path, sys.argv[2:]):
            for core in CORES:
                found += [f"{folder.name}, {core}: {each}"
                          for each in complaints(sys.argv[1], folder, core, pathlib.Path(scratch, "tables.o"))]
    print("\n".join(found) or f"{len(sys.argv) - 2} applications on {len(CORES)} cores: constant")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
