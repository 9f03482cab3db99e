# SPDX-License-Identifier: Apache-2.0
"""Strangers' files: components that steer a terminal, are no ordinary files, end their process when they are loaded,
or hide another of their name."""
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "processes"))
from system import BUILD, CHIMERA, HANG, QUIET, System  # noqa: E402

COMPONENTS = BUILD / "components"
ESCAPES = "\u001b]0;owned\u0007\u001b[2J\u202eevil\u009b2J\u200b\u2028\u007f"
STEERS = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufeff]")
ONE = "subsystem: subject\ntasks:\n  a: {component: NAME, rate: 100 Hz}\n"


class Files(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="chimera-hostile-"))
        self.addCleanup(shutil.rmtree, self.folder, True)
        self.path = self.folder / "path"
        self.path.mkdir()
        self.environment = dict(os.environ, CHIMERA_PATH=str(self.path), XDG_RUNTIME_DIR=str(self.folder),
                                ASAN_OPTIONS=QUIET)

    def chimera(self, *words, text=None, **environment):
        """(exit code, standard output, standard error); FILE is the description with that text."""
        file = self.folder / "subject.yaml"
        if text is not None:
            file.write_text(text)
        done = subprocess.run([str(CHIMERA), *(str(file) if word == "FILE" else str(word) for word in words)],
                              env=dict(self.environment, **environment), cwd=self.folder, capture_output=True,
                              timeout=HANG, stdin=subprocess.DEVNULL)
        return done.returncode, done.stdout.decode(), done.stderr.decode()

    def stranger(self, name="stranger", like="t_source", **changes):
        """A component that was copied and its descriptor changed."""
        descriptor = json.loads((COMPONENTS / f"{like}.component.json").read_text())
        descriptor.update(changes)
        descriptor.pop("fingerprint")
        (self.path / f"{name}.component.json").write_text(json.dumps(dict(descriptor, name=name)))
        shutil.copy(COMPONENTS / f"{like}.so", self.path / f"{name}.so")
        return descriptor

    def test_text_of_a_component_does_not_steer_the_terminal(self):
        was = self.stranger(doc=ESCAPES, source=ESCAPES)
        was["ports"][0]["doc"] = ESCAPES
        self.stranger(doc=ESCAPES, source=ESCAPES, ports=was["ports"])
        (self.path / "stranger.md").write_text(f"# stranger\n\n{ESCAPES}\n")
        (self.path / "b\u202ead\x1b[2J.component.json").write_text("{}")
        for words in (("list",), ("describe", "stranger"), ("check", "FILE"),
                      ("run", "FILE", "--virtual", "--for", "1 s")):
            code, out, err = self.chimera(*words, text=ONE.replace("NAME", "stranger"))
            self.assertNotRegex(out + err, STEERS, words)
            self.assertIn("evil" if words[0] in ("list", "describe") else "", out)
        for words in (("list", "--json"), ("describe", "stranger", "--json")):
            _, out, _ = self.chimera(*words)
            self.assertNotRegex(out, STEERS, words)
            found = json.loads(out)
            found = found if "doc" in found else next(c for c in found["components"] if c["name"] == "stranger")
            self.assertEqual(found["doc"], ESCAPES, "JSON keeps what was said")

    def test_a_path_that_cannot_be_looked_at_is_refused_by_name(self):
        loop, closed, file = self.folder / "loop", self.folder / "closed", self.folder / "file"
        loop.symlink_to(loop)
        file.write_text("")
        (closed / "inside").mkdir(parents=True)
        closed.chmod(0)
        self.addCleanup(closed.chmod, 0o700)
        good = "subsystem: subject\ntasks:\n  a: {component: t_source, rate: 100 Hz}\n"
        for bad in (loop, loop / "x", file / "x", self.folder / ("n" * 256), closed / "inside" / "x"):
            reads = [("check", bad), ("run", bad, "--virtual", "--for", "1 s"), ("test", bad), ("test", f"{bad}/x.so"),
                     ("test", f"{bad}.cases.yaml"), ("schedule", bad), ("new", "app", bad),
                     ("sweep", bad, "--over", "k = [1]", "--for", "10 ms", "--measure", "max v")]
            writes = [("run", "FILE", "--virtual", "--for", "10 ms", "--trace", bad)]
            for words in reads + (writes if os.geteuid() != 0 or closed not in bad.parents else []):
                with self.subTest(bad=str(bad)[-20:], words=words):
                    code, _, err = self.chimera(*words, text=good)
                    self.assertEqual(code, 1, err)
                    self.assertIn(str(bad)[:60], err)
            with self.subTest(CHIMERA_PATH=str(bad)[-20:]):
                code, _, err = self.chimera("check", "FILE", text=good.replace("t_source", "nothing"),
                                            CHIMERA_PATH=str(bad))
                self.assertEqual(code, 1, err)
                self.assertIn(f"CHIMERA_PATH names {bad}, which ", err)
                self.assertEqual(self.chimera("list", CHIMERA_PATH=str(bad))[0], 0)
        code, _, err = self.chimera("test", self.folder)  # passes over the loop and the closed folder
        self.assertEqual((code, "there are no tests" in err), (1, True), err)

    def test_only_ordinary_files_are_read(self):
        (self.path / "real").mkdir()
        listening = socket.socket(socket.AF_UNIX)
        self.addCleanup(listening.close)
        os.mkfifo(self.path / "pipe.component.json")
        os.mkfifo(self.path / "buildable.txt")
        (self.path / "zero.component.json").symlink_to("/dev/zero")
        (self.path / "folder.component.json").mkdir()
        listening.bind(str(self.path / "socket.component.json"))
        for words in (("list",), ("check", "FILE"), ("run", "FILE", "--virtual", "--for", "10 ms")):
            code, _, err = self.chimera(*words, text=ONE.replace("NAME", "t_source"))
            if words == ("list",):
                for name, kind in (("pipe", "pipe"), ("zero", "device"), ("folder", "folder"), ("socket", "socket")):
                    self.assertIn(f"{name}.component.json: error: is no ordinary file but a {kind}", err)
        for make in (os.mkfifo, lambda place: place.symlink_to("/dev/zero"), pathlib.Path.mkdir):
            self.stranger()
            (self.path / "stranger.so").unlink()
            make(self.path / "stranger.so")
            for words in (("check", "FILE"), ("run", "FILE", "--virtual", "--for", "10 ms"), ("test", "stranger"),
                          ("run", "FILE", "--for", "10 ms", "--priority", "0")):
                code, out, err = self.chimera(*words, text=ONE.replace("NAME", "stranger"))
                self.assertEqual(code, 1, (words, out, err))
                self.assertIn("is no ordinary file but a ", out + err, words)
            place = self.path / "stranger.so"
            place.rmdir() if place.is_dir() else place.unlink()
        with open(self.path / "stranger.so", "wb") as large:
            large.truncate(300 << 20)
        self.assertIn("has 314572800 bytes; at most 268435456 are read", self.chimera("check", "FILE")[2])

    def test_only_ordinary_files_that_a_command_names_are_read(self):
        pipe = self.folder / "pipe.yaml"
        os.mkfifo(pipe)
        os.mkfifo(self.folder / "subject.cases.yaml")
        self.stranger()
        for words in (("check", pipe), ("run", pipe, "--virtual", "--for", "1 s"),
                      ("test", self.folder / "subject.cases.yaml"),
                      ("schedule", "FILE", "--profile", pipe), ("test", "stranger", "--inputs", pipe),
                      ("test", "stranger", "--setup", pipe), ("check", "/dev/zero")):
            code, out, err = self.chimera(*words, text=ONE.replace("NAME", "t_source"))
            self.assertEqual(code, 1, (words, out, err))
            self.assertIn("is no ordinary file but a ", out + err, words)

    def test_only_ordinary_files_of_a_component_are_read(self):
        os.mkfifo(self.folder / "pipe")
        text = ONE.replace("NAME", "csv_player").replace(
            "rate: 100 Hz", f"rate: 100 Hz, resources: {{file: {self.folder}/pipe}}, alias: {{out: [y]}}")
        text += "  b: {component: t_recorder, rate: 100 Hz, alias: {x: y, y: z}}\n"
        code, out, err = self.chimera("run", "FILE", "--virtual", "--for", "10 ms", text=text)
        self.assertEqual(code, 1, out + err)
        self.assertIn(f"{self.folder}/pipe: is no ordinary file but a pipe", err)

    def test_a_component_that_ends_the_process_while_it_loads_is_named(self):
        text = ONE.replace("NAME", "t_load") + "operator: {unused: 1 V}\n"
        so = re.escape(str(COMPONENTS / "t_load.so"))
        ends = {"segv": r"ended by signal 11 \(SIGSEGV\)", "abort": r"ended by signal 6 \(SIGABRT\)",
                "exit": "ended with status 0"}
        (self.folder / "subject.cases.yaml").write_text("cases:\n  one: {for: 100 ms, expect: ['y == 0']}\n")
        environment = {"CHIMERA_PATH": str(COMPONENTS)}
        for how, said in ends.items():
            for place, what in (("load", f"while it loaded {so}, the component of task 'a'"),
                                ("construct", f"while it constructed a state of {so}, the component of task 'a'"),
                                ("init", "in a.init"), ("cycle", "in a.cycle"))[:4 if how == "segv" else 1]:
                code, out, err = self.chimera("run", "FILE", "--virtual", "--for", "1 s", text=text,
                                              CHIMERA_TEST_LOAD=f"{place} {how}", **environment)
                self.assertEqual(code, 1, (place, how, out, err))
                where = "FAILED: a" if what.startswith("in ") else ".*subject.yaml: error"
                self.assertRegex(err, rf"(?m)^{where}: the run {said} {what}$")
            told = rf"{said} while it loaded {so}, the component of task 'a'"
            for words in (("test", self.folder),
                          ("sweep", "FILE", "--over", "unused = 1 V, 2 V", "--for", "10 ms", "--measure", "end y"),
                          ("run", "FILE", "--virtual", "--for", "1 s", "--json"))[0 if how == "exit" else 2:]:
                code, out, err = self.chimera(*words, CHIMERA_TEST_LOAD=f"load {how}", **environment)
                self.assertEqual(code, 1, (words, out, err))
                self.assertRegex(out + err, told, words)

    def test_real_time_names_the_object(self):
        system = System(ONE.replace("NAME", "t_load"), ("--for", "5 s"), wait=False,
                        environment={"CHIMERA_TEST_LOAD": "load segv"})
        with system:
            self.assertEqual(system.wait(), 1)
            self.assertRegex(system.said(), r"main ended 4 times in 10 s and is not restarted: it ended by signal 11 "
                                            r"\(SIGSEGV\) while it loaded \S+/t_load.so, the component of task 'a'")

    def test_the_operator_still_ends_a_run_in_virtual_time(self):
        for how in ("terminal", "kill"):
            file = self.folder / "subject.yaml"
            file.write_text(ONE.replace("NAME", "t_source"))
            run = subprocess.Popen([str(CHIMERA), "run", str(file), "--virtual", "--for", "1000 h", "--watch", "x",
                                    "--every", "1 s"],
                                   env=dict(self.environment, CHIMERA_PATH=str(COMPONENTS)), start_new_session=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.assertTrue(any(line.startswith(b"t ") for line in run.stdout), "no run is under way")
            os.killpg(run.pid, signal.SIGINT) if how == "terminal" else run.send_signal(signal.SIGTERM)  # still ours
            out, err = run.communicate(timeout=HANG)
            self.assertEqual(run.returncode, 0, (out, err))
            self.assertIn(b"ended by the operator", out)

    def test_a_component_that_hides_one_of_the_library_is_reported(self):
        self.stranger(name="t_source")
        text = ONE.replace("NAME", "t_source")
        for words in (("check", "FILE"), ("run", "FILE", "--virtual", "--for", "10 ms")):
            code, _, err = self.chimera(*words, text=text)
            self.assertEqual(code, 0, err)
            self.assertIn(f"subject.yaml: note: component 't_source' is that of {self.path}/t_source.component.json, "
                          f"which CHIMERA_PATH names before {COMPONENTS}/t_source.component.json\n", err)
        self.assertEqual(len(json.loads(self.chimera("check", "FILE", "--json")[1])["notes"]), 1)
        self.environment["CHIMERA_PATH"] = str(COMPONENTS)
        self.assertEqual(json.loads(self.chimera("check", "FILE", "--json")[1])["notes"], [])


if __name__ == "__main__":
    unittest.main()
