# SPDX-License-Identifier: Apache-2.0
"""Floors 0, 2, 3 and 4, the runtime without its folders hosted, preemptive and virtual, shell and watch of firmware/,
and components build freestanding for x86-64 and for a 32-bit microcontroller (ARM Cortex-M3), without exceptions or
RTTI, and ask for no heap, stream, thread or file. Components are one constant table, chimera_component_NAME: no byte of
RAM, no constructor. Components in C need no C library either. The hosted halves of these floors lie in subfolders
(base/hosted, runtime/hosted), which a microcontroller replaces, and which the other half does not include."""
import concurrent.futures
import itertools
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent / "check"))
import sources  # noqa: E402

FOLDERS = ("base", "table", "task", "schedule", "runtime", "runtime/record", "runtime/job", "runtime/plan",
           "runtime/state", "runtime/life", "runtime/switch", "runtime/cycle", "runtime/executive", "runtime/link")
FILE = re.compile(rf"(chimera/({'|'.join(FOLDERS)})|firmware/(shell|watch|link))/[^/]+"
                  r"(?<!_test)(?<!_stress)(?<!_fuzz)\.(h|cc)$")
HOSTED = re.compile(r'^[ \t]*#[ \t]*include[ \t]*"(chimera/\w+/hosted/[^"]+)"', re.MULTILINE)
# Components that a microcontroller may take; the first three are compiled for x86-64, too.
TAKEN = ("gain pid_joint tderiv accel brake car ccui control dashboard deadband display_manager engine join_mean "
         "join_priority joint_trajectory limit lowpass motor notch position rate_limit select servo_axis "
         "signal_generator split_pm split_pm_override unit_convert watchdog wheels")
COMPONENTS = tuple(f"library/{name}/{name}.cc" for name in TAKEN.split())
IN_C = tuple(f"tests/components/t_{name}.c" for name in ("paper", "parts", "tderiv", "limit", "pid_joint"))
FREESTANDING = ("-std=c++20", "-ffreestanding", "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics",
                "-DCHIMERA_BARE")
ARM = "arm-none-eabi-g++"
MACHINES = {"x86-64": ("g++", "-O1", *FREESTANDING),
            "ARM": (ARM, "-Os", "-mcpu=cortex-m3", "-mthumb", *FREESTANDING)}
