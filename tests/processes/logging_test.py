# SPDX-License-Identifier: Apache-2.0
"""Row 16 over real processes: a logger whose disk is full or stalls costs rows, which are counted and reported; the
tasks of its rtpu go on."""
import json
import os
import pathlib
import subprocess
import tempfile
import threading
import time
import unittest

from system import CHIMERA, HANG, QUIET, Refused, System, await_that

ROOM, RATE = 50, 200

APPLICATION = f"""
subsystem: subject
rtpus:
  logging: {{cpu: 1, policy: edf}}
tasks:
  counter: {{component: t_counter, rtpu: logging, rate: {RATE} Hz}}
  logger:
    component: csv_log
    rtpu: logging
    rate: {RATE} Hz
    alias: {{in: [count]}}
    constants: {{capacity: {ROOM}}}
    resources: {{file: LOG}}
configurations: {{all: [counter, logger]}}
start: all
"""


class FullPipe:
    """A disk that takes nothing until it is emptied: then it counts the lines it got."""

    def __init__(self, path):
        os.mkfifo(path, 0o600)
        self.end = os.open(path, os.O_RDWR | os.O_NONBLOCK)
        try:
            while True:
                os.write(self.end, bytes(4096))
        except BlockingIOError:
            pass
        self.lines, self.is_over, self.thread = 0, False, threading.Thread(target=self.read)

    def read(self):
        while not self.is_over or self.some():
            if not self.some():
                time.sleep(0.001)

    def some(self):
        try:
            got = os.read(self.end, 65536)
        except BlockingIOError:
            return False
        self.lines += got.count(b"\n")
        return True

    def finish(self):
        self.is_over = True
        if self.thread.ident is not None:
            self.thread.join()
        os.close(self.end)


class Logging(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory(prefix="chimera-log-")
        self.addCleanup(place.cleanup)
        self.place = pathlib.Path(place.name)

    def values(self, system):
        got = system.call("get", variables=["rows", "lost", "disk_error"])["values"]
        return {name: reading["value"] for name, reading in got.items()}

    def end_of_logger(self, system):
        """The counts, which are all rows there were; then what its kill says, as an answer or an event."""
        system.signal("off", "logger")
        values, task, since = self.values(system), system.task("logger"), system.next_event()
        self.assertEqual(values["rows"] + values["lost"], task["cycles"])
        try:
            system.signal("kill", "logger")
        except Refused as refusal:  # a kill that leaves rows behind says so
            return values, str(refusal)
        return values, " ".join(system.texts("fault", since))

    def test_row_16_a_full_disk_costs_rows_that_are_counted_and_no_task(self):
        with System(APPLICATION.replace("LOG", "/dev/full")) as system:
            note = system.await_event(0, "note", task="logger")["text"]
            self.assertEqual(note, f"the disk refuses rows: No space left on device; {ROOM} may wait")
            await_that(lambda: self.values(system)["lost"] > 0, "the first lost row")
            for task in ("counter", "logger"):
                self.assertEqual(system.await_cycles(task)["state"], "ON")
            values, said = self.end_of_logger(system)
            self.assertEqual((values["rows"], values["disk_error"]), (ROOM, 28))
            self.assertIn(f"{ROOM} rows were not written: No space left on device", said)

    def test_row_16_a_stalled_disk_costs_rows_that_are_counted_and_gets_the_others_when_it_goes_on(self):
        pipe = FullPipe(self.place / "log")
        try:
            with System(APPLICATION.replace("LOG", str(self.place / "log"))) as system:
                await_that(lambda: self.values(system)["lost"] > 0, "the first lost row")
                for task in ("counter", "logger"):
                    self.assertEqual(system.await_cycles(task)["state"], "ON")
                pipe.thread.start()
                rows = self.values(system)["rows"]
                await_that(lambda: self.values(system)["rows"] > rows + 10, "rows again")
                values, said = self.end_of_logger(system)
                self.assertIn(f"the file lacks rows: {values['lost']} rows found no room", said)
        finally:
            pipe.finish()
        self.assertEqual(pipe.lines, values["rows"] + 1)  # the first line names the columns

    def run_with(self, log, *words, room=ROOM):
        file = self.place / "subject.yaml"
        file.write_text(APPLICATION.replace(f"capacity: {ROOM}", f"capacity: {room}").replace("LOG", str(log)))
        environment = dict(os.environ, XDG_RUNTIME_DIR=str(self.place), ASAN_OPTIONS=QUIET)
        return subprocess.run([str(CHIMERA), "run", str(file), "--for", "1 s", *words], capture_output=True, text=True,
                              timeout=HANG, env=environment, cwd=self.place)

    def test_lost_rows_are_reported_by_every_kind_of_run(self):
        for words in (("--priority", "0"), ("--priority", "0", "--isolation", "none"), ("--virtual",)):
            with self.subTest(words):
                full = self.run_with("/dev/full", *words)
                self.assertEqual(full.returncode, 1, full.stdout + full.stderr)
                self.assertIn("logger: note: rows are lost from t = ", full.stdout)
                self.assertRegex(full.stdout, r"logger: last fault in kill at .*: \d+ rows were not written: No space")
                (self.place / "log.csv").unlink(missing_ok=True)  # else the rows go to log.2.csv, with a note
                good = self.run_with(self.place / "log.csv", *words, room=10 * RATE)
                self.assertEqual(good.returncode, 0, good.stdout + good.stderr)
                self.assertNotIn("note:", good.stdout)
                self.assertNotIn("last fault", good.stdout)
                head, *rows = (self.place / "log.csv").read_text().splitlines()
                self.assertEqual(head, "t(s),count")
                self.assertTrue(rows)

    def test_lost_rows_are_reported_as_json(self):
        full = self.run_with("/dev/full", "--virtual", "--json")
        self.assertEqual(full.returncode, 1, full.stdout + full.stderr)
        logger = next(task for task in json.loads(full.stdout)["tasks"] if task["task"] == "logger")
        self.assertEqual((logger["state"], logger["last_fault"]["method"]), ("ON", "kill"))
        self.assertTrue(logger["note"].startswith("rows are lost from t = "), logger["note"])


if __name__ == "__main__":
    unittest.main(verbosity=1)
