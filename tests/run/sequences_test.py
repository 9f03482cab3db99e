# SPDX-License-Identifier: Apache-2.0
"""Random sequences in virtual time do what the model of docs/formats/sequence.md says: step, state, failure and time of
each job, and each request for a switch. Persons pause, begin steps, switch, raise the flag and turn tasks OFF.

usage: sequences_test.py                                 fixed seeds
       sequences_test.py --build DIR [--seconds N]       new seeds for that time, or 1,000 (a campaign)
"""
import argparse
import csv
import itertools
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--build", default=os.environ.get("CHIMERA_BUILD"), required="CHIMERA_BUILD" not in os.environ)
parser.add_argument("--seconds", type=float)
parser.add_argument("--seed", type=int)
arguments = parser.parse_args()
os.environ["CHIMERA_BUILD"] = arguments.build
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "processes"))
from sequence_model import DONE, FAILED, INTERRUPTED, PAUSED, RUNS, SWITCHES, WAITS, Model, Seen, Step  # noqa: E402
from system import CHIMERA, HANG  # noqa: E402

MS = 1_000_000  # ns
TICK = 10 * MS  # of the tasks that publish
END = 5000 * MS
SEEDS, RECEIPTS = 40, 500
STATES = {PAUSED, SWITCHES, RUNS, WAITS, INTERRUPTED, FAILED, DONE}  # the first job leaves BEGINS
# Configuration: (its task, the value of `level` while it is in force, text behind the list of tasks).
SETS = {"near": ("one", 1, ""), "far": ("two", 2, ""), "park": ("three", 3, ", safe_when: 'wish >= 2 m'"),
        "tool": ("four", 4, "")}
WATCHED = ("sequence_step", "sequence_state", "sequence_failed", "sequence_waited")


def course(now):
    """Two saw teeth of 1 s and amplitude 1, the second one around 5. `on` has the value of 0, a job that of its end."""
    tooth = ((now + TICK) / 1e9 + 0.5) % 1 * 2 - 1
    return tooth, 5 + tooth


