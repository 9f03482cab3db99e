# SPDX-License-Identifier: Apache-2.0
"""Every tracked file: a name that says what it is. Every tracked text: the licence line, no path of one machine, no
word about a workplace, nothing left to do. Every production source x.cc: a sentence that says what it does."""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "check"))
import sources  # noqa: E402

LICENCE = "SPDX-License-Identifier: Apache-2.0"
LICENSED = (".h", ".cc", ".c", ".py", ".sh", ".cmake", ".js", ".ts", ".css", ".pml")
BINARY = (".png", ".jpg", ".gz", ".zip", ".woff2", ".ico", ".stl", ".dae")
# What a program leaves behind in a folder has none of these endings, or a name that nobody would type.
ENDINGS = LICENSED + BINARY + (
    ".md", ".txt", ".html", ".svg", ".1",                        # to read
    ".yaml", ".json", ".xml", ".csv", ".urdf", ".idl", ".obj",   # to be read by a program
    ".expected", ".partner", ".store", ".events",                # what a test or an example is held against
    ".in", ".bash", ".service", ".install", ".lintian-overrides")  # to install
NAMES = ("dev", "LICENSE", ".ci/run", ".gitignore", ".gitattributes", ".clang-format", ".clang-tidy")
PART = re.compile(r"[A-Za-z0-9_.][A-Za-z0-9_.@+-]{0,79}")
# The words are put together here, so that this file does not complain about itself.
FORBIDDEN = (
    ("a path of one machine", re.compile("|".join([
        "/wo" + r"rk/\w", "/ro" + r"ot/\w", "/ho" + r"me/\w", "/Us" + r"ers/\w",
        "/tm" + r"p/bash"]))),
    ("a host of a package registry", re.compile("|".join([
        "deb" + r"\.debian\.org", "py" + r"pi\.org", "npm" + r"js\.org", "pkg" + r"\.dev\b", "artifact" + "registry",
        "artifact-" + "registry", "google" + "apis"]), re.IGNORECASE)),
    ("a word about how the text came to be", re.compile("|".join([
        "an" + "thropic", "cla" + "ude", "chat" + "gpt", "open" + "ai", "cop" + "ilot", "sub" + "agent",
        r"\bL" + r"LM\b", r"\bA" + r"I (agent|model|assist|generated)",
        "as an A" + r"I\b", "iss" + r"ue #?\d", r"\bsandb" + "ox"]),
        re.IGNORECASE)),
    ("a section that the 1994 paper does not have",
     re.compile(r"1994 paper, section (?!(?:[12]|3(?:\.[1-5])?)(?![\d.]*\d))[\d.]*\d")),
    ("something left to do", re.compile(r"\b(TO" + r"DO|FIX" + r"ME|XX" + r"X)\b")),
)


def needs_licence(name):
    return name.endswith(LICENSED) or name.split("/")[-1] in ("CMakeLists.txt", "dev") or name == ".ci/run"


def is_known(name):
    """Inputs of a corpus may have names without endings, and so may the files of a folder debian/."""
    parts = name.split("/")
    free = "debian" in parts[:-1] or any(part.endswith("_corpus") for part in parts[:-1])
    return all(PART.fullmatch(part) for part in parts) and (free or name in NAMES or name.endswith(ENDINGS))


def wants_purpose(name):
    return (re.match(r"(chimera/|library/).*\.cc$", name)
            and not re.search(r"/testing/|_(test|fuzz|stress)\.cc$", name))


def has_purpose(lines):
    """A comment line of three words or more follows the licence."""
    return len(lines) > 1 and re.match(r"// ?(\S+\s+){2}\S", lines[1]) is not None


def check(root):
    for name in sources.files(root):
        if not is_known(name):
            yield f"{name}: no name of a source, a text or data; tools/check_text.py lists the endings and names"
            continue
        if name.endswith(BINARY) or "_corpus/" in name:
            continue
        content = sources.text(root, name)
        lines = content.splitlines()
        head = lines[1:2] if lines and lines[0].startswith("#!") else lines[:1]
        if needs_licence(name) and not (head and LICENCE in head[0]):
            yield f"{name}:1: the first line lacks '{LICENCE}'"
        if wants_purpose(name) and not has_purpose(lines):
            yield f"{name}:2: a sentence is missing that says what this file does"
        for number, line in enumerate(lines, 1):
            for what, pattern in FORBIDDEN:
                match = pattern.search(line)
                if match:
                    yield f"{name}:{number}: {what}: '{match[0]}'"


_HEAD = f"// {LICENCE}\n"
_UNKNOWN = "{}: no name of a source, a text or data; tools/check_text.py lists the endings and names"
PLANTED = (
    ({"a.cc": _HEAD + "int x;\n", "b.sh": "#!/bin/sh\n# " + LICENCE + "\n", "c.md": "text\n"}, None),
    ({"a.cc": "int x;\n"}, f"a.cc:1: the first line lacks '{LICENCE}'"),
    ({"d/CMakeLists.txt": ""}, f"d/CMakeLists.txt:1: the first line lacks '{LICENCE}'"),
    ({"c.md": "see /wo" + "rk/x\n"}, "c.md:1: a path of one machine: '/wo" + "rk/x'"),
    ({"c.md": "\nin /ho" + "me/ann/x\n"}, "c.md:2: a path of one machine: '/ho" + "me/a'"),
    ({"c.yaml": "from Py" + "PI.org\n"}, "c.yaml:1: a host of a package registry: 'Py" + "PI.org'"),
    ({"a.cc": _HEAD + "// iss" + "ue 12\n"}, "a.cc:2: a word about how the text came to be: 'iss" + "ue 1'"),
    ({"dev": "# " + LICENCE + "\n", ".gitignore": "", "a/x_corpus/smallest": "", "debian/control": "",
      "a@.service": ""}, None),
    ({"library/tcp:127.0.0.1:99999": ""}, _UNKNOWN.format("library/tcp:127.0.0.1:99999")),
    ({"library/" + 255 * "x": ""}, _UNKNOWN.format("library/" + 255 * "x")),
    ({"library/" + 90 * "x" + ".cc": _HEAD}, _UNKNOWN.format("library/" + 90 * "x" + ".cc")),
    ({"bench/core": ""}, _UNKNOWN.format("bench/core")),
    ({"a b.txt": ""}, _UNKNOWN.format("a b.txt")),
    ({"a.cc": _HEAD + "// 1994 paper, section 3.3. 1994 paper, section 2, figure 4\n"}, None),
    ({"a.cc": _HEAD + "// 1994 paper, " + "section 4\n"},
     "a.cc:2: a section that the 1994 paper does not have: '1994 paper, " + "section 4'"),
    ({"chimera/base/x.cc": _HEAD + "// Adds one number to another.\n"}, None),
    ({"chimera/base/x.cc": _HEAD + "#include <new>\n"},
     "chimera/base/x.cc:2: a sentence is missing that says what this file does"),
    ({"library/gain/gain.cc": _HEAD + "// ---\n"},
     "library/gain/gain.cc:2: a sentence is missing that says what this file does"),
    ({"chimera/base/x_test.cc": _HEAD, "chimera/base/testing/x.cc": _HEAD, "bench/x.cc": _HEAD}, None),
    ({"a.cc": _HEAD + "// TO" + "DO\n"}, "a.cc:2: something left to do: 'TO" + "DO'"),
)

if __name__ == "__main__":
    sources.run(check, PLANTED)
