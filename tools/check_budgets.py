# SPDX-License-Identifier: Apache-2.0
"""Sizes and names: folders of chimera/ with at most 40 production files, files of at most 500 lines, functions of at
most 60, lines of at most 120 columns. A function-like macro has an allowed name or is undefined again in the same
file."""
import collections
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "check"))
import functions  # noqa: E402
import sources  # noqa: E402

FOLDER_FILES, FILE_LINES, FUNCTION_LINES, COLUMNS = 40, 500, 60, 120
PRODUCTION = re.compile(r"(chimera/.+)/[^/]+(?<!_test)(?<!_fuzz)(?<!_stress)\.(?:h|cc)")
CODE = (".h", ".cc", ".c", ".py", ".sh", ".cmake", ".js", ".ts", ".tsx", ".css", ".pml")
MACRO = re.compile(r"^[ \t]*#[ \t]*define[ \t]+(\w+)\(", re.MULTILINE)
MACRO_ALLOWED = re.compile(r"CHIMERA_ASSERT$|CHIMERA_COMPONENT|PBO_|SVAR_")
TYPE_NAME = re.compile(r"\b(?:class|struct)\s+(\w+(?:Manager|Helper|Util|Data|Impl))\b")


def is_code(name):
    return name.endswith(CODE) or name.split("/")[-1] in ("CMakeLists.txt", "dev") or name == ".ci/run"


def lines_of(content, position):
    return content.count("\n", 0, position) + 1


def long_functions(name, content):
    if name.endswith((".h", ".cc", ".c")):
        found = functions.of_cpp(content)
    elif name.endswith(".py"):
        found = functions.of_python(content)
    else:
        return
    for function, line, length in found:
        if length > FUNCTION_LINES:
            yield f"{name}:{line}: {function} has {length} lines, at most {FUNCTION_LINES} are allowed"


def macros_and_names(name, content):
    if not name.endswith((".h", ".cc", ".c")):
        return
    for match in MACRO.finditer(content):
        if not MACRO_ALLOWED.match(match[1]) and not re.search(rf"# *undef +{match[1]}\b", content):
            yield f"{name}:{lines_of(content, match.start())}: function-like macro {match[1]}"
    for match in TYPE_NAME.finditer(content):
        yield f"{name}:{lines_of(content, match.start())}: type name {match[1]} says nothing"


def full_folders(names):
    folders = collections.Counter(match[1] for match in map(PRODUCTION.fullmatch, names) if match)
    return (f"{folder}: {n} production files, at most {FOLDER_FILES} are allowed"
            for folder, n in sorted(folders.items()) if n > FOLDER_FILES)


def check(root):
    yield from full_folders(sources.files(root))
    for name in sources.files(root):
        if not is_code(name):
            continue
        content = sources.text(root, name)
        lines = content.splitlines()
        if len(lines) > FILE_LINES:
            yield f"{name}: {len(lines)} lines, at most {FILE_LINES} are allowed"
        for number, line in enumerate(lines, 1):
            if len(line) > COLUMNS and not name.endswith((".css", ".pml")):
                yield f"{name}:{number}: {len(line)} columns, at most {COLUMNS} are allowed"
        yield from long_functions(name, content)
        yield from macros_and_names(name, content)


def _function(lines, head="int f(int x)", indent=""):
    return f"{indent}{head} {{\n" + "  x;\n" * (lines - 2) + f"{indent}}}\n"


def _long(name, line, length=61):
    return f"a.cc:{line}: {name} has {length} lines, at most 60 are allowed"


PLANTED = (
    ({"a.cc": _function(60) * 3}, None),
    ({"a.cc": "\n\n" + _function(61)}, _long("f", 3)),
    ({"a.cc": "namespace a {\nclass B {\n" + _function(61, "void g() const noexcept") + "};\n}\n"}, _long("g", 3)),
    ({"a.cc": _function(61, "B::B(int x) : x_(x), y_{x}, z_(3)")}, _long("B::B", 1)),
    ({"a.cc": _function(61, "template <class T>\nauto h(T t) -> decltype(t)")}, _long("h", 1, 62)),
    ({"a.cc": _function(61, "TEST(Suite, IsAClaim)")}, _long("TEST", 1)),
    ({"a.cc": "// }\n/* { */ const char* t = \"}\"; char c = '{';\n" + _function(61, 'extern "C" int k(int x)')},
     _long("k", 3)),
    ({"a.cc": "namespace a {\n" + "int x;\n" * 80 + "}\nconst int t[] = {\n" + "1,\n" * 80 + "};\n"}, None),
    ({"a.cc": "struct S {\n" + "int f() { return 1; }\n" * 80 + "};\nenum class E {\n" + "k,\n" * 80 + "};\n"}, None),
    ({"a.cc": "void f() {\n" + "  if (x) { y(); }\n" * 59 + "}\n"}, _long("f", 1)),
    ({"a.py": "def f():\n" + "    x\n" * 60}, "a.py:1: f has 61 lines, at most 60 are allowed"),
    ({"a.sh": "true\n" * 501}, "a.sh: 501 lines, at most 500 are allowed"),
    ({"a.cmake": "#" + "x" * 120 + "\n"}, "a.cmake:1: 121 columns, at most 120 are allowed"),
    ({"a.h": "#define CHIMERA_ASSERT(x) 0\n#define PBO_MODULE(x) 0\n#define N 1\n"}, None),
    ({"a.h": "\n# define CHECK_IT(x) 0\n"}, "a.h:2: function-like macro CHECK_IT"),
    ({"a.h": "#define LOCAL(x) 0\n#undef LOCAL\n"}, None),
    ({"a.h": "struct TableImpl;\n"}, "a.h:1: type name TableImpl says nothing"),
)

if __name__ == "__main__":
    sources.run(check, PLANTED)
