# SPDX-License-Identifier: Apache-2.0
"""Runs the lessons: every `$ chimera ...` line of examples/*/expected.txt in its folder, and compares what it prints.

A line `...` stands for any lines; `[exit 1]` after the output states an exit code other than 0. Only commands in
virtual time and commands on files have a text that can be compared; lessons in real time are shown in the README of
their folder. The commands see only the subsystems in a folder of sockets of their own, not those of other tests. With
--write the files are brought up to date, to be looked at before they are committed.
"""
import argparse
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile


def commands(path):
    """(command, expected lines) of one file, in order."""
    found = []
    for line in path.read_text().splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        elif found:
            found[-1][1].append(line)
    return found


def run(command, folder, program, sockets):
    words = shlex.split(command)
    if words[0] != "chimera":
        raise SystemExit(f"{folder}: only `chimera` is run here: {command}")
    done = subprocess.run([program, *words[1:]], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          env={**os.environ, "XDG_RUNTIME_DIR": sockets, "ASAN_OPTIONS": "detect_leaks=0"})
    lines = (done.stdout + done.stderr).splitlines()
    return lines + ([f"[exit {done.returncode}]"] if done.returncode else [])


def matches(expected, found):
    pattern = "".join("(?:.*\n)*" if line == "..." else re.escape(line) + "\n" for line in expected)
    return re.fullmatch(pattern, "".join(line + "\n" for line in found)) is not None


def write(path, results):
    text = ""
    for command, expected, found in results:
        keep = expected if "..." in expected and matches(expected, found) else found
        text += f"$ {command}\n" + "".join(line + "\n" for line in keep)
    path.write_text(text)


def self_test():
    assert matches(["a", "...", "d"], ["a", "b", "c", "d"]) and matches(["a", "...", "d"], ["a", "d"])
    assert not matches(["a"], ["a", "b"]) and not matches(["a", "..."], ["b"])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True)
    parser.add_argument("--examples", required=True, type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    options.program = os.path.abspath(options.program)
    self_test()
    failed = passed = 0
    folders = sorted(folder for folder in options.examples.iterdir() if folder.is_dir())
    for folder in folders:
        path = folder / "expected.txt"
        if not path.is_file():
            print(f"{folder.name}: has no expected.txt")
            failed += 1
            continue
        with tempfile.TemporaryDirectory() as sockets:
            results = [(c, e, run(c, folder, options.program, sockets)) for c, e in commands(path)]
        if options.write:
            write(path, results)
        for command, expected, found in results:
            if options.write or matches(expected, found):
                passed += 1
                continue
            failed += 1
            print("\n".join([f"{folder.name}: $ {command}", "--- expected", *expected, "--- found", *found]))
    print(f"{passed} commands as shown, {failed} not")
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
