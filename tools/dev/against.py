# SPDX-License-Identifier: Apache-2.0
"""./dev bench --against COMMIT: the same rows of this checkout and of another commit, in turn, pair by pair."""
import collections
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tarfile
import tempfile
import time

import common
import rows


class Refused(Exception):
    """Why the other commit cannot be compared, and what to do; `code` is the exit code."""

    def __init__(self, said, code=1):
        super().__init__(said)
        self.code = code


class Other:
    """The source tree of another commit under build/against/, with a build tree of its own. Git knows nothing of it:
    it is an archive that was unpacked. It stays for the next comparison."""

    def __init__(self, commit, root=common.ROOT):
        self.here = root
        self.folder = root / "build" / "against"
        self.asked = commit
        self.name = self._resolve(commit)
        self.root = self.folder / self.name

    def _git(self, *arguments):
        return subprocess.run(["git", "-c", "safe.directory=*", "-C", str(self.here), *arguments], capture_output=True)

    def _resolve(self, commit):
        try:
            done = self._git("rev-parse", "--verify", "--quiet", "--end-of-options", commit + "^{commit}")
        except OSError as error:
            raise Refused(f"--against needs git: {error}") from error
        if done.returncode != 0:
            if self._git("rev-parse", "--git-dir").returncode != 0:
                raise Refused(f"--against {commit}: this folder is no git checkout, so there is no other commit in it")
            raise Refused(f"--against {commit}: no such commit here; `git log --oneline` lists them, and after a "
                          "shallow clone `git fetch --unshallow` brings the older ones", 2)
        return done.stdout.decode().strip()[:10]

    def row_numbers(self):
        """Read from git, before anything is unpacked."""
        listed = self._git("ls-tree", "--name-only", self.name, "bench/").stdout.decode().split()
        with tempfile.TemporaryDirectory() as folder:
            bench = pathlib.Path(folder) / "bench"
            bench.mkdir()
            for name in listed:
                (bench / pathlib.PurePath(name).name).touch()
            return set(rows.sources(bench.parent))

    def unpack(self):
        """All of it or nothing."""
        if self.root.exists():
            return
        self.folder.mkdir(parents=True, exist_ok=True)
        common.step(f"unpacking {self.name} into {self.root.relative_to(self.here)}")
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            archive, tree = pathlib.Path(folder) / "tree.tar", pathlib.Path(folder) / "tree"
            done = self._git("archive", "--output", str(archive), self.name)
            if done.returncode != 0:
                raise Refused(f"{self.name} cannot be unpacked: {done.stderr.decode(errors='replace').strip()}")
            with tarfile.open(archive) as tar:
                tar.extractall(tree)
            tree.rename(self.root)

    def build(self, targets):
        """Only the release tree, and in it only `targets`. A tree that does not build is removed, its log stays."""
        log = self.folder / f"{self.name}.log"
        commands = [["ninja", "-C", "build/release", *targets]]
        if not (self.root / "build" / "release" / "build.ninja").exists():
            commands.insert(0, ["cmake", "--preset", "release", "-DCHIMERA_TESTS=ON"])
        common.step(f"compiling {self.name}: {' '.join(targets)}")
        for command in commands:
            if common.run_logged(command, log, r"\[\d+/\d+\]", cwd=self.root) != 0:
                said = [line for line in log.read_text(errors="replace").splitlines() if not line.startswith("[")]
                print("\n".join(said[-40:]), file=sys.stderr)
                shutil.rmtree(self.root)
                raise Refused(f"{self.name} does not build on this machine; all that was said: "
                              f"{log.relative_to(self.here)}. Choose a commit that does.")


