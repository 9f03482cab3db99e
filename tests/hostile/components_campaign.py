# SPDX-License-Identifier: Apache-2.0
"""Components with flipped bits, in virtual time: each run ends with exit code 0 or 1, a refusal says which file or task
it was, and nothing is left behind. Every fifth time the descriptor is the damaged one.

usage: components_campaign.py --build TREE --seconds N
"""
import collections
import os
import pathlib
import random
import resource
import subprocess
import sys
import tempfile

import campaigns

LOADING = 15  # s, after which a run is asked to end: a method may loop. What does not load is reported after 10 s
TEXT = """subsystem: subject
operator: {x: 1 V}
tasks:
  victim: {component: NAME, rate: 100 Hz, CONSTANTS}
"""
VICTIMS = (("gain", "constants: {k: 2}"), ("lowpass", "constants: {cutoff: 1 Hz}"),
           ("limit", "constants: {low: -1 V, high: 1 V}"))


def damaged(path):
    """The content with one to eight bits flipped."""
    content = bytearray(path.read_bytes())
    for _ in range(random.randint(1, 8)):
        content[random.randrange(len(content))] ^= 1 << random.randrange(8)
    return bytes(content)


class Components:
    def __init__(self, arguments):
        import system
        self.system, self.source = system, pathlib.Path(arguments.build).resolve() / "components"
        self.ends = collections.Counter()
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    def once(self, number):
        name, constants = VICTIMS[number % len(VICTIMS)]
        with tempfile.TemporaryDirectory(prefix="chimera-hostile-") as folder:
            place = pathlib.Path(folder) / "components"
            place.mkdir()
            for ending, is_damaged in ((".so", number % 5 != 4), (".component.json", number % 5 == 4)):
                file = self.source / f"{name}{ending}"
                (place / file.name).write_bytes(damaged(file) if is_damaged else file.read_bytes())
            text = TEXT.replace("NAME", name).replace("CONSTANTS", constants)
            (pathlib.Path(folder) / "subject.yaml").write_text(text)
            return list(self.judge(name, folder, place))

    def judge(self, name, folder, place):
        environment = dict(os.environ, CHIMERA_PATH=str(place), CHIMERA_TEST_MARK=folder)
        run = subprocess.Popen([str(self.system.CHIMERA), "run", "subject.yaml", "--virtual", "--for", "50 ms"],
                               env=environment, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True, errors="replace")
        try:
            out, said = run.communicate(timeout=LOADING)
        except subprocess.TimeoutExpired:
            run.terminate()
            out, said = run.communicate(timeout=self.system.HANG)
        self.ends[run.returncode] += 1
        if run.returncode not in (0, 1):
            yield f"exit {run.returncode}: {said}"
        if run.returncode == 1 and not any(w in said for w in (f"{name}.so", "victim", f"{name}.component.json")):
            yield f"nothing is named: {said!r}, {out!r}"
        if any(ord(c) < 32 and c not in "\n\t" for c in said):
            yield f"steers the terminal: {said!r}"
        left = self.system.processes_of(f"CHIMERA_TEST_MARK={folder}")
        files = {file.name for file in pathlib.Path(folder).iterdir()} - {"components", "subject.yaml"}
        if left or files:
            yield f"left behind: {left} {files}"

    def figures(self):
        return {"ends": self.ends}


if __name__ == "__main__":
    sys.exit(campaigns.run("hostile_components", __doc__, Components))
