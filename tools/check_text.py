# SPDX-License-Identifier: Apache-2.0
"""Every tracked file: a name that says what it is. Every tracked text: the licence line, no path of one machine, no
word about a workplace, nothing left to do. Every production source x.cc: a sentence that says what it does. Every
component: sines and powers from chimera/base/math.h, so that all machines compute the same bits, and one text for
hosts and microcontrollers. Comments, messages, documents and names of tests: none of the words that a reader has to
guess the meaning of."""
import io
import pathlib
import re
import sys
import tokenize

sys.path.insert(0, str(pathlib.Path(__file__).parent / "check"))
import sources  # noqa: E402

LICENCE = "SPDX-License-Identifier: Apache-2.0"
LICENSED = (".h", ".cc", ".c", ".ld", ".py", ".sh", ".cmake", ".js", ".ts", ".tsx", ".css", ".pml")
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

# A sentence names its subject: a class, task, process, thread, file or number. These words stand in the place of one.
GUESSED = ("whoever", "nobody", "somebody", "so many", "so long", "so often", "is told", "are told", "tells", "of late",
           "by then", "meanwhile", "what became of", "what becomes of", "who has", "real-time unit", "guest", "fleet")
GUESSED_WORD = re.compile(r"\b(" + "|".join(GUESSED) + r")s?\b", re.IGNORECASE)
GUESSED_NAME = re.compile("Whoever|Nobody|Somebody|SoMany|SoLong|SoOften|IsTold|AreTold|OfLate|ByThen|Meanwhile")
GUESSED_BEGIN = re.compile(r"/// ?(Of|The same|What|Who|Else|Whose|That)\b")
C_TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:[^"\\\n]|\\.)*"', re.DOTALL)
TEST_NAME = re.compile(r"\b(?:TEST|TEST_F|TEST_P|TYPED_TEST)\(\w+,\s*(\w+)\)|\bdef (test_\w+)")


# Functions that each C library rounds in its own way. Exact ones (floor, round, copysign, sqrt, fmod) are the same.
INEXACT = "(?:a?(?:sin|cos|tan)h?|atan2|exp[2m]?1?|log(?:2|10|1p)?|pow|cbrt|hypot|erfc?|[tl]gamma)"
INEXACT_CALL = re.compile(rf"\bstd::{INEXACT}[fl]?\b|(?<![\w:.>])(?:::)?{INEXACT}[fl]?\s*\(")
# Components that only a host can run, and shared code of theirs.
OF_HOSTS = ("camera_targets", "kinematics", "model_text", "mujoco", "puma", "puma_torque", "rmms")


def inexact(name, content):
    """Calls whose result depends on the C library, in code that a microcontroller may take."""
    if (not re.match(rf"library/(?!(?:{'|'.join(OF_HOSTS)})/).*\.(h|cc|c)$", name)
            or re.search(r"/testing/|_(test|fuzz|stress)\.cc$", name)):
        return
    code = C_TEXT.sub(lambda match: "\n" * match[0].count("\n"), content)
    for number, line in enumerate(code.splitlines(), 1):
        for match in INEXACT_CALL.finditer(line):
            yield f"{name}:{number}: '{match[0].rstrip(' (')}' depends on the C library: chimera/base/math.h has one"


# A component is one text for every machine; only the headers that it includes may know where they are compiled.
OF_A_MACHINE = re.compile(r"\bCHIMERA_BARE\b|\b__arm__\b|\b__thumb__\b|\b__STDC_HOSTED__\b")


def of_a_machine(name, content):
    """Places where a component asks on which machine it is."""
    if re.match(r"library/.*\.(h|cc|c)$", name):
        for number, line in enumerate(content.splitlines(), 1):
            for match in OF_A_MACHINE.finditer(line):
                yield f"{name}:{number}: '{match[0]}': a component has one text for hosts and microcontrollers"


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


def texts(name, content):
    """(line number, text) of what people read in a file: comments, strings, the prose of documents."""
    if name.endswith((".h", ".cc", ".c", ".ts", ".tsx")):
        for match in C_TEXT.finditer(content):
            yield content.count("\n", 0, match.start()) + 1, match[0]
    elif name.endswith(".py"):
        try:
            for token in tokenize.generate_tokens(io.StringIO(content).readline):
                if token.type in (tokenize.COMMENT, tokenize.STRING):
                    yield token.start[0], token.string
        except (tokenize.TokenError, SyntaxError):
            yield 1, content
    elif name.endswith(".md"):
        is_code = False
        for number, line in enumerate(content.splitlines(), 1):
            is_code ^= line.lstrip().startswith("```")
            if not is_code and not line.startswith("    "):
                yield number, re.sub(r"`[^`]*`", "", line)
    elif name.endswith((".yaml", ".sh", ".cmake", "CMakeLists.txt")):
        for number, line in enumerate(content.splitlines(), 1):
            if "#" in line:
                yield number, line[line.index("#"):]


def guessed(name, content):
    """Words that leave their meaning to the reader."""
    for number, text in texts(name, content):
        for offset, line in enumerate(text.splitlines()):
            match = GUESSED_BEGIN.match(line) or GUESSED_WORD.search(line)
            if match:
                yield f"{name}:{number + offset}: '{match[0]}': name the subject, in the words of docs/glossary.md"
    for match in TEST_NAME.finditer(content):
        if GUESSED_NAME.search(match[1] or "") or GUESSED_WORD.search((match[2] or "").replace("_", " ")):
            number = content.count("\n", 0, match.start()) + 1
            yield f"{name}:{number}: test '{match[1] or match[2]}': say the condition and the result"


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
        if name != "tools/check_text.py":
            yield from guessed(name, content)
        yield from inexact(name, content)
        yield from of_a_machine(name, content)


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
    ({"a.cc": _HEAD + 'int meanwhile;  // Counts jobs.\nf("a task");\n', "b.md": "`nobody`\n"}, None),
    ({"a.cc": _HEAD + "int x;  // as somebody asked\n"},
     "a.cc:2: 'somebody': name the subject, in the words of docs/glossary.md"),
    ({"a.h": _HEAD + "/// Of a task.\n"}, "a.h:2: '/// Of': name the subject, in the words of docs/glossary.md"),
    ({"a.py": "# " + LICENCE + '\nx = """a\nb is told"""\n'},
     "a.py:3: 'is told': name the subject, in the words of docs/glossary.md"),
    ({"b.md": "It goes on meanwhile.\n"}, "b.md:1: 'meanwhile': name the subject, in the words of docs/glossary.md"),
    ({"a.cc": _HEAD + "TEST(Bell, IsToldOnce) {}\n"}, "a.cc:2: test 'IsToldOnce': say the condition and the result"),
    ({"a.py": "# " + LICENCE + "\ndef test_nobody_comes(self):\n    pass\n"},
     "a.py:2: test 'test_nobody_comes': say the condition and the result"),
    ({"library/a/a.h": _HEAD + "// std::sin(x)\ndouble y = math::sin(x) + exponent(x) + a.log(x) + std::floor(x);\n",
      "library/a/a_test.cc": _HEAD + "double y = std::sin(x);\n", "chimera/a.h": _HEAD + "double y = std::sin(x);\n",
      "library/rmms/a.h": _HEAD + "double y = std::sin(x);\n"}, None),
    ({"library/a/a.h": _HEAD + "\ndouble y = std::atan2(x, 1);\n"},
     "library/a/a.h:3: 'std::atan2' depends on the C library: chimera/base/math.h has one"),
    ({"library/a/a.c": _HEAD + "double y = 2 * powf (x, 2);\n"},
     "library/a/a.c:2: 'powf' depends on the C library: chimera/base/math.h has one"),
    ({"library/a/a.h": _HEAD + "#ifdef CHIMERA_BARE\n#endif\n"},
     "library/a/a.h:2: 'CHIMERA_BARE': a component has one text for hosts and microcontrollers"),
    ({"library/a/a.c": _HEAD + "#if defined(__arm__)\n#endif\n", "chimera/a.h": _HEAD + "#ifdef CHIMERA_BARE\n"},
     "library/a/a.c:2: '__arm__': a component has one text for hosts and microcontrollers"),
    ({"a.cc": _HEAD + "// TO" + "DO\n"}, "a.cc:2: something left to do: 'TO" + "DO'"),
)

if __name__ == "__main__":
    sources.run(check, PLANTED)
