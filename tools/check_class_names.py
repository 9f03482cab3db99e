# SPDX-License-Identifier: Apache-2.0
"""Proves that a class, struct, union or enum has its name alone: none at namespace scope of chimera/ and apps/
(production sources, all namespaces together) is defined twice."""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "check"))
import sources  # noqa: E402

TEST = re.compile(r"_(test|fuzz|stress|bench|rig)\.(cc|h)$|(^|/)(test|fake)_[^/]*$|/testing/")
NOISE = re.compile(r"""//[^\n]*|/\*.*?\*/|R"\(.*?\)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+'"""
                   r"""|^[ \t]*#(?:\\\n|[^\n])*""", re.DOTALL | re.MULTILINE)
NAMESPACE = re.compile(r"(?:^|\s)(?:inline\s+)?namespace(?:\s+[\w:]+)?\s*$|extern\s*$")
DEFINITION = re.compile(r"\b(?:class|struct|union|enum(?:\s+(?:class|struct))?)\s+"
                        r"(?:alignas\s*\([^)]*\)\s*|\[\[[^]]*\]\]\s*)*(\w+)\s*(?:final\s*)?(?::[^:].*)?$", re.DOTALL)


def blanked(content):
    """Without comments, texts and directives; every line where it was."""
    return NOISE.sub(lambda match: "\n" * match[0].count("\n"), content)


def definitions(content):
    """(line, name) of every class, struct, union and enum that is defined at namespace scope."""
    content, inside, start = blanked(content), 0, 0
    scopes = []  # of each open brace: is it a namespace?
    for match in re.finditer(r"[{};]", content):
        head = content[start:match.start()]
        start = match.end()
        if match[0] == "{":
            is_namespace = NAMESPACE.search(head.rstrip()) is not None
            found = DEFINITION.search(head.strip())
            if inside == 0 and found and not is_namespace:
                yield content.count("\n", 0, match.start()) + 1, found[1]
            scopes.append(is_namespace)
            inside += not is_namespace
        elif match[0] == "}" and scopes:
            inside -= not scopes.pop()


def check(root):
    places = {}
    for name in sources.files(root):
        if name.startswith(("chimera/", "apps/")) and name.endswith((".h", ".cc")) and not TEST.search(name):
            for line, found in definitions(sources.text(root, name)):
                places.setdefault(found, []).append(f"{name}:{line}")
    for name, where in sorted(places.items()):
        if len(where) > 1:
            yield f"{where[-1]}: {name} is defined in {', '.join(where[:-1])} too: one name a class"


def _two(first, second, name="chimera/control/y.cc"):
    return {"chimera/base/x.h": first, name: second}


def _again(line, name):
    return f"chimera/control/y.cc:{line}: {name} is defined in chimera/base/x.h:1 too: one name a class"


PLANTED = (
    (_two("struct Alone {};\n", "struct Other {};\n"), None),
    (_two("struct Pair {};\n", "namespace two {\nclass Pair final : public Base {\n};\n}\n"), _again(2, "Pair")),
    (_two("enum class Kind : int { kOne };\n", "namespace {\n// struct Kind\nstruct Kind { int x; };\n}\n"),
     _again(3, "Kind")),
    (_two("struct Named {};\n", 'extern "C" {\nstruct Named {\n};\n}\n'), _again(2, "Named")),
    (_two("template <class T> class alignas(64) Cell {};\n", "template <class T> class Cell : A<T> {};\n"),
     _again(1, "Cell")),
    (_two("struct Told;\nclass Told;\nstruct Told {};\n",
          'const char* text = "struct Told {";\nTold f(struct Told t) {}\n'), None),
    (_two("struct Outer { struct Inner {}; };\n", "struct Wider { struct Inner {}; };\n"), None),
    (_two("void f() { struct Local {}; }\n", "void g() { struct Local {}; }\n"), None),
    (_two("struct Pair {};\n", "struct Pair {};\n", "chimera/base/x_test.cc"), None),
    (_two("struct Pair {};\n", "struct Pair {};\n", "chimera/base/testing/x.h"), None),
    (_two("struct Pair {};\n", "template <> struct Pair<int> {};\n"), None),
)

if __name__ == "__main__":
    sources.run(check, PLANTED)