FREESTANDING_C = ("-std=c11", "-ffreestanding", "-DCHIMERA_BARE", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
MACHINES_C = {"x86-64": ("gcc", "-O1", *FREESTANDING_C),
              "ARM": ("arm-none-eabi-gcc", "-Os", "-mcpu=cortex-m3", "-mthumb", *FREESTANDING_C)}
IN_RAM = re.compile(r"\.(data(?!\.rel\.ro)|bss|init_array|ctors)")
# All that an object may ask of the outside: our own names, and what every C library for microcontrollers has.
OURS = re.compile(r"_ZN[KVR]*7chimera|_ZT[VSI]N7chimera|chimera_|_GLOBAL_OFFSET_TABLE_$|__cxa_pure_virtual$")
C_MEMORY = {"memcpy", "memmove", "memset", "memcmp", "memchr", "strlen", "strcmp", "strncmp", "strcpy", "strncpy"}
# What a processor does not do itself: arithmetic of double and of 64 bits, and 64-bit atomics of a single context.
ARITHMETIC = re.compile(r"__aeabi_(?!read_tp)\w+$|__atomic_(load|store|exchange|compare_exchange)_8$|__popcountdi2$")
# std::string_view and std::span out of range: ends the program, never in a cycle.
ENDING = re.compile(r"_ZSt\d+__throw_\w+|abort$|_ZSt21__glibcxx_assert_failPKciS0_S0_$")


def is_known(symbol):
    return OURS.match(symbol) or ENDING.match(symbol) or ARITHMETIC.match(symbol) or symbol in C_MEMORY


def undefined_symbols(root, source, machine):
    """(symbols the object asks for, what the compiler said)"""
    target = source.with_suffix(".o")
    compiler = MACHINES_C if source.suffix == ".c" else MACHINES
    command = [*compiler[machine], "-I", str(root), "-c", str(source), "-o", str(target)]
    compiled = subprocess.run(command, capture_output=True, text=True, env=dict(os.environ, LC_ALL="C"))
    if compiled.returncode != 0:
        return [], compiled.stderr
    listing = subprocess.run(["nm", "-u", "--format=posix", str(target)], capture_output=True, text=True, check=True)
    symbols = [line.split() for line in listing.stdout.splitlines() if line.strip()]
    return [name for name, kind in symbols if kind != "w" or source.suffix != ".c"], ""


def sections_in_ram(source):
    """Of the object of `source`: what lies in RAM or runs before main."""
    listing = subprocess.run(["size", "-A", str(source.with_suffix(".o"))], capture_output=True, text=True, check=True)
    sections = [line.split() for line in listing.stdout.splitlines()]
    return [name for name, size, _ in (line for line in sections if len(line) == 3)
            if IN_RAM.match(name) and size != "0"]


def tables(source):
    """Of the object of `source`: the components that tables of an image can name."""
    listing = subprocess.run(["nm", "-g", "--defined-only", "--format=posix", str(source.with_suffix(".o"))],
                             capture_output=True, text=True, check=True)
    return [line.split()[0] for line in listing.stdout.splitlines() if line.startswith("chimera_component_")]


def is_component(name):
    return name.endswith(".c") or name in COMPONENTS


def complaints_about_table(name, source, machine):
    """Of a component that was compiled."""
    table = f"chimera_component_{pathlib.Path(name).stem}"
    if tables(source) != [table]:
        yield f"{name}: defines {' '.join(tables(source)) or 'no component'} on {machine}, but not {table} alone"
    for section in sections_in_ram(source):
        yield f"{name}: has {section} on {machine}, but its tables must be constant"


def complaints_about(root, names, machine, folder):
    """Of files that are compiled together, which is faster. Should there be any, each alone says which it is."""
    name = names[0]
    source = pathlib.Path(folder, f"{machine}_{len(names)}_{name.replace('/', '_')}")
    source.write_text("".join(f'#include "{one}"\n' for one in names), encoding="utf-8")
    symbols, said = undefined_symbols(root, source, machine)
    if len(names) > 1 and (said or not all(map(is_known, symbols))):
        return [complaint for one in names for complaint in complaints_about(root, [one], machine, folder)]
    if said:
        error = next((line for line in said.splitlines() if "error:" in line), said.splitlines()[0])
        return [f"{name}: does not compile freestanding for {machine}: {error.split('error: ', 1)[-1]}"]
    return [*(f"{name}: asks for {symbol} on {machine}" for symbol in symbols if not is_known(symbol)),
            *(complaints_about_table(name, source, machine) if is_component(name) else ())]


def check(root, machine):
    there = list(sources.files(root))
    for name in filter(FILE.match, there):
        yield from (f"{name}: includes {path}, which a microcontroller does not have"
                    for path in HOSTED.findall(sources.text(root, name)))
    components = (*(COMPONENTS if machine == "ARM" else COMPONENTS[:3]), *IN_C)
    names = [name for name in there if (FILE.match(name) and name.endswith(".cc")) or name in components]
    if "CONTRIBUTING.md" in there:  # not of a planted tree
        yield from (f"{name}: is not there, but tools/check_freestanding.py lists it"
                    for name in components if name not in names)
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        for complaints in pool.map(lambda some: complaints_about(root, some, machine, folder), together(names)):
            yield from complaints


def together(names):
    """Lists of up to eight files of one folder. A component stands alone: its object holds one table."""
    for _, some in itertools.groupby(names, lambda name: name if is_component(name) else os.path.dirname(name)):
        some = list(some)
        yield from (some[i:i + 8] for i in range(0, len(some), 8))


_NAME = "chimera/table/x.cc"
_HOSTED = "chimera/runtime/hosted/y.h"
_PRINTF = "#include <cstdio>\nvoid f(int n) { std::printf(\"%d\", n); }\n"
_C = "const int chimera_component_t_paper = 1;\nint later(void) __attribute__((weak));\n"
_TABLE = 'extern "C" const int chimera_component_gain = 1;\n'
_MUTEX = {_NAME: "#include <mutex>\nstd::mutex m;\n"}


def planted(machine):
    def asks(symbol, name=_NAME):
        return f"{name}: asks for {symbol} on {machine}"

    yield {_NAME: "#include <cstring>\nnamespace chimera { void f(char* a, int n) { std::memset(a, n, n); } }\n"}, None
    yield {_NAME: "double f(double a, long long b) { return a / static_cast<double>(b); }\n"}, None
    yield {"chimera/text/x.cc": "#include <string>\nstd::string s(100, 'x');\n"}, None
    yield {"chimera/table/x_test.cc": "int* p = new int;\n"}, None
    yield {"chimera/runtime/hosted/x.cc": _MUTEX[_NAME]}, None
    yield {"chimera/runtime/x.cc": _PRINTF}, asks("printf", "chimera/runtime/x.cc")
    yield {"firmware/shell/x.cc": _PRINTF}, asks("printf", "firmware/shell/x.cc")
    yield ({"chimera/runtime/executive/x.h": f'#include "{_HOSTED}"\n', _HOSTED: ""},
           f"chimera/runtime/executive/x.h: includes {_HOSTED}, which a microcontroller does not have")
    yield {"chimera/runtime/x_test.cc": f'#include "{_HOSTED}"\n', _HOSTED: ""}, None
    new = "_Znwj" if machine == "ARM" else "_Znwm"
    yield {COMPONENTS[0]: _TABLE}, None
    yield {COMPONENTS[0]: _TABLE + "int* f() { return new int; }\n"}, asks(new, COMPONENTS[0])
    yield ({COMPONENTS[0]: _TABLE + "int n;\n"},
           f"{COMPONENTS[0]}: has .bss on {machine}, but its tables must be constant")
    yield ({COMPONENTS[0]: _TABLE + "[[gnu::constructor]] static void f() { asm volatile(\"\"); }\n"},
           f"{COMPONENTS[0]}: has .init_array on {machine}, but its tables must be constant")
    yield ({COMPONENTS[0]: _TABLE.replace("gain", "grain")},
           f"{COMPONENTS[0]}: defines chimera_component_grain on {machine}, but not chimera_component_gain alone")
    yield {_NAME: "int* f() { return new int; }\n"}, asks(new)
    yield {_NAME: "#include <cstdlib>\nvoid* f() { return std::malloc(8); }\n"}, asks("malloc")
    yield {_NAME: _PRINTF}, asks("printf")
    yield {_NAME: "extern int g();\nint f() { return g(); }\n"}, asks("_Z1gv")
    yield ({_NAME: "void f() { throw 1; }\n"},
           f"{_NAME}: does not compile freestanding for {machine}: "
           "exception handling disabled, use '-fexceptions' to enable")
    yield {IN_C[0]: _C}, None
    yield ({IN_C[0]: _C + "int count = 1;\n"}, f"{IN_C[0]}: has .data on {machine}, but its tables must be constant")
    if machine == "x86-64":
        others = {name: _TABLE.replace("gain", pathlib.Path(name).stem) for name in COMPONENTS[1:3]}
        others |= {name: _C.replace("t_paper", pathlib.Path(name).stem) for name in IN_C}
        yield ({"CONTRIBUTING.md": "", **others},
               f"{COMPONENTS[0]}: is not there, but tools/check_freestanding.py lists it")
        yield ({_NAME: "#include <pthread.h>\nvoid f(pthread_mutex_t* m) { pthread_mutex_lock(m); }\n"},
               asks("pthread_mutex_lock"))
    if machine == "ARM":
        yield (_MUTEX, f"{_NAME}: does not compile freestanding for ARM: "
                       "'mutex' in namespace 'std' does not name a type")
        yield {_NAME: "static_assert(sizeof(void*) == 4);\n"}, None


def main():
    code = 0
    for machine, command in MACHINES.items():
        if shutil.which(command[0]):
            code = code or sources.main(lambda root: check(root, machine), list(planted(machine)))  # noqa: B023
        elif code == 0:
            print(f"skipped: {command[0]} is not installed, so nothing is known of {machine}")
            code = 77
    return code


if __name__ == "__main__":
    sys.exit(main())
