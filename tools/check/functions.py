# SPDX-License-Identifier: Apache-2.0
"""Finds the functions of a C++, C or Python file by a simple scan: enough to count their lines."""
import ast
import re

_TOKENS = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(?P<d>[^(\s]*)\(.*?\)(?P=d)"|'
    r'"(?:\\.|[^"\\\n])*"|(?<![0-9A-Fa-f])\'(?:\\.|[^\'\\\n])+\'', re.DOTALL)
_DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", re.MULTILINE)
_AFTER_PARAMETERS = re.compile(
    r"\)(\s*(const|noexcept(\s*\([^{}]*\))?|override|final|mutable|&&?|try|requires\b[^{}]*|->[^{}=]*))*\s*$|"
    r"\)\s*:\s.*$",
    re.DOTALL)
_NOT_A_FUNCTION = re.compile(r"^\s*(template\s*<[^{}]*>\s*)?(namespace|class|struct|union|enum|extern)\b")


def _blank(match):
    return re.sub(r"[^\n]", " ", match[0])


def _bare(text):
    """The text without comments, literals and preprocessor lines, every line where it was."""
    return _DIRECTIVE.sub(_blank, _TOKENS.sub(_blank, text))


def _opens_function(before):
    head = re.sub(r"\[\[.*?\]\]", " ", before)
    if _NOT_A_FUNCTION.match(head) and not re.match(r'^\s*extern\s+\S+\s+\S', head):
        return False
    return bool(_AFTER_PARAMETERS.search(head))


def of_cpp(text):
    """(name, first line, lines) of each outermost function body; a lambda counts with the function round it."""
    bare = _bare(text)
    depth, inside_since, statement, start, name = 0, None, 0, 0, ""
    for position, character in enumerate(bare):
        if character == "{":
            before = bare[statement:position]
            if inside_since is None and _opens_function(before):
                inside_since = depth
                if not before.lstrip().startswith(","):  # else: a brace of an initialiser list
                    start, name = statement, before
            depth += 1
            statement = position + 1
        elif character == "}":
            depth -= 1
            if inside_since == depth:
                inside_since = None
                first = _first_line(bare, start)
                yield _short(name), first, bare.count("\n", 0, position) + 2 - first
            statement = position + 1
        elif character == ";" and inside_since is None:
            statement = position + 1


def _first_line(bare, start):
    skipped = len(bare[start:]) - len(bare[start:].lstrip())
    return bare.count("\n", 0, start + skipped) + 1


def _short(before):
    words = re.findall(r"[~\w:]+(?=\s*\()", before)
    return words[0] if words else "function"


def of_python(text):
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield node.name, node.lineno, node.end_lineno - node.lineno + 1
