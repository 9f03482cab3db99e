# SPDX-License-Identifier: Apache-2.0
"""Every source in cases.txt must fail to compile with the sentence behind its name. The same for each misspelling
listed in chimera/task/method_check.h. A control that compiles shows that the compiler works at all.

In cases.txt a source is indented. Lines of a class only are members of `Bad`, which has a method cycle() then; a C++
source without an include of its own framework header gets one, and is made a component."""
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import textwrap

FOLDER = pathlib.Path(__file__).resolve().parent
ROOT = FOLDER.parents[1]
FLAGS = {".cc": ["g++", "-std=c++20"], ".c": ["gcc", "-std=c99", "-Werror=missing-prototypes"]}
HEADER = "chimera/task/component.h"
FACE = """#include "chimera/task/component.h"
using namespace chimera;
%sCHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
"""
CONTROL = """#include "chimera/task/component.h"
using namespace chimera;
struct Good {
  void init() {} void reinit() {} void on() {} void cycle() {} bool sync() { return true; } void off() {}
  void kill() {} bool error() { return true; } bool clear() { return true; }
%s};
CHIMERA_COMPONENT(Good, "good", "Compiles.");
"""


def precompile(folder):
    """The header of all C++ files here, where the compiler looks for it first."""
    made = pathlib.Path(folder) / f"{HEADER}.gch"
    made.parent.mkdir(parents=True)
    subprocess.run([*FLAGS[".cc"], "-w", f"-I{ROOT}", "-x", "c++-header", str(ROOT / HEADER), "-o", str(made)],
                   check=True)
    FLAGS[".cc"].append(f"-I{folder}")


def compile_text(path):
    command = FLAGS[path.suffix] + ["-fsyntax-only", "-fdiagnostics-color=never", f"-I{ROOT}", str(path)]
    made = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"}, check=False)
    return made.returncode, made.stderr


def judge(path, sentence):
    """'' when the file is refused with the sentence, else what happened."""
    code, said = compile_text(path)
    if sentence is None:
        return "" if code == 0 else f"{path.name}: does not compile:\n{said}"
    if code == 0:
        return f"{path.name}: compiles, expected: {sentence}"
    if sentence not in said:  # a sentence of `throw` stands in the line that the compiler quotes
        errors = [line for line in said.splitlines() if "error: " in line]
        return f"{path.name}: expected: {sentence}\nfound:\n" + "\n".join(errors)
    return ""


def cases(folder):
    for case in (FOLDER / "cases.txt").read_text().split("\n\n"):
        head, body = case.split("\n", 1)
        name, sentence = head.split(": ", 1)
        source = textwrap.dedent(body) + "\n"
        if "chimera/task/" not in source:
            source = FACE % (source if " Bad " in source else f"struct Bad {{\n{source}void cycle() {{}}\n}};\n")
        path = pathlib.Path(folder) / name
        path.write_text(source)
        yield path, sentence


def misspellings():
    header = (ROOT / "chimera/task/method_check.h").read_text()
    listed = header.split("#define CHIMERA_FACE_MISSPELLINGS(X)")[1].split("\n\n")[0]
    return re.findall(r"X\((\w+), (\w+)\)", listed)


def guide(folder):
    """The whole sources in the guide for authors: they must compile as written."""
    text = (ROOT / "docs/howto/write-a-component.md").read_text()
    blocks = re.findall(r"```(cpp|c)\n(#include \"chimera/task/(?:component|pbo)\.h\".*?)```", text, re.DOTALL)
    if len(blocks) < 2:
        sys.exit("the guide has no sources any more")
    for i, (language, source) in enumerate(blocks):
        path = pathlib.Path(folder) / f"guide_{i}.{'cc' if language == 'cpp' else 'c'}"
        path.write_text(source)
        yield path, None


def main():
    work = []
    with tempfile.TemporaryDirectory() as folder:
        precompile(folder)
        control = pathlib.Path(folder) / "control.cc"
        control.write_text(CONTROL % "")
        work.append((control, None))
        work += guide(folder)
        refused = list(cases(folder))
        work += refused
        # All misspellings in one class: the compiler names each of them.
        words = misspellings()
        all_of_them = pathlib.Path(folder) / "misspelt.cc"
        all_of_them.write_text(CONTROL % "".join(f"  void {word}() {{}}\n" for word, _ in words))
        _, said = compile_text(all_of_them)
        missing = [f"'{word}': did you mean '{meant}'?" for word, meant in words
                   if f"the component has a method '{word}': did you mean '{meant}'? The methods are init reinit on "
                      "cycle sync off kill error clear" not in said]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            wrong = [line for line in pool.map(lambda one: judge(*one), work) if line] + missing
    print("\n".join(wrong) if wrong else f"{len(refused)} refusals and {len(words)} misspellings as written")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
