# SPDX-License-Identifier: Apache-2.0
"""Tries of the draft and recordings of a machine, asked for as a page asks: each gives what its command gives, is
bounded, and lets nothing but words reach the command."""
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parent.parent / "processes"),
                str(pathlib.Path(__file__).resolve().parent / "harness")]
from machine import PLANT, Machine  # noqa: E402
from protocol_test import JUDGES  # noqa: E402
from system import BUILD, CHIMERA, await_that  # noqa: E402
from wire import Server  # noqa: E402

ENDLESS = """subsystem: endless
tasks:
  stuck: {component: t_crash, rate: 20 Hz, constants: {how: hang}, resources: {armed: "%s"}}
"""
LOGGED = """subsystem: logged
tasks:
  count: {component: t_counter, rate: 20 Hz}
  log: {component: csv_log, rate: 20 Hz, alias: {in: [count]}, resources: {file: "%s"}}
"""
# Steps of a sequence of the plant: the rule that refuses them, line behind `sequence:`, column, what the user reads.
SEQUENCES = [
    (["{switch: work, for: 1 s, else: rset}", "{switch: rest}"], "sequence-step", 1, 36, "did you mean 'rest'?"),
    (["{switch: wrok, for: 1 s}", "{switch: rest}"], "configuration-unknown", 1, 14, "did you mean 'work'?"),
    (["{switch: work, until: sequence_go > 16, within: 1 s}"], "sequence-condition", 1, 27, "write >= for >"),
    (["{switch: work}", "{switch: rest}"], "sequence-wait", 1, 5, "only the last step may stay"),
    (["{name: a, switch: work, until: speed > 1 m/s, within: 1 s, else: b}",
      "{name: b, switch: rest, until: speed > 1 m/s, within: 0 s, else: a}"], "sequence-wait", 2, 59,
     "no circle of steps runs without it")]


def children(pid):
    """The processes whose parent is `pid`."""
    found = []
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            words = stat.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(words[1]) == pid and words[0] != "Z":
            found.append(int(stat.parent.name))
    return found