def rows_of_both(other, wanted, known):
    """The rows to compare. Rows that were asked for must be in both; without any, those that are."""
    there = other.row_numbers()
    missing = [row for row in (wanted or sorted(known)) if row not in there]
    if not missing:
        return wanted or sorted(known)
    numbers = ", ".join(map(str, missing))
    has = ", ".join(map(str, sorted(there))) or "none"
    if wanted:
        alone = " ".join(map(str, missing))
        raise Refused(f"{other.name} has no row {numbers}; it has: {has}. `./dev bench {alone}` measures it "
                      "here alone.", 2)
    if not there & set(known):
        raise Refused(f"{other.name} has no row of this checkout; it has: {has}. Choose a later commit.", 2)
    common.step(f"not compared, because {other.name} has no such row: {numbers}")
    return [row for row in sorted(known) if row in there]


def measuring(root, numbers):
    """Names under bench/ of the programs of these rows and of the headers of bench/ that they include."""
    found, queue = set(), [path.name for path in rows.programs(rows.sources(root), [])
                           if int(path.name.split("_")[1]) in numbers]
    while queue:
        name = queue.pop()
        if name not in found and (root / "bench" / name).is_file():
            found.add(name)
            queue += re.findall(r'#include "bench/([^"]+)"', (root / "bench" / name).read_text(encoding="utf-8"))
    return found


def differing(here, there, numbers):
    """Names of the files that measure, where they are not the same in both trees."""
    ours, theirs = measuring(here, numbers), measuring(there, numbers)
    return sorted(name for name in ours | theirs if name not in ours & theirs or
                  (here / "bench" / name).read_bytes() != (there / "bench" / name).read_bytes())


def duration(seconds):
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


def keyed(figures):
    """{(row, what, how often that was there before): figure}"""
    seen, found = collections.Counter(), {}
    for figure in figures:
        key = figure["row"], figure["what"]
        found[key + (seen[key],)] = figure
        seen[key] += 1
    return found


def measure(here, there, numbers, pairs, run=rows.run):
    """[(figures of here, of there)] of each pair: each row on both sides before the next row, the side that begins
    alternates. `here` and `there` are roots of trees."""
    measured, begin = [], time.monotonic()
    for pair in range(pairs):
        left = f", about {duration((time.monotonic() - begin) / pair * (pairs - pair))} left" if pair else ""
        common.step(f"pair {pair + 1} of {pairs}{left}")
        sides = [(here, []), (there, [])]
        progress = common.Progress()
        for row in numbers:
            for root, figures in sides if pair % 2 == 0 else reversed(sides):
                for path in rows.programs(rows.sources(root), [row]):
                    progress.show(f"{path.stem} {'here' if root == here else 'there'}")
                    found = run(path, root=root)
                    if found is None:
                        progress.clear()
                        side = "this checkout" if root == here else root.name
                        raise Refused(f"{path.name} of {side} failed in pair {pair + 1}: nothing is compared")
                    figures += found
        progress.clear()
        measured.append((keyed(sides[0][1]), keyed(sides[1][1])))
    return measured


def quartiles(values):
    """(lower, median, upper); three times the value of a single one."""
    if len(values) == 1:
        return values * 3
    return statistics.quantiles(values, n=4, method="inclusive")


def median(figures, key):
    values = [figure[key] for figure in figures if figure.get(key) is not None]
    return statistics.median(values) if values else None


def compare(measured):
    """(figures of both sides, figures only here, figures only there)"""
    here = [key for key in measured[0][0] if all(key in pair[0] for pair in measured)]
    there = [key for key in measured[0][1] if all(key in pair[1] for pair in measured)]
    both = []
    for key in here:
        if key not in there:
            continue
        ours, theirs = [pair[0][key] for pair in measured], [pair[1][key] for pair in measured]
        ratios = [a["figure"] / b["figure"] for a, b in zip(ours, theirs)
                  if a["figure"] is not None and b["figure"] is not None and a["figure"] > 0 and b["figure"] > 0]
        low, middle, high = quartiles(ratios) if ratios else (None, None, None)
        goal = ours[0].get("goal")
        both.append({"row": key[0], "what": key[1], "unit": ours[0].get("unit", ""), "here": median(ours, "figure"),
                     "there": median(theirs, "figure"), "ratio": middle, "lower_quartile": low, "upper_quartile": high,
                     "pairs": len(ratios), "pairs_above_1": sum(ratio > 1 for ratio in ratios),
                     "here_to_baseline": median(ours, "ratio"), "there_to_baseline": median(theirs, "ratio"),
                     "goal": goal, "pairs_met": sum(bool(figure.get("met")) for figure in ours) if goal else None})
    return both, [key for key in here if key not in there], [key for key in there if key not in here]