class Case:
    """A sequence by seed: its steps, its text and the acts of persons."""

    def __init__(self, seed):
        chance = self.chance = random.Random(seed)
        self.period = chance.choice((5, 10, 20, 50)) * MS
        self.is_apart = chance.random() < 0.3  # on an rtpu of its own
        self.is_preemptive = chance.random() < 0.3
        # A job of the sequence comes behind those that publish at the same instant, if its deadline is not earlier.
        self.is_behind = not self.is_apart and self.period >= TICK
        self.repeats = chance.random() < 0.4
        n = chance.randint(1, 16)
        self.steps = [self.step(i, n) for i in range(n)]
        self.initial_go = chance.choice((None, None, None, None, 0, chance.randint(1, n)))
        times = chance.sample(range(END // MS), chance.choice((0, 2, 6, 20)))
        self.acts = [self.act(at * MS + 3 * MS // 10) for at in sorted(times)]

    def duration(self):
        return self.chance.choice((1, 5, 40, 200, 1500)) * MS + self.chance.randrange(40 * MS)

    def step(self, i, n):
        chance = self.chance
        step = Step(chance.choice(list(SETS)), confirm=chance.random() < 0.1, reentry=chance.random() < 0.3)
        kind = chance.random()
        if kind < 0.6:
            step.until, step.within = self.condition(), self.duration()
        elif kind < 0.95 or i + 1 < n or self.repeats:
            step.wait = self.duration()
        if step.until is None and chance.random() < 0.5:
            step.within = self.duration()
        if chance.random() < 0.6:
            step.otherwise = chance.randrange(n)
        return step

    def condition(self):
        variable = self.chance.choice(("level", "wish", "course[0]", "course[1]"))
        relation = self.chance.choice(("<", "<=", ">", ">=", "==", "!="))
        level = self.chance.randint(0, 4)
        if variable.startswith("course"):  # never at a value that it has
            level = self.chance.randint(-12, 12) / 10 + 0.0137 + (5 if variable == "course[1]" else 0)
        return variable, relation, level

    def act(self, at):
        """(time in ns, kind, word). No act comes at the instant of a job."""
        kind = self.chance.choice(("go", "go", "go", "switch", "flag", "flag", "wish", "wish", "off", "on"))
        word = {"go": lambda: self.chance.randint(0, min(16, len(self.steps) + 1)),
                "switch": lambda: self.chance.choice(list(SETS)),
                "flag": lambda: self.chance.choice(("up", "down", "down")), "wish": lambda: self.chance.randint(0, 4),
                "off": lambda: self.chance.choice(("one", "two", "three", "sequence")),
                "on": lambda: self.chance.choice(("one", "two", "three", "sequence", "sequence"))}[kind]()
        return at, kind, word

    # ---- the text

    def text(self):
        signal = "  %s: {component: signal_generator, rate: 100 Hz, alias: {y: %s}, constants: {%s}}\n"
        text = "subsystem: subject\nrtpus:\n  servo: {cpu: 0}\n  brain: {cpu: 1}\ntasks:\n"
        text += signal % ("clock", "course", "wave: sawtooth, amplitude: [1 m, 1 m], offset: [0 m, 5 m]")
        for task, level, _ in SETS.values():
            text += signal % (task, "level", f"amplitude: 0 m, offset: {level} m")
        text += "  watch: {component: gain, rate: 10 Hz, alias: {x: wish, y: seen}, constants: {k: 1}}\n"
        text += "configurations:\n"
        for name, (task, _, more) in SETS.items():
            text += f"  {name}: {{tasks: [clock, watch, {task}]{more}}}\n"
        go = "" if self.initial_go is None else f"  sequence_go: {self.initial_go}\n"
        text += f"operator:\n  wish: 1 m\n{go}sequence:\n  rate: {1000 * MS // self.period} Hz\n"
        text += f"  rtpu: {'brain' if self.is_apart else 'servo'}\n"
        text += f"  repeat: {str(self.repeats).lower()}\n  steps:\n"
        return text + "".join(f"    - {{{self.step_text(i, step)}}}\n" for i, step in enumerate(self.steps))

    def step_text(self, i, step):
        words = [f"name: s{i}", f"switch: {step.configuration}"]
        if step.until:
            words.append(f"until: '{step.until[0]} {step.until[1]} {step.until[2] * 1000:g} mm'")
        if step.wait:
            words.append(f"for: {step.wait} ns")
        if step.within != Step("").within:
            words.append(f"within: {step.within} ns")
        if step.otherwise is not None:
            words.append(f"else: s{step.otherwise}")
        return ", ".join(words + [f"{key}: true" for key in ("confirm", "reentry") if getattr(step, key)])

    def words(self):
        form = {"go": "set sequence_go %s", "wish": "set wish %s m"}
        for at, kind, word in self.acts:
            yield from ("--at", f"{at} ns: " + (form[kind] % word if kind in form else f"{kind} {word}"))
        if self.is_preemptive:
            yield "--preemptive"
        for name in WATCHED:
            yield from ("--watch", name)
        for name in ("near", "far") * RECEIPTS:  # behind the last job: for each the run keeps one receipt more
            yield from ("--at", f"{END - 1} ns: switch {name}")

    # ---- the run

    def run(self, place):
        """The rows of the run, and its receipts."""
        (place / "subject.yaml").write_text(self.text())
        done = subprocess.run([CHIMERA, "run", "subject.yaml", "--virtual", "--json", "--for", f"{END} ns", "--every",
                               f"{self.period} ns", "--csv", "rows.csv", *self.words()], cwd=place, text=True,
                              capture_output=True, env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0"},
                              stdin=subprocess.DEVNULL, timeout=HANG, check=False)
        if done.returncode != 0:
            raise AssertionError(done.stdout + done.stderr)
        with open(place / "rows.csv", encoding="utf-8") as file:
            rows = [[float(word) for word in row] for row in list(csv.reader(file))[1:]]
        answer = json.loads(done.stdout)
        receipts = answer["receipts"]
        assert not answer["receipts_left_out"] or receipts[-1]["asked_ns"] == END - 1, "RECEIPTS is too small"
        return rows, receipts


class Plant:
    """What a job of the sequence sees, from the acts and from the receipts of the switches that were done."""

    def __init__(self, case, receipts):
        self.case, self.on = case, {"clock", "watch", "sequence", SETS["near"][0]}
        self.flag, self.in_force, self.on_at = False, "near", None
        self.go, self.wish = case.initial_go if case.initial_go is not None else 1, (0, 1)
        done = [(each[time], kind, each["tasks"]) for each in receipts if each["end"] == "done"
                for time, kind in (("armed_ns", "armed"), ("at_ns", "done")) if each[time] is not None]
        self.events = sorted(case.acts + done, key=lambda event: event[0])
        # A switch keeps `on` out until its change, or its end.
        self.switches = [(each["asked_ns"], each["at_ns"] if each["end"] == "done" else each["ended_ns"])
                         for each in receipts if each["end"] in ("done", "aborted")]

    def until(self, now):
        """Carries out what comes before the job at `now`."""
        while self.events and self.events[0][0] <= now:
            at, kind, word = self.events.pop(0)
            getattr(self, "do_" + kind)(at, word)

    def do_go(self, _, word):
        self.go = word

    def do_wish(self, at, word):
        self.wish = (at, word)

    def do_switch(self, *_):
        """Its receipt says when it is done."""

    def do_flag(self, _, word):
        self.flag = word == "up"

    def do_armed(self, at, tasks):
        if ("sequence", "arrives") in [(one["task"], one["move"]) for one in tasks]:
            self.on_at = at

    def do_done(self, _, tasks):
        self.on |= {one["task"] for one in tasks if one["move"] == "arrives"}
        self.on -= {one["task"] for one in tasks if one["move"] == "leaves"}
        self.name()

    def do_off(self, _, task):
        self.on.discard(task)
        self.name()

    def do_on(self, at, task):
        if any(begin <= at < end for begin, end in self.switches):
            return
        if task not in self.on and (task == "sequence" or self.level() is None):
            self.on.add(task)
            self.on_at = at if task == "sequence" else self.on_at
        self.name()

    def level(self):
        return next((level for task, level, _ in SETS.values() if task in self.on), None)

    def name(self):
        present = [name for name, (task, *_) in SETS.items() if task in self.on]
        self.in_force = present[0] if len(present) == 1 and "sequence" in self.on else ""

    def see(self, now):
        go, self.go = self.go, None
        return Seen(now, self.in_force, self.flag, go, lambda variable: self.read(variable, now))

    def read(self, variable, now):
        if variable == "wish":
            return self.wish
        published = now // TICK * TICK
        if published == now and not self.case.is_behind:
            published -= TICK
        if variable == "level":
            return None if self.level() is None else (published, self.level())
        return published, course(published)[int(variable[7])]


def judge_requests(asked, receipts, until):
    """A request waits while a switch is under way, and the last one stands; the same one counts again after 100 ms."""
    own = [(each["asked_ns"], each["to"]) for each in receipts
           if each["asked_by"] == {"task": "sequence"} and each["asked_ns"] < until]
    busy = [(each["asked_ns"], each["ended_ns"] or END) for each in receipts if each["end"] != "refused"]
    for at, to in own:
        if [name for now, name in asked if now <= at][-1:] != [to]:
            return f"a request for {to} at {at / 1e9} s, which the model has not; it has {asked}"
    for number, (now, name) in enumerate(asked):
        is_free = not any(begin < now + MS and now < end for begin, end in busy if begin // MS != now // MS)
        is_new = all(now - before >= 100 * MS for before, to in asked[:number] if to == name)
        if is_free and is_new and not any(now <= at < now + MS and to == name for at, to in own):
            return f"no request for {name} at {now / 1e9} s, which the model has; there are {own}"
    return ""


def compare(seed):
    """("" if the run of this seed and the model agree, else the difference, the text and the acts; states shown)."""
    case = Case(seed)
    with tempfile.TemporaryDirectory() as folder:
        rows, receipts = case.run(pathlib.Path(folder))
    plant, model = Plant(case, receipts), Model(case.steps, case.repeats)
    asked, shown, visited = [], model.shown(0), set()
    fault = "" if len(rows) == END // case.period else f"{len(rows)} rows"
    for number, row in enumerate(rows[:-1]):  # the end of the run may come before the last sample
        now = number * case.period
        if "sequence" in plant.on:
            request = model.job(plant.see(now))
            asked += [] if request is None else [(now, request)]
            shown = model.shown(now)
            visited.add(model.state)
        plant.until(now + case.period)
        if plant.on_at is not None:
            model.turned_on(plant.on_at)
            shown, plant.on_at = model.shown(plant.on_at), None
        if row[1:4] != shown[:3] or abs(row[4] - shown[3]) > 1e-9:
            fault = fault or f"job at {now / 1e9} s: {row[1:]}; the model {shown}"
    fault = fault or judge_requests(asked, receipts, now + case.period)
    acts = "\n".join(f"{at / 1e9} {kind} {word}" for at, kind, word in case.acts)
    return f"seed {seed}: {fault}\n{case.text()}{acts}\npreemptive: {case.is_preemptive}\n" if fault else "", visited


def seeds():
    """Of the campaign until its time is over, or the fixed ones."""
    if arguments.seed is not None:
        return [arguments.seed]
    if "--build" not in sys.argv:
        return range(SEEDS)
    first, end = random.randrange(1 << 40), time.monotonic() + (arguments.seconds or 0)
    return itertools.takewhile(lambda seed: time.monotonic() < end if arguments.seconds else seed < first + 1000,
                               itertools.count(first))


def main():
    n, faults, visited = 0, 0, set()
    for seed in seeds():
        fault, states = compare(seed)
        n, faults, visited = n + 1, faults + bool(fault), visited | states
        if fault:
            print(fault, flush=True)
    if n >= SEEDS and visited != STATES:
        faults += 1
        print(f"states {sorted(visited)}: the sequences do not show what they are to show")
    print(json.dumps({"name": "sequence", "n": n, "faults": faults}))
    return faults != 0


if __name__ == "__main__":
    sys.exit(main())
