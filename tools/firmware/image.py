# SPDX-License-Identifier: Apache-2.0
"""An image, as image.yaml says: what it is made of, and how it is baked, linked, run and compared with the host."""
import dataclasses
import json
import math
import os
import pathlib
import re
import subprocess

import build
import digest
import qemu
import receipts
import sizes
import yaml

IMAGES = build.ROOT / "firmware" / "images"
KEYS = {"application", "targets", "for", "at", "components", "instruction_ns", "equal"}


class ImageError(Exception):
    """What the user reads."""


@dataclasses.dataclass
class Image:
    """NAME/image.yaml"""
    name: str
    folder: pathlib.Path            # of that file
    application: pathlib.Path       # a description
    targets: list                   # of firmware/targets, or NAME/TARGET.yaml
    duration: str                   # "60 s"; "": it does not end by itself
    acts: list                      # as of --at
    folders: list                   # of components, beside library/
    instruction_ns: int             # time of an instruction in QEMU
    equal: list                     # pairs of tasks with equal digests

    @staticmethod
    def read(name):
        """The image of that name in firmware/images."""
        path = IMAGES / name / "image.yaml"
        if not path.is_file():
            raise ImageError(f"no image {name}; there are: {', '.join(names())}")
        return Image.of_file(path)

    @staticmethod
    def of_file(path):
        try:
            keys = yaml.safe_load(path.read_text())
        except (OSError, yaml.YAMLError) as error:
            raise ImageError(f"{path}: {error}") from None
        if not isinstance(keys, dict) or not {"application", "targets"} <= set(keys) <= KEYS:
            raise ImageError(f"{path}: has application and targets; it can have for, at, components, equal, "
                             "instruction_ns")
        folder = path.resolve().parent
        return Image(folder.name, folder, (folder / keys["application"]).resolve(), keys["targets"],
                     keys.get("for", ""), keys.get("at", []),
                     [(folder / each).resolve() for each in keys.get("components", [])],
                     keys.get("instruction_ns", qemu.INSTRUCTION_NS), keys.get("equal", []))

    def components(self):
        """The names of the components of the application."""
        tasks = yaml.safe_load(self.application.read_text())["tasks"]
        return sorted({(task or {}).get("component", name) for name, task in tasks.items()})


def names():
    return sorted(path.parent.name for path in IMAGES.glob("*/image.yaml"))


def call(command, tree):
    """What the program of the host printed. Raises ImageError with it if the program failed."""
    environment = dict(os.environ, ASAN_OPTIONS="detect_leaks=0")
    if (tree / "components").is_dir():  # an installed program finds its own
        environment["CHIMERA_PATH"] = str(tree / "components")
    done = subprocess.run(list(map(str, command)), stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          env=environment)
    if done.returncode != 0:
        raise ImageError(f"{' '.join(map(str, command[1:]))}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


class Built:
    """An image for one target. `tree` is a build tree, or a folder that Chimera is installed in."""

    def __init__(self, image, target, tree, out):
        self.image, self.target, self.tree = image, target, tree
        self.out = out / f"{image.name}.{target}"
        self.out.mkdir(parents=True, exist_ok=True)
        self.elf = None

    def _run(self, *words):
        acts = [word for act in self.image.acts for word in ("--at", act)]
        duration = ["--for", self.image.duration] if self.image.duration else []
        return call([self.tree / "bin" / "chimera", *words, *duration, *acts], self.tree)

    def bake(self, *words, out="baked"):
        own = self.image.folder / f"{self.target}.yaml"  # with the resources of this application
        target = own if own.is_file() else self.target
        self._run("bake", self.image.application, "--target", target, "--out", self.out / out, *words)

    def link(self):
        self.elf = build.build(self.out / "baked", self.out, self.board(), self.image.folders)

    def board(self):
        return re.search(r'\.board = "([\w-]+)"', (self.out / "baked" / "tables.cc").read_text())[1]

    def cpu(self):
        return re.search(r"-mcpu=([\w-]+)", (self.out / "baked" / "cpu.flags").read_text())[1]

    def machine(self):
        """QEMU's machine for the target; None: QEMU has none."""
        return build.SIMULATED.get(self.board(), {}).get(self.cpu())

    def periods(self):
        """Of the tasks, in ns."""
        return [task["period_ns"] for task in json.loads((self.out / "baked" / "dictionary.json").read_text())["tasks"]]

    def sizes(self):
        return sizes.table(pathlib.Path(f"{self.elf}.map"))

    def complaints(self):
        return list(sizes.complaints(self.elf))

    def session(self):
        """The running image, to talk to."""
        return qemu.Session(self.machine(), self.elf, self.image.instruction_ns)

    def differences(self, lines):
        """Sentences about what differs from the host: the first difference of the digest or of a receipt, and pairs of
        tasks whose digests are to be equal."""
        path = self.out / "host.digest"
        run = json.loads(self._run("run", self.image.application, "--virtual", "--json", "--digest", path))
        found = digest.of_image(lines)
        difference = (digest.difference(digest.of_host(path.read_text()), found) or
                      receipts.difference(receipts.of_host(run), receipts.of_image(lines)))
        return ([difference] if difference else []) + list(digest.unequal(found, self.image.equal))

    def run(self, limit_s=qemu.LIMIT_S):
        """The lines of the image. Raises ImageError if it does not end by itself."""
        lines, code = qemu.run(self.machine(), self.elf, limit_s, self.image.instruction_ns)
        (self.out / "output.txt").write_text("\n".join(lines) + "\n")
        if code != 0 or not lines or lines[-1] != "end time" or any(line.startswith("warm boot") for line in lines):
            raise ImageError(f"{self.elf}: exit {code}, its last lines:\n  " + "\n  ".join(lines[-5:]))
        return lines


def unpunctual(lines, periods):
    """Sentences about jobs that were not over at the next release of any task: the digest may then differ from that of
    the host, whose jobs take no time. `periods`: of all tasks, in ns."""
    grid = math.gcd(*periods)
    for line in lines:
        found = re.match(r"task (\S+) cycles \d+ missed (\d+) dropped (\d+) faults \d+ response (\d+)", line)
        if found and (found[2] != "0" or found[3] != "0"):
            yield f"task {found[1]} missed {found[2]} deadlines and dropped {found[3]} releases"
        elif found and int(found[4]) >= grid:
            yield f"task {found[1]} ended {int(found[4])} ns after its release, and releases may be {grid} ns apart"
