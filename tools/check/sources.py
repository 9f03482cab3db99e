# SPDX-License-Identifier: Apache-2.0
"""What every checker shares: the files of the checkout, and the frame in which a checker proves that it can fail."""
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED_FOLDERS = {"build", ".git", ".ccache", "node_modules", "__pycache__"}


def files(root):
    """Paths relative to `root`: what git tracks or would track; without git everything but build trees."""
    git = ["git", "-c", "safe.directory=*", "-C", str(root), "ls-files", "--cached", "--others", "--exclude-standard"]
    try:
        listing = subprocess.run(git, capture_output=True, text=True, check=True).stdout.splitlines()
        return sorted(name for name in listing if (root / name).is_file())
    except (OSError, subprocess.CalledProcessError):
        return sorted(_walk(root))


def _walk(root):
    for folder, inner, names in os.walk(root):
        inner[:] = [name for name in inner if name not in SKIPPED_FOLDERS]
        for name in names:
            yield str(pathlib.Path(folder, name).relative_to(root))


def text(root, name):
    return (root / name).read_text(encoding="utf-8", errors="replace")


def main(check, planted):
    """`check(root)` yields complaints. `planted` are (files, expected): a small tree each, {name: text}, and the one
    complaint it must bring, None for a tree that must pass. Run before the real check: a checker that cannot fail
    proves nothing."""
    wrong = [line for case in planted for line in _planted_case(check, *case)]
    if wrong:
        print("the checker itself is broken:\n" + "\n".join(wrong))
        return 1
    complaints = list(check(ROOT))
    print("\n".join(complaints) or f"nothing to complain about; {len(planted)} planted cases judged rightly")
    return 1 if complaints else 0


def _planted_case(check, tree, expected):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, content in tree.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(content, encoding="utf-8")
        found = list(check(root))
    if found != ([] if expected is None else [expected]):
        yield f"  {sorted(tree)}: expected {expected!r}, found {found}"


def run(check, planted):
    sys.exit(main(check, planted))
