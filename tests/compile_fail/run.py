# SPDX-License-Identifier: Apache-2.0
"""Every source in cases.txt must fail to compile with the sentence behind its name. The same for each misspelling
listed in chimera/task/method_check.h. A control that compiles shows that the compiler works at all.

In cases.txt a source is indented. Lines of a class only are members of `Bad`, which has a method cycle() then; a C++
source without an include of its own framework header gets one, and is made a component. A C source without one is
ports, structs and functions of the module `ball`. clang refuses the same C sources, where it is installed.

The sources of the papers, tball.c and car.c, compile, and are those of the papers but for the lines in the table of
docs/howto/component-in-c.md."""
import concurrent.futures
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap

FOLDER = pathlib.Path(__file__).resolve().parent
ROOT = FOLDER.parents[1]
FLAGS = {".cc": ["g++", "-std=c++20"], ".c": ["gcc", "-std=c11", "-Werror=missing-prototypes"]}
CLANG = ["clang", *FLAGS[".c"][1:]] if shutil.which("clang") else None
HEADER = "chimera/task/component.h"
FACE = """#include "chimera/task/component.h"
using namespace chimera;
%sCHIMERA_COMPONENT(Bad, "bad", "Does not compile.");
"""
FACE_IN_C = """#include "chimera/task/pbo.h"
typedef struct { double last; } ballLocal_t;
%s
PBO_PORTS(ball, %s)
PBO_MODULE(ball, .doc = "Does not compile.");
%s
"""
CYCLE_IN_C = "int ballCycle(ballLocal_t *local) { return PBO_LOCAL(local); }"
PORT_IN_C = '(in_var, x, float64, "", "m")'
# SHA-256 of figures 9 and 8 of the 2000 paper without white space and comments, behind the line that includes pbo.h.
PAPERS = {"tball": "49d152e12adecd14af0a54645e04b096684ee23f5e4f6601e9dc16471be17b92",
          "car": "6209f4226c90adf7b1d352cc4613cd23ce0598222344cbe84480a70c93d031d1"}
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


def compile_text(path, compiler):
    command = [*compiler, "-fsyntax-only", "-fdiagnostics-color=never", f"-I{ROOT}", str(path)]
    made = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"}, check=False)
    return made.returncode, made.stderr


def judge(path, sentence):
    """'' when the file is refused with the sentence, else what happened."""
    code, said = compile_text(path, FLAGS[path.suffix])
    by_clang = compile_text(path, CLANG) if CLANG and path.suffix == ".c" else None
    if sentence is None:
        if code == 0 and by_clang:
            code, said = by_clang
        return "" if code == 0 else f"{path.name}: does not compile:\n{said}"
    if code == 0:
        return f"{path.name}: compiles, expected: {sentence}"
    if sentence not in said:  # a sentence of `throw` stands in the line that the compiler quotes
        errors = [line for line in said.splitlines() if "error: " in line]
        return f"{path.name}: expected: {sentence}\nfound:\n" + "\n".join(errors)
    if by_clang and (by_clang[0] == 0 or (": " in sentence and sentence not in by_clang[1])):
        return f"{path.name}: clang does not say: {sentence}\n{by_clang[1]}"
    return ""


def module_in_c(text):
    """A whole source from ports, structs and functions of the module `ball`."""
    lines = text.strip().splitlines()
    structs = [line for line in lines if line.startswith("PBO_STRUCT")]
    ports = [line for line in lines if line.startswith("(")]
    functions = [line for line in lines if line not in structs and line not in ports]
    if not any("int ballCycle(" in line for line in functions):
        functions.append(CYCLE_IN_C)
    return FACE_IN_C % ("\n".join(structs), "\n".join(ports) or PORT_IN_C, "\n".join(functions))


def cases(folder):
    for case in (FOLDER / "cases.txt").read_text().split("\n\n"):
        head, body = case.split("\n", 1)
        name, sentence = head.split(": ", 1)
        source = textwrap.dedent(body) + "\n"
        if "chimera/task/" not in source and name.endswith(".c"):
            source = module_in_c(source)
        elif "chimera/task/" not in source:
            source = FACE % (source if " Bad " in source else f"struct Bad {{\n{source}void cycle() {{}}\n}};\n")
        path = pathlib.Path(folder) / name
        path.write_text(source)
        yield path, sentence


