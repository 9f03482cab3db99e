# SPDX-License-Identifier: Apache-2.0
"""Every relative link of a Markdown page leads to a file or folder, and to a heading where it names one. Every page of
docs/ that a source or a text cites exists."""
import pathlib
import re
import sys
import urllib.parse

sys.path.insert(0, str(pathlib.Path(__file__).parent / "check"))
import sources  # noqa: E402

LINK = re.compile(r"\]\(\s*<?([^)\s>]+)>?\s*\)")
CITED = re.compile(r"(?<![\w/.-])docs/[\w./-]+\.(?:md|json)\b")
NUMBERED = re.compile(r"\bdecisions?[ /](0\d{3})\b", re.IGNORECASE)
HEADING = re.compile(r"^#+ +(.*?) *$", re.MULTILINE)
BLOCK = re.compile(r"^```.*?^```|(?<=\n\n)(?:    [^\n]*\n)+", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"`[^`]*`")
INVENTED = ("tools/check_links.py", "tests/install/prefix.sh", "tests/examples/quotes.py",
            "chimera/web/documents_test.cc")  # pages as examples


def anchors(text):
    """The names that headings have as targets: lower case, without marks, a hyphen for each blank."""
    for title in HEADING.findall(BLOCK.sub("", text)):
        title = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title)
        yield re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def broken_links(root, name, text):
    for target in LINK.findall(CODE.sub("", BLOCK.sub("", text))):
        if re.match(r"\w+:", target):
            continue
        path, _, anchor = urllib.parse.unquote(target).partition("#")
        page = (root / name).parent / path if path else root / name
        if not page.exists():
            yield f"{name}: the link '{target}' leads to nothing"
        elif anchor and page.suffix == ".md" and anchor not in anchors(page.read_text(encoding="utf-8")):
            yield f"{name}: no heading for the link '{target}'"


def check(root):
    names = [name for name in sources.files(root) if name not in INVENTED and "_corpus/" not in name]
    decisions = {pathlib.PurePath(name).name[:4] for name in names if name.startswith("docs/decisions/")}
    for name in names:
        text = sources.text(root, name)
        if name.endswith(".md"):
            yield from broken_links(root, name, text)
        for page in sorted(set(CITED.findall(text))):
            if not (root / page).exists():
                yield f"{name}: '{page}' does not exist"
        for number in sorted(set(NUMBERED.findall(text)) - decisions):
            yield f"{name}: there is no decision {number}"


PLANTED = (
    ({"docs/a.md": "# A page\n[b](b.md#two-words) [up](../x.h) [c](https://x.org/y) [here](#a-page)\n",
      "docs/b.md": "## Two `words`\n", "x.h": "// docs/b.md, decision 0001\n", "docs/decisions/0001-x.md": ""}, None),
    ({"a.md": "`q[0](rad)`\n```\n[b](b.md)\n```\n\n    [c](c.md)\n"}, None),
    ({"a.md": "[b](b.md)\n"}, "a.md: the link 'b.md' leads to nothing"),
    ({"a.md": "# One\n[b](#two)\n"}, "a.md: no heading for the link '#two'"),
    ({"x.h": "// docs/formats/gone.md\n"}, "x.h: 'docs/formats/gone.md' does not exist"),
    ({"x.h": "// decision 0007\n"}, "x.h: there is no decision 0007"),
)

if __name__ == "__main__":
    sources.run(check, PLANTED)
