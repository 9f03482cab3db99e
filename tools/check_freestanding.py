# SPDX-License-Identifier: Apache-2.0
"""Floors 0, 2, 3 and 4 build freestanding and without exceptions or RTTI, and ask for no heap, stream, thread or file.
Their hosted halves lie in subfolders (base/hosted), which a microcontroller replaces."""
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent / "check"))
import sources  # noqa: E402

FLOORS = ("base", "table", "task", "schedule")
SOURCE = re.compile(rf"chimera/({'|'.join(FLOORS)})/[^/]+(?<!_test)(?<!_stress)(?<!_fuzz)\.cc$")
COMPILE = ("g++", "-std=c++20", "-O1", "-ffreestanding", "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics")
# All that an object may ask of the outside: our own names, and what every C library for microcontrollers has.
OURS = re.compile(r"_ZN[KVR]*7chimera|_ZT[VSI]N7chimera|chimera_|_GLOBAL_OFFSET_TABLE_$|__cxa_pure_virtual$")
C_MEMORY = {"memcpy", "memmove", "memset", "memcmp", "memchr", "strlen", "strcmp", "strncmp"}
# std::string_view and std::span out of range: ends the program, never in a cycle.
ENDING = re.compile(r"_ZSt\d+__throw_\w+|abort$|_ZSt21__glibcxx_assert_failPKciS0_S0_$")


def undefined_symbols(root, name, folder):
    """(symbols the object asks for, what the compiler said)"""
    target = pathlib.Path(folder, name.replace("/", "_") + ".o")
    command = [*COMPILE, "-I", str(root), "-c", str(root / name), "-o", str(target)]
    compiled = subprocess.run(command, capture_output=True, text=True, env=dict(os.environ, LC_ALL="C"))
    if compiled.returncode != 0:
        return [], compiled.stderr
    listing = subprocess.run(["nm", "-u", "--format=posix", str(target)], capture_output=True, text=True, check=True)
    return [line.split()[0] for line in listing.stdout.splitlines() if line.strip()], ""


def complaints_about(root, name, folder):
    symbols, said = undefined_symbols(root, name, folder)
    if said:
        error = next((line for line in said.splitlines() if "error:" in line), said.splitlines()[0])
        return [f"{name}: does not compile freestanding: {error.split('error: ', 1)[-1]}"]
    return [f"{name}: asks for {symbol}" for symbol in symbols
            if not (OURS.match(symbol) or ENDING.match(symbol) or symbol in C_MEMORY)]


def check(root):
    names = [name for name in sources.files(root) if SOURCE.match(name)]
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        for complaints in pool.map(lambda name: complaints_about(root, name, folder), names):
            yield from complaints


_NAME = "chimera/table/x.cc"
PLANTED = (
    ({_NAME: "#include <cstring>\nnamespace chimera { void f(char* a, int n) { std::memset(a, n, n); } }\n"}, None),
    ({"chimera/text/x.cc": "#include <string>\nstd::string s(100, 'x');\n"}, None),
    ({"chimera/table/x_test.cc": "int* p = new int;\n"}, None),
    ({_NAME: "int* f() { return new int; }\n"}, f"{_NAME}: asks for _Znwm"),
    ({_NAME: "#include <cstdlib>\nvoid* f() { return std::malloc(8); }\n"}, f"{_NAME}: asks for malloc"),
    ({_NAME: "#include <cstdio>\nvoid f(int n) { std::printf(\"%d\", n); }\n"}, f"{_NAME}: asks for printf"),
    ({_NAME: "#include <pthread.h>\nvoid f(pthread_mutex_t* m) { pthread_mutex_lock(m); }\n"},
     f"{_NAME}: asks for pthread_mutex_lock"),
    ({_NAME: "void f() { throw 1; }\n"},
     f"{_NAME}: does not compile freestanding: exception handling disabled, use '-fexceptions' to enable"),
)

if __name__ == "__main__":
    sources.run(check, PLANTED)