def misspellings():
    header = (ROOT / "chimera/task/method_check.h").read_text()
    listed = header.split("#define CHIMERA_FACE_MISSPELLINGS(X)")[1].split("\n\n")[0]
    return re.findall(r"X\((\w+), (\w+)\)", listed)


def guide(folder):
    """The whole sources in the guides for authors: they must compile as written."""
    for name, language in (("write-a-component", "cpp"), ("component-in-c", "c")):
        text = (ROOT / f"docs/howto/{name}.md").read_text()
        header = r'#include "chimera/task/(?:component|pbo)\.h"'
        blocks = re.findall(rf"```{language}\n({header}.*?)```", text, re.DOTALL)
        if not blocks:
            sys.exit(f"{name}.md has no sources any more")
        for i, source in enumerate(blocks):
            path = pathlib.Path(folder) / f"{name}_{i}.{'cc' if language == 'cpp' else 'c'}"
            path.write_text(source)
            yield path, None


def most_ports(folder):
    """A component in C has at most 64 ports."""
    for count, sentence in ((64, None), (65, "more_than_64_elements")):
        path = pathlib.Path(folder) / f"ports_{count}.c"
        path.write_text(module_in_c(",\n".join(f'(in_var, x{i}, float64, "", "m")' for i in range(count))))
        yield path, sentence


def papers():
    """What tball.c and car.c have beside the figures of the paper and the table of the guide."""
    text = (ROOT / "docs/howto/component-in-c.md").read_text()
    rows = re.findall(r"^\| (tball|car|both) \| (?:`(.+?)`)? ?\| `(.+?)` \|$", text, re.MULTILINE)
    for name, digest in PAPERS.items():
        theirs = {here: paper for module, paper, here in rows if module in (name, "both")}
        source = re.sub(r"/\*.*?\*/\n", "", (FOLDER / f"{name}.c").read_text(), flags=re.DOTALL)
        lines = source.splitlines()
        yield from (f"{name}.c has no line for the table of the guide: {here}" for here in theirs if here not in lines)
        figure = "".join(theirs.get(line, line) for line in lines)
        if name == "car":  # the paper shows only the names of its methods
            figure, methods = figure.split("int carInit", 1)
            defined = ["carInit", *re.findall(r"int (car\w+)\(", methods)]
            if defined != re.findall(r"\bcar[A-Z]\w+(?=,)", figure):
                yield f"car.c has other methods than figure 8: {' '.join(defined)}"
        if hashlib.sha256("".join(figure.split()).encode()).hexdigest() != digest:
            yield f"{name}.c differs from the paper in more than the table of the guide: {figure}"


def main():
    work = []
    with tempfile.TemporaryDirectory() as folder:
        precompile(folder)
        control = pathlib.Path(folder) / "control.cc"
        control.write_text(CONTROL % "")
        work.append((control, None))
        work += guide(folder)
        work += [(FOLDER / f"{name}.c", None) for name in PAPERS]
        refused = [*cases(folder), *most_ports(folder)]
        work += refused
        # All misspellings in one class: the compiler names each of them.
        words = misspellings()
        all_of_them = pathlib.Path(folder) / "misspelt.cc"
        all_of_them.write_text(CONTROL % "".join(f"  void {word}() {{}}\n" for word, _ in words))
        _, said = compile_text(all_of_them, FLAGS[".cc"])
        missing = [f"'{word}': did you mean '{meant}'?" for word, meant in words
                   if f"the component has a method '{word}': did you mean '{meant}'? The methods are init reinit on "
                      "cycle sync off kill error clear" not in said]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            wrong = [line for line in pool.map(lambda one: judge(*one), work) if line] + missing + list(papers())
    print("\n".join(wrong) if wrong else f"{len(refused)} refusals and {len(words)} misspellings as written")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