def table(both, name):
    titles = ["row", "what", "here", name, "ratio", "quartiles", "above 1", "to baseline", "there", "goal", "met"]
    lines = []
    for found in both:
        between = f"{found['lower_quartile']:.3f} to {found['upper_quartile']:.3f}" if found["pairs"] else "-"
        lines.append([str(found["row"]), found["what"], rows.number(found["here"], found["unit"]),
                      rows.number(found["there"], found["unit"]),
                      f"{found['ratio']:.3f}" if found["pairs"] else "-", between,
                      f"{found['pairs_above_1']} of {found['pairs']}", rows.number(found["here_to_baseline"]),
                      rows.number(found["there_to_baseline"]), found["goal"] or "-",
                      "-" if found["pairs_met"] is None else f"{found['pairs_met']}"])
    rows.print_table(titles, lines)


def show(found):
    """The table of a result, and below it what the table does not say itself."""
    name, pairs = found["against"], found["pairs"]
    table(found["figures"], name)
    print(f"here and {name}: medians of {pairs} pairs of runs. ratio: here / {name} inside a pair, the median; "
          "quartiles:\na quarter of the pairs lies below, a quarter above; above 1: pairs in which here was larger. "
          f"to baseline, there:\nwhat here and {name} are of the baseline of their own run; "
          "met: pairs in which here met the goal.")
    for where, figures in (("only here", found["only_here"]), (f"only in {name}", found["only_there"])):
        for row, what in figures:
            print(f"{where}: row {row}, {what}")
    if found["differing_sources"]:
        print("the programs that measure are not the same in both: " +
              ", ".join(f"bench/{file}" for file in found["differing_sources"]))


def record(found):
    """Adds a line for each figure of a result to bench/results/pairs.csv. `lower` and `upper` are quartiles."""
    machine = found["machine"]
    keys = ("there", "here", "ratio", "lower_quartile", "upper_quartile")
    common.record("pairs.csv", [
        (machine["commit"], found["against"], machine["cpu"], figure["row"], figure["what"], figure["unit"],
         *("" if figure[key] is None else f"{figure[key]:.4g}" for key in keys), figure["pairs"], "")
        for figure in found["figures"]])


def prepare(arguments, known):
    """Builds both sides. Returns (the other tree, rows), or raises Refused before anything is measured."""
    other = Other(arguments.against)
    numbers = rows_of_both(other, arguments.rows, known)
    targets = rows.targets(rows.programs(known, numbers))
    if not (common.configure_with_tests("release") and common.compile_tree("release", *targets)):
        raise Refused("this checkout does not build: see above")
    other.unpack()
    other.build(rows.targets(rows.programs(rows.sources(other.root), numbers)))
    return other, numbers


def result(arguments, known):
    """The comparison as one object; raises Refused."""
    try:
        other, numbers = prepare(arguments, known)
    except (OSError, tarfile.TarError) as error:
        raise Refused(f"--against {arguments.against}: {error}; nothing is compared") from error
    with common.realtime_lock():
        measured = measure(common.ROOT, other.root, numbers, arguments.pairs)
    both, only_here, only_there = compare(measured)
    if not both:
        raise Refused(f"{other.name} and this checkout have no figure in common in these rows")
    return {"against": other.name, "pairs": arguments.pairs, "figures": both,
            "only_here": [key[:2] for key in only_here], "only_there": [key[:2] for key in only_there],
            "differing_sources": differing(common.ROOT, other.root, numbers)}
