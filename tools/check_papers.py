# SPDX-License-Identifier: Apache-2.0
"""docs/papers.md has an entry for each work that a data sheet of library/ links, and each entry names the components
whose sheets link it. A sheet links a work where it names one by authors and year."""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "check"))
import sources  # noqa: E402
from check_links import anchors  # noqa: E402

PAGE = "docs/papers.md"
SHEET = re.compile(r"library/(\w+)/README\.md")
LINK = re.compile(r"\]\(\.\./\.\./docs/papers\.md#([\w-]+)\)")
ENTRY = re.compile(r"^## (.+)\n\n((?:.+\n)+)", re.MULTILINE)
CITED = re.compile(r"\bCited by ([\w, ]+)\.\s*$")
# Behind the heading Source, outside of links: "Meier 1999", "the 1994 paper".
BARE = re.compile(r"\b(?:(?!The )[A-Z][a-z]+,? (?:19|20)\d\d|(?:1994|2000) paper)\b")


def check(root):
    names = sources.files(root)
    cited = {}
    for name in names:
        if not (sheet := SHEET.fullmatch(name)):
            continue
        text = sources.text(root, name)
        for work in sorted(set(LINK.findall(text))):
            cited.setdefault(work, []).append(sheet[1])
        _, _, source = text.partition("\n## Source\n")
        for work in BARE.findall(" ".join(re.sub(r"\[[^\]]*\]\([^)]*\)", "", source).split())):
            yield f"{name}: '{work}' is no link to {PAGE}"
    entries = ENTRY.findall(sources.text(root, PAGE)) if PAGE in names else []
    for heading, text in entries:
        (work,) = anchors(f"## {heading}\n")
        said = CITED.search(" ".join(text.split()))
        wanted = cited.pop(work, [])
        if not re.search(r"\b(19|20)\d\d\b", text):
            yield f"{PAGE}: '{heading}' has no year"
        if not said or said[1].split(", ") != wanted:
            yield f"{PAGE}: '{heading}' must end with: Cited by {', '.join(wanted) or 'nothing, so remove it'}."
    for work, components in cited.items():
        yield f"{PAGE}: there is no entry '{work}', which {', '.join(components)} cite"


SHEET_A = "# a\n\n## Source\n\n[Meier 1999](../../docs/papers.md#meier-1999), table 2.\n"
ENTRY_A = "# Papers\n\n## Meier 1999\n\nA. Meier: On Things. Press, 1999. Cited by a.\n"
PLANTED = (
    ({"library/a/README.md": SHEET_A, PAGE: ENTRY_A}, None),
    ({"library/a/README.md": SHEET_A, PAGE: "# Papers\n"}, f"{PAGE}: there is no entry 'meier-1999', which a cite"),
    ({"library/a/README.md": SHEET_A + "Meyer and Huber\n2001.\n", PAGE: ENTRY_A},
     f"library/a/README.md: 'Huber 2001' is no link to {PAGE}"),
    ({"library/a/README.md": SHEET_A + "The 1994 paper.\n", PAGE: ENTRY_A},
     f"library/a/README.md: '1994 paper' is no link to {PAGE}"),
    ({"library/a/README.md": "# a\n", PAGE: ENTRY_A},
     f"{PAGE}: 'Meier 1999' must end with: Cited by nothing, so remove it."),
    ({"library/a/README.md": SHEET_A, "library/b/README.md": SHEET_A, PAGE: ENTRY_A},
     f"{PAGE}: 'Meier 1999' must end with: Cited by a, b."),
    ({"library/a/README.md": SHEET_A, PAGE: ENTRY_A.replace(", 1999", "")}, f"{PAGE}: 'Meier 1999' has no year"),
)

if __name__ == "__main__":
    sources.run(check, PLANTED)
