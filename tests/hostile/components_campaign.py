# SPDX-License-Identifier: Apache-2.0
"""Components with flipped bits, in virtual time: each run ends with exit code 0 or 1, a refusal says which file or task
it was, and nothing is left behind. Every fifth time the descriptor is the damaged one. Its last line says how often.

usage: components_campaign.py --build TREE --seconds N [--seed S] [--most N]
"""
import argparse
import collections
import json
import os
import pathlib
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import time

LOADING = 15  # s, after which a run is asked to end: a method may loop. What does not load is reported after 10 s
HANG = 60
VICTIMS = ("gain", "lowpass", "limit")
TEXT = """subsystem: subject
operator: {x: 1 V}
tasks:
  victim: {component: victim, rate: 100 Hz, CONSTANTS}
"""
CONSTANTS = {"gain": "constants: {k: 2}", "lowpass": "constants: {cutoff: 1 Hz}",
             "limit": "constants: {low: -1 V, high: 1 V}"}


def damage(whole, chance, first):
    """`whole` with one to eight bits flipped, from byte `first` on."""
    bytes_ = bytearray(whole)
    for _ in range(chance.randint(1, 8)):
        bytes_[chance.randrange(first, len(bytes_))] ^= 1 << chance.randrange(8)
    return bytes(bytes_)


def left_behind(mark):
    """Processes that carry the mark."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and mark.encode() in (entry / "environ").read_bytes():
                found.append(int(entry.name))
        except OSError:
            pass
    return found


class Attempts:
    def __init__(self, build, folder, seed):
        self.build, self.folder = build, folder
        self.chance = random.Random(seed)
        self.place = folder / "components"
        self.place.mkdir()
        self.file = folder / "subject.yaml"
        self.mark = f"CHIMERA_TEST_MARK={folder}"
        self.environment = dict(os.environ, CHIMERA_PATH=str(self.place), CHIMERA_TEST_MARK=str(folder))
        self.ends = collections.Counter()

    def one(self, number):
        """What was wrong with the attempt; "" when nothing was."""
        name = VICTIMS[number % len(VICTIMS)]
        source = self.build / "components"
        whole = (source / f"{name}.so").read_bytes()
        sheet = (source / f"{name}.component.json").read_bytes()
        if number % 5 == 4:
            sheet = damage(sheet, self.chance, 0)
        else:
            whole = damage(whole, self.chance, 0)
        (self.place / f"{name}.so").write_bytes(whole)
        (self.place / f"{name}.component.json").write_bytes(sheet)
        text = TEXT.replace("component: victim", f"component: {name}")
        self.file.write_text(text.replace("CONSTANTS", CONSTANTS[name]))
        wrong = self.judge(name)
        for file in self.place.iterdir():
            file.unlink()
        return wrong

    def judge(self, name):
        command = [str(self.build / "bin/chimera"), "run", str(self.file), "--virtual", "--for", "50 ms"]
        done = subprocess.Popen(command, env=self.environment, cwd=self.folder, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        try:
            out, err = self.output(done)
        except subprocess.TimeoutExpired:
            done.kill()
            done.communicate()
            return "did not end, not even when it was asked to"
        said = err.decode(errors="replace")
        self.ends[self.kind(done.returncode, said)] += 1
        if done.returncode not in (0, 1):
            return f"exit {done.returncode}: {said}"
        named = any(word in said for word in (f"{name}.so", "victim", f"{name}.component.json"))
        if done.returncode == 1 and not named:
            return f"nothing is named: {said!r}, {out.decode(errors='replace')!r}"
        if any(ord(c) < 32 and c not in "\n\t" for c in said):
            return f"steers the terminal: {said!r}"
        left = left_behind(self.mark)
        files = {file.name for file in self.folder.iterdir()} - {"components", "subject.yaml"}
        return f"left behind: {left} {files}" if left or files else ""

    @staticmethod
    def output(run):
        """Of a run that ends; one that loops in a method is asked to, as its operator would."""
        try:
            return run.communicate(timeout=LOADING)
        except subprocess.TimeoutExpired:
            run.terminate()
            return run.communicate(timeout=HANG)

    @staticmethod
    def kind(code, said):
        if code == 0:
            return "ran"
        return "died and was named" if "the run ended by" in said or "the run did not end" in said else "refused"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--most", type=int, default=sys.maxsize)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(1 << 32))
    arguments = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    folder = pathlib.Path(tempfile.mkdtemp(prefix="chimera-hostile-"))
    attempts = Attempts(arguments.build.resolve(), folder, arguments.seed)
    n = faults = 0
    end = time.monotonic() + arguments.seconds
    while n == 0 or (n < arguments.most and time.monotonic() < end):
        wrong = attempts.one(n)
        n += 1
        if wrong:
            faults += 1
            print(f"seed {arguments.seed}, attempt {n}: {wrong}", flush=True)
    shutil.rmtree(folder)
    print(json.dumps({"name": "hostile_components", "n": n, "faults": faults, "seed": arguments.seed,
                      "ends": attempts.ends}))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