class Trials(unittest.TestCase):
    def setUp(self):
        self.place = pathlib.Path(tempfile.mkdtemp(prefix="chimera-trials-"))
        self.addCleanup(shutil.rmtree, self.place, ignore_errors=True)
        self.file = self.place / "subject.yaml"
        self.servers = []

    def page(self, text):
        """A page whose draft has this text."""
        self.file.write_text(text)
        self.server = Server(self.file, runtime=self.place, state=self.place / "state")
        self.addCleanup(self.server.__exit__)
        page = self.server.open()
        self.addCleanup(page.__exit__)
        return page

    def begin(self, page, **parameters):
        version = page.call("draft")["version"]
        return page.call("try", version=version, **{"duration": "2 s", "watch": ["n"], **parameters})["number"]

    def result(self, page, number):
        answer = page.ask("result", number=number)
        JUDGES["answer"].validate(answer)
        return answer["result"]

    def ended(self, page, number):
        await_that(lambda: self.result(page, number)["ended"] is not None, f"the end of trial {number}", pause=0.02)
        return self.result(page, number)

    def run_command(self, *words):
        """What `chimera` prints and writes as CSV."""
        csv = self.place / "command.csv"
        done = subprocess.run([CHIMERA, *map(str, words), "--csv", csv], capture_output=True, text=True, check=False,
                              env=dict(os.environ, XDG_RUNTIME_DIR=str(self.place), ASAN_OPTIONS="detect_leaks=0"))
        return done.returncode, done.stdout, csv.read_text()

    def refused(self, page, method, **parameters):
        answer = page.ask(method, **parameters)
        JUDGES["answer"].validate(answer)
        self.assertIn("error", answer, parameters)
        return answer["error"]

    def endless(self):
        """A page whose draft has a cycle without end, and the file that is written when that begins."""
        armed = self.place / "armed"
        armed.touch()
        return self.page(ENDLESS % armed), armed

    def runs(self, number):
        """The processes of that many runs: each has a child that runs the tasks."""
        found = [pid for pid in children(self.server.process.pid) if children(pid)]
        return found if len(found) == number else None

    # Tries

    def test_a_try_is_the_run_of_the_saved_text_to_the_byte(self):
        page = self.page(PLANT.read_text())
        acts, watch = ["1 s: set bias 2 m/s", "1.5 s: switch rest"], ["speed", "torque", "smooth"]
        bound = "max |speed| <= 5 m/s"
        first = self.ended(page, self.begin(page, duration="3 s", watch=watch, at=acts, expect=[bound]))
        words = ("run", self.file, "--virtual", "--json", "--for", "3 s", "--every", "50 ms", "--watch", *watch)
        code, said, table = self.run_command(*words, "--at", *acts, "--expect", bound)
        self.assertEqual(first["csv"], table)
        self.assertEqual((first["output"], first["ended"], first["why"]), (json.loads(said), {"code": code}, None))
        self.assertGreater(len(table.splitlines()), 55)
        edited = PLANT.read_text().replace("k: 2 N.s", "k: 5 N.s")
        page.call("replace", version=1, text=edited)
        second = self.ended(page, self.begin(page, duration="3 s", watch=watch))  # not yet in the file
        self.assertEqual(self.file.read_text(), PLANT.read_text())
        page.call("write", version=page.call("draft")["version"])
        self.assertEqual(second["csv"], self.run_command(*words)[2])
        self.assertNotEqual(first["csv"], second["csv"])

    def test_a_refusal_of_the_run_is_the_answer(self):
        page = self.page(PLANT.read_text())
        done = self.ended(page, self.begin(page, watch=["speed"], at=["1 s: on robot"]))
        self.assertNotEqual(done["ended"], {"code": 0})
        self.assertIn("robot", json.dumps(done["output"]))
        self.assertNotIn("/trials/", json.dumps(done))
        self.assertIsNone(done["csv"])
        page.call("replace", version=1, text=PLANT.read_text().replace("k: 2 N.s", "k: 2 m"))
        faulty = self.ended(page, self.begin(page, watch=["speed"]))
        self.assertFalse(faulty["output"]["legal"])

    def test_a_faulty_sequence_is_refused_with_place_and_remedy_by_page_and_command(self):
        page = self.page(PLANT.read_text())
        first = len(PLANT.read_text().splitlines()) + 1
        for steps, rule, line, column, remedy in SEQUENCES:
            text = PLANT.read_text() + "sequence:\n" + "".join(f"  - {step}\n" for step in steps)
            version = page.call("draft")["version"]
            drafted = page.call("replace", version=version, text=text)["analysis"]
            self.assertEqual(drafted["text"], text)
            page.call("write", version=version + 1)
            checked = subprocess.run([CHIMERA, "check", "--json", self.file], capture_output=True, text=True,
                                     check=False, env=dict(os.environ, ASAN_OPTIONS="detect_leaks=0"))
            faults = json.loads(checked.stdout)["faults"]
            self.assertEqual(checked.returncode, 1)
            self.assertEqual([(fault["rule"], fault["line"], fault["column"]) for fault in faults],
                             [(rule, first + line, column)], steps)
            self.assertIn(remedy, faults[0]["remedy"])
            faults = [{**fault, "offers": []} for fault in faults]
            self.assertEqual(drafted["report"]["faults"], faults)
            tried = self.ended(page, self.begin(page, watch=["speed"]))
            self.assertEqual((tried["ended"], tried["output"]["faults"]), ({"code": 1}, faults))

    def test_what_a_try_opens_is_asked_about_first(self):
        log = self.place / "log.csv"
        page = self.page(LOGGED % log)
        error = self.refused(page, "try", version=1, duration="2 s", watch=["count"])
        self.assertEqual(error["data"]["kind"], "devices")
        self.assertEqual(error["data"]["resources"], [{"task": "log", "port": "file", "text": str(log)}])
        self.assertFalse(log.exists())
        self.assertEqual(self.ended(page, self.begin(page, watch=["count"], devices=True))["ended"], {"code": 0})
        self.assertTrue(log.exists())

    def test_a_try_that_never_ends_is_halted_and_names_the_task(self):
        page, armed = self.endless()
        number = self.begin(page, watch=["y"])
        await_that(lambda: armed.read_text(), "the cycle that does not end")
        self.assertIsNone(self.result(page, number)["ended"])
        page.call("halt", number=number)
        done = self.ended(page, number)
        self.assertEqual(done["why"], "halted")
        self.assertIn("stuck.cycle did not return", json.dumps(done["output"]))

    def test_four_at_a_time_and_none_outlives_its_page_or_chimera_web(self):
        page, _ = self.endless()
        for _ in range(4):
            self.begin(page, watch=["y"])
        with self.server.open() as other:
            error = self.refused(other, "try", version=1, duration="2 s", watch=["y"])
            self.assertEqual(error["data"]["kind"], "under-way")
        before = await_that(lambda: self.runs(4), "four runs")
        page.__exit__()
        await_that(lambda: not set(before) & set(children(self.server.process.pid)), "the end of the page's tries")
        with self.server.open() as other:
            self.begin(other, watch=["y"])
            [last] = await_that(lambda: self.runs(1), "one run")
            run = children(last)
            self.server.process.send_signal(signal.SIGKILL)
            self.server.process.wait()
            await_that(lambda: not any(pathlib.Path(f"/proc/{pid}/exe").exists() for pid in [last, *run]), "their end")

    # Recordings

    def test_a_recording_has_the_columns_of_the_command(self):
        page = self.page(PLANT.read_text())
        with Machine(self.place) as machine:
            number = page.call("scope", machine="plant", channels=["torque", "speed", "bias"], trigger="bias > 1 m/s",
                               pre="100 ms", wait="60 s", **{"for": "200 ms"})["number"]
            values = [2, 0.5]
            while self.result(page, number)["ended"] is None:
                machine.call("set", values={"bias": values[0]})
                values.reverse()
            done = self.result(page, number)
            self.assertEqual(done["ended"], {"code": 0}, done)
            table = self.run_command("scope", "torque", "speed", "bias", "--for", "200 ms", "--subsystem", "plant")[2]
            self.assertEqual(done["csv"].splitlines()[0], table.splitlines()[0])
            times = [float(line.split(",")[0]) for line in done["csv"].splitlines()[1:]]
            self.assertLess(times[0], 0)
            self.assertEqual(len(times), done["output"]["rows"])
            self.assertIn("<svg", done["svg"])
            never = {"machine": "plant", "channels": ["speed"], "trigger": "speed < 0 m/s"}
            number = page.call("scope", **never, wait="50 ms")["number"]
            self.assertIn("no trigger", self.ended(page, number)["output"]["error"]["message"])
            number = page.call("scope", **never)["number"]
            page.call("halt", number=number)
            self.assertEqual(self.ended(page, number)["why"], "halted")

    # Words that are none

    def assert_fail(self, page, numbers, word):
        """The trials of these keys have failed with the word, side by side."""
        for key, number in numbers.items():
            done = self.ended(page, number)
            self.assertNotEqual(done["ended"], {"code": 0}, (key, word))
            self.assertIsNone(done["csv"], (key, word))

    def test_nonsense_is_refused_and_reaches_nothing(self):
        page = self.page(PLANT.read_text())
        before = sorted(path for path in self.place.rglob("*") if "state" not in path.parts)
        stray = self.place / "stray"
        words = ["--csv", f"--csv={stray}", f"--svg={stray}", f"--trace={stray}", "-x", "--", "../../etc/passwd",
                 "/etc/passwd", "$(touch stray)", "`touch stray`", ";touch stray", "a\nb", "é\u202e", "@/etc/passwd",
                 "%s%n", "q[99999999]", "a" * 400, "-", "NaN", "1e999 s", "-1 s"]
        with Machine(self.place):
            for word in words:
                self.assert_fail(page, {key: self.begin(page, **{"watch": ["speed"], key: [word]})
                                        for key in ("watch", "at", "expect")}, word)
                good = {"machine": "plant", "channels": ["speed"], "for": "50 ms", "wait": "50 ms"}
                for keys in ("machine", "channels", "trigger"), ("pre", "for", "wait"):
                    answers = {key: page.ask("scope", **{**good, key: [word] if key == "channels" else word})
                               for key in keys}
                    self.assert_fail(page, {key: answer["result"]["number"] for key, answer in answers.items()
                                            if "result" in answer}, word)
            for word in ("", "a\0b", "a" * 401, "a" * 1_000_000):
                for key in ("watch", "at", "expect", "duration", "every"):
                    bad = [word] if key in ("watch", "at", "expect") else word
                    parameters = {"version": 1, "duration": "1 s", "watch": ["speed"], key: bad}
                    self.assertEqual(self.refused(page, "try", **parameters)["code"], -32602)
                for key in ("machine", "channels", "trigger", "pre", "for", "wait"):
                    bad = [word] if key == "channels" else word
                    parameters = {"machine": "plant", "channels": ["speed"], key: bad}
                    self.assertEqual(self.refused(page, "scope", **parameters)["code"], -32602)
        after = sorted(path for path in self.place.rglob("*") if "state" not in path.parts)
        self.assertEqual([path for path in after if path.name == "stray"], [])
        self.assertEqual([path for path in after if path not in before and "chimera" not in path.parts], [])
        self.assertFalse(pathlib.Path("stray").exists())

    def test_parameters_of_other_kinds_are_refused(self):
        page = self.page(PLANT.read_text())
        seed = random.randrange(1 << 32)
        print(f"seed {seed}")
        chance = random.Random(seed)
        values = [None, True, 0, -1, 1.5, 2 ** 63, "", "x", [], [1], ["x"] * 33, {}, {"a": 1}, [["x"]], "1 s"]
        keys = {"try": ["version", "duration", "watch", "every", "at", "expect", "devices", "file"],
                "scope": ["machine", "channels", "trigger", "pre", "for", "wait", "csv", "svg"],
                "result": ["number", "folder"], "halt": ["number", "signal"]}
        for _ in range(400):
            method = chance.choice(list(keys))
            parameters = {key: chance.choice(values) for key in keys[method] if chance.random() < 0.5}
            answer = page.ask(method, **parameters)
            JUDGES["answer"].validate(answer)
            if "result" in answer:
                self.ended(page, answer["result"]["number"])


if __name__ == "__main__":
    assert BUILD.is_dir()
    unittest.main()
