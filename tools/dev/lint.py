# SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy on the given files, with the compile commands of the debug tree put into words clang understands."""
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys

import common

# g++'s precompiled headers and options mean nothing to clang.
FOREIGN = re.compile(r" -include \S+cmake_pch\.hxx| -(Winvalid-pch|fpch-preprocess|fno-gnu-unique|Werror)\b")
LAUNCHER = re.compile(r"^.*?(?=\S*/(c\+\+|g\+\+|cc|gcc)\s)")


def alone(entry):
    """The entries of what `entry` compiles: several files when its own only includes others."""
    if "/together/" not in entry["file"]:
        return [entry]
    together = pathlib.Path(entry["file"]).read_text()
    files = [str(common.ROOT / file) for file in re.findall(r'^#include "([^"]+)"', together, re.MULTILINE)]
    return [{"directory": entry["directory"], "file": file, "command": entry["command"].replace(entry["file"], file)}
            for file in files]


def commands():
    """Writes the translated compile commands; returns their folder and the files they cover."""
    folder = common.BUILD / "lint"
    folder.mkdir(parents=True, exist_ok=True)
    listed = json.loads((common.BUILD / "debug" / "compile_commands.json").read_text())
    entries = [single for entry in listed for single in alone(entry)]
    for entry in entries:
        entry["command"] = FOREIGN.sub("", LAUNCHER.sub("", entry["command"])) + " -Wno-invalid-constexpr"
    (folder / "compile_commands.json").write_text(json.dumps(entries))
    return folder, {os.path.relpath(entry["file"], common.ROOT) for entry in entries}


def tidy(folder, name):
    done = subprocess.run(["clang-tidy", "--quiet", "-p", str(folder), "--warnings-as-errors=*", name], cwd=common.ROOT,
                          stdin=subprocess.DEVNULL, capture_output=True, text=True)
    return done.returncode, done.stdout


def main(names):
    folder, known = commands()
    names = [name for name in names if name in known]
    common.step(f"clang-tidy on {len(names)} files")
    wrong = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for code, said in pool.map(lambda name: tidy(folder, name), names):
            wrong += code != 0
            print(said, end="", flush=True)
    common.step(f"{wrong} files with complaints" if wrong else "nothing to complain about")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
