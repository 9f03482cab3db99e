# SPDX-License-Identifier: Apache-2.0
"""Compiles and links an image from a folder that `chimera bake` made: rules for ninja, and what its errors mean.
usage: build.py BAKED OUT [COMPONENT_FOLDER ...]   (OUT/image.elf; component folders beside library/)"""
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("base", "platform/bare", "table", "task", "schedule", "runtime", "runtime/record", "runtime/job",
           "runtime/plan", "runtime/state", "runtime/life", "runtime/switch", "runtime/cycle", "runtime/executive",
           "runtime/link")
FIRMWARE = ("firmware", "firmware/boot", "firmware/boards", "firmware/link", "firmware/shell", "firmware/watch")
TOGETHER = 8
NO_PRODUCT = re.compile(r"_(test|stress|fuzz)\.cc$")
# Analyses of the desk; an image carries their results.
DESK = {"schedule/" + name for name in ("analysis.cc", "level.cc", "worst_window.cc", "response.cc", "data_age.cc",
                                        "transition.cc", "change_window.cc")}
COMMON = ("-Os -ffreestanding -ffp-contract=off -fsigned-char -ffunction-sections -fdata-sections -g1 "
          "-DCHIMERA_BARE -Wall -Wextra -Werror -Wno-psabi "
          "-Wno-nonnull "  # what an image lacks is null
          "-Wno-missing-field-initializers")  # tables name what differs from the default
CXX = ("-std=c++20 -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-asynchronous-unwind-tables "
       "-fno-unwind-tables")
# QEMU's machine of each board that it simulates. It has none with a Cortex-M0+; a Cortex-M3 has all its instructions.
SIMULATED = {"mps2": {"cortex-m0plus": "mps2-an385", "cortex-m3": "mps2-an385", "cortex-m4": "mps2-an386"},
             "stm32vldiscovery": {"cortex-m3": "stm32vldiscovery"}}


PACKAGES = {"arm-none-eabi-g++": "gcc-arm-none-eabi libstdc++-arm-none-eabi-dev libnewlib-dev", "ninja": "ninja-build"}


class BuildError(Exception):
    """What the user reads."""


def sources_of_kernel(firmware):
    """(name, files) of what is compiled as one: eight files of a folder at most, because headers take the time."""
    for folder in (*(f"chimera/{each}" for each in FOLDERS), *firmware):
        files = [path for path in sorted((ROOT / folder).glob("*.cc"))
                 if not NO_PRODUCT.search(path.name) and f"{folder.removeprefix('chimera/')}/{path.name}" not in DESK]
        for i in range(0, len(files), TOGETHER):
            yield f"{folder.removeprefix('chimera/')}/{i // TOGETHER}", files[i:i + TOGETHER]


def source_of_component(name, folders):
    """The file with that component; None: no folder has it, so the link names it."""
    for folder in (*folders, ROOT / "library"):
        for path in (folder / name / f"{name}.cc", folder / name / f"{name}.c", folder / f"{name}.cc",
                     folder / f"{name}.c"):
            if path.is_file():
                return path
    return None


def need(*programs):
    """Raises BuildError if one of PACKAGES is not installed."""
    missing = [program for program in programs if shutil.which(program) is None]
    if missing:
        raise BuildError(f"{' and '.join(missing)}: not installed. On Debian or Ubuntu: sudo apt install "
                         f"--no-install-recommends {' '.join(PACKAGES[program] for program in missing)}")


def quoted(text):
    """One word of a command of ninja."""
    return shlex.quote(text).replace("$", "$$")


def word(path):
    return str(path).replace("$", "$$").replace(" ", "$ ").replace(":", "$:")


def write_if_new(path, text):
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def rules(baked, out, board, folders, program):
    """The text of build.ninja, and the components without a source. `program` as of build()."""
    cache = shutil.which("ccache") or ""
    flags = quoted(f"@{baked}/cpu.flags")
    common = (f"{flags} {COMMON} {quoted(f'-ffile-prefix-map={ROOT}/=')} {quoted(f'-I{ROOT}')} {quoted(f'-I{baked}')} "
              f"-DCHIMERA_MECHANISMS='<mechanisms.h>' "
              f"-DCHIMERA_BOARD='\"firmware/boards/{board}/chip.h\"'"
              + (" -DCHIMERA_SIMULATED" if board in SIMULATED else ""))
    text = [f"rule cxx\n  command = {cache} arm-none-eabi-g++ {CXX} {common} $more -MD -MF $out.d -c $in -o $out",
            "  depfile = $out.d\n  deps = gcc\n  description = $in",
            f"rule cc\n  command = {cache} arm-none-eabi-gcc -std=c11 {common} -MD -MF $out.d -c $in -o $out",
            "  depfile = $out.d\n  deps = gcc\n  description = $in",
            f"rule link\n  command = arm-none-eabi-g++ {flags} -nostdlib -nostartfiles -Wl,--gc-sections "
            f"{quoted(f'-L{baked}')} -T {quoted(f'{ROOT}/firmware/boards/image.ld')} -Wl,-Map,$out.map -o $out "
            "@$out.rsp -lgcc",
            "  rspfile = $out.rsp\n  rspfile_content = $in_newline\n  description = link $out"]
    objects, missing = [], []

    def compiled(path, target, flags=""):
        text.append(f"build {word(target)}: {'cc' if path.suffix == '.c' else 'cxx'} {word(path)}")
        if target.startswith("kernel/firmware/boot/"):  # else memcpy would become a call of itself
            flags = "-fno-tree-loop-distribute-patterns"
        if flags:
            text.append(f"  more = {flags}")
        objects.append(word(target))

    for name, files in sources_of_kernel(FIRMWARE if program is None else FIRMWARE[1:]):
        together = out / "together" / f"{name}.cc"
        together.parent.mkdir(parents=True, exist_ok=True)
        write_if_new(together, "".join(f'#include "{path.relative_to(ROOT)}"\n' for path in files))
        compiled(together, f"kernel/{name}.o")
    for name in (baked / "components.txt").read_text().split():
        path = source_of_component(name, folders)
        compiled(path, f"components/{name}.o") if path else missing.append(name)
    for path, flags in program or ():
        compiled(path, f"program/{path.stem}.o", flags)
    text.append(f"build baked/tables.cc.o: cxx {word(baked / 'tables.cc')}")
    objects.append("baked/tables.cc.o")
    text.append(f"build image.elf: link {' '.join(objects)} | {word(ROOT / 'firmware/boards/image.ld')} "
                f"{word(baked / 'memory.ld')}")
    return "\n".join(text) + "\n", missing


def explained(log, missing):
    """The output of a failed build in the words of who wrote the application."""
    for name in re.findall(r"undefined reference to `chimera_component_(\w+)'", log):
        where = "no folder of components has it" if name in missing else "its source offers it under another name"
        return f"component {name}: {where}; looked for {name}/{name}.cc and {name}.c in library and in --components"
    foreign = sorted(set(re.findall(r"undefined reference to `([^']+)'", log)))
    if foreign:
        places = sorted(set(re.findall(r"^.*?([\w./-]+\.o): in function", log, re.MULTILINE)))
        return (f"the image asks for what a microcontroller does not have: {', '.join(foreign)}\n"
                f"  in {', '.join(places)}\n  such a component can run on Linux only")
    full = re.findall(r"region `(\w+)' overflowed by (\d+) bytes", log)
    if full:
        return "; ".join(f"{region} of the target is too small by {n} bytes" for region, n in full)
    failed = log.find("FAILED: ")
    return "\n".join(line for line in log[max(failed, 0):].splitlines() if not line.startswith("["))[:6000]


def build(baked, out, board, folders=(), program=None):
    """OUT/image.elf, up to date. `program`: (file, flags) in place of the sources in firmware/. Raises BuildError."""
    need("arm-none-eabi-g++", "ninja")
    out = out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    text, missing = rules(baked.resolve(), out, board, folders, program)
    write_if_new(out / "build.ninja", text)
    done = subprocess.run(["ninja", "-C", str(out)], stdin=subprocess.DEVNULL, capture_output=True, text=True)
    (out / "build.log").write_text(done.stdout + done.stderr)
    if done.returncode != 0:
        raise BuildError(explained(done.stdout + done.stderr, missing))
    return out / "image.elf"


def main():
    baked, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    board = re.search(r'\.board = "([\w-]+)"', (baked / "tables.cc").read_text())[1]
    try:
        print(build(baked, out, board, [pathlib.Path(each) for each in sys.argv[3:]]))
    except BuildError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
