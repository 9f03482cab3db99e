# SPDX-License-Identifier: Apache-2.0
"""Output is not control: if the places to which a run prints are lost, or the process that prints, the application runs
on to its end, and the loss is reported where that is still possible, with exit code 1."""
import concurrent.futures
import contextlib
import json
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "processes"))
from system import BUILD, CHIMERA, HANG, QUIET, RTPUS, TWO_RTPUS, System, await_that  # noqa: E402

RUN = ("--for", "4 s", "--expect", "count >= 1", "--watch", "count", "--every", "50 ms")

# A logger whose pipe has no reader: `init` never comes back.
LOGGING = RTPUS + """
tasks:
  wave: {component: t_source, rtpu: first, rate: 100 Hz, alias: {x: w}}
  log: {component: csv_log, rtpu: second, rate: 100 Hz, alias: {in: [w]}, resources: {file: PIPE}}
configurations: {all: [wave, log]}
start: all
"""


def is_sanitized():
    return "CHIMERA_SANITIZE:STRING=address" in (BUILD / "CMakeCache.txt").read_text()


@contextlib.contextmanager
def gone(kind):
    """A standard output that cannot be written: a descriptor for the child."""
    if kind in ("full", "closed"):
        with open("/dev/full", "wb") as full:
            yield full
    else:
        reader, writer = os.pipe()
        if kind == "broken":
            os.close(reader)
        try:
            yield writer
        finally:
            os.close(writer)
            if kind != "broken":
                os.close(reader)


def fill(pipe):
    os.set_blocking(pipe, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(pipe, bytes(4096))
    os.set_blocking(pipe, True)


def command(*words, **options):
    return subprocess.run([str(CHIMERA), *words], capture_output="stdout" not in options, text=True, timeout=HANG,
                          env=dict(os.environ, ASAN_OPTIONS=QUIET), **options)


class OutputIsNotControl(unittest.TestCase):
    def run_with(self, kind, *more):
        """A run whose standard output is of that kind; its exit code, its length and what stood on standard error."""
        with gone(kind) as lost:
            close = (lambda: os.close(1)) if kind == "closed" else None
            with System(TWO_RTPUS, (*RUN, *more), popen={"stdout": lost, "preexec_fn": close}) as system:
                if kind == "stuck":  # the reader has stopped reading
                    fill(lost)
                told = None if kind == "stuck" else system.await_event(0, "output-lost")["text"]
                face = system.call("status")["face"]
                return {"code": system.wait(), "told": told, "face": face, "said": system.said()}

    def test_the_run_goes_on_when_standard_output_is_lost(self):
        reasons = {"full": "No space left on device", "closed": "Bad file descriptor", "broken": "Broken pipe",
                   "stuck": "no process reads it"}
        with concurrent.futures.ThreadPoolExecutor() as pool:
            runs = {kind: pool.submit(self.run_with, kind) for kind in reasons}
        for kind, run in runs.items():
            with self.subTest(kind):
                got = run.result()
                self.assertEqual(got["code"], 1, got["said"])
                self.assertIn(f"standard output is lost ({reasons[kind]}", got["said"])
                self.assertIn("clean", got["said"], "the verdict stands where it still can")
                if kind == "stuck":  # it might still be read
                    continue
                self.assertIn(reasons[kind], got["told"])
                self.assertIn(reasons[kind], got["face"]["lost_output"])

    def test_standard_error_may_be_gone_too(self):
        with gone("full") as lost, System(TWO_RTPUS, RUN, popen={"stdout": lost, "stderr": lost}) as system:
            system.await_event(0, "output-lost")
            system.await_cycles("steady")
            self.assertEqual(system.wait(), 1)

    def test_a_run_in_one_process_or_in_virtual_time_comes_to_its_end_too(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "subject.yaml"
            file.write_text(TWO_RTPUS.replace("rtpu: second", "rtpu: first"))
            for how in (("--virtual", "--for", "60 s"), ("--isolation", "none", "--priority", "0", "--for", "0.2 s")):
                for kind in ("full", "broken"):
                    with self.subTest(how=how[0], kind=kind), gone(kind) as lost:
                        saved = pathlib.Path(folder) / f"{how[0]}-{kind}"
                        got = command("run", str(file), *how, "--profile", str(saved), "--watch", "count", stdout=lost,
                                      stderr=subprocess.PIPE)
                        self.assertEqual(got.returncode, 1, got.stderr)
                        self.assertIn("standard output is lost", got.stderr)
                        self.assertEqual(json.loads(saved.read_text())["subsystem"], "subject", "it came to its end")

    def test_files_that_cannot_be_written_whole_are_named(self):
        with System(TWO_RTPUS, ("--for", "0.2 s", "--trace", "/dev/full"), wait=False) as system:
            self.assertEqual(system.wait(), 1)
            self.assertIn("No space left on device", system.said())

    def test_one_answer_that_is_lost_is_exit_code_1(self):
        for words in (("list",), ("describe", "t_counter"), ("run", "--help"), ("--version",)):
            with self.subTest(words), gone("full") as lost:
                got = command(*words, stdout=lost, stderr=subprocess.PIPE)
                self.assertEqual(got.returncode, 1)
                self.assertIn("standard output is lost (No space left on device", got.stderr)
        for words in (("list",), ("run", "--help")):
            with self.subTest(words), gone("broken") as lost:  # as of `cat`: silent, unless SIGPIPE is ignored
                got = command(*words, stdout=lost, stderr=subprocess.PIPE)
                self.assertEqual((got.returncode, got.stderr), (-signal.SIGPIPE, ""))
                got = command(*words, stdout=lost, stderr=subprocess.PIPE, restore_signals=False)
                self.assertEqual(got.returncode, 1)
                self.assertIn("standard output is lost (Broken pipe", got.stderr)

    def test_an_operators_answer_that_is_lost_is_exit_code_1_and_the_act_is_done(self):
        with System(TWO_RTPUS) as system:
            for words in (("status",), ("off", "beside"), ("events", "--follow"), ("watch", "count"),
                          ("get", "count", "--every", "20 ms")):
                with self.subTest(words), gone("full") as lost:
                    said = system.chimera(*words, code=1, capture_output=False, stdout=lost, stderr=subprocess.PIPE)
                    self.assertIn("standard output is lost (No space left on device", said.stderr)
            self.assertEqual(system.state("beside"), "OFF")


class ThePrintingProcessDies(unittest.TestCase):
    def printing(self, system):
        def found():
            for pid in system.left_over():
                with contextlib.suppress(OSError):
                    words = pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")
                    if words[1:2] == [b"attend"]:
                        return pid
        return await_that(found, "a printing process")

    def kill_printing(self, system):
        pid = self.printing(system)
        self.assertTrue(system.kill(pid))
        await_that(lambda: self.printing(system) != pid, "another printing process")

    def run_and_kill(self, expected, kills):
        words = ("--for", "6 s", "--at", "0.1 s: off beside", "--at", "4 s: on beside", "--expect", expected)
        with System(TWO_RTPUS, words) as system:
            system.await_event(0, "command")
            for _ in range(kills):
                self.kill_printing(system)
            system.await_event(0, "command", "on beside: done")
            done, told, face = system.texts("command"), system.texts("face-died"), system.call("status")["face"]
            return {"code": system.wait(), "said": system.said(), "face": face, "told": told, "done": done}

    def test_another_one_keeps_for_at_and_expect(self):
        with concurrent.futures.ThreadPoolExecutor() as pool:
            runs = {expected: pool.submit(self.run_and_kill, expected, kills)
                    for expected, kills in (("count >= 1", 1), ("count <= 0", 2))}
        for (expected, run), code, deaths in zip(runs.items(), (0, 1), (1, 2), strict=True):
            with self.subTest(expected):
                got = run.result()
                self.assertEqual(got["code"], code, got["said"])
                self.assertIn(("FAILS: " if code else "holds: ") + expected, got["said"])
                self.assertEqual(got["done"].count("on beside: done"), 1, "what was due later, once")
                self.assertEqual(got["face"]["deaths"], deaths)
                self.assertIn("signal 9 (SIGKILL)", got["told"][0])
                self.assertIn("not clean: ", got["said"])

    def test_one_that_is_stopped_ends_the_run_all_the_same(self):
        with System(TWO_RTPUS, ("--for", "3 s", "--expect", "count >= 1")) as system:
            started, stopped = system.call("status")["started_ns"], self.printing(system)
            # The manager is stopped at the end. No other takes its place before: a new one comes after 2 s.
            await_that(lambda: system.call("status")["now_ns"] > started + 1.5e9, "1.5 s")
            self.assertTrue(system.kill(stopped, signal.SIGSTOP))
            code, said = system.wait(), system.said()
        self.assertEqual(code, 0, said)
        self.assertIn("holds: count >= 1", said)
        self.assertIn("died 1 time", said)


class TheStartHangs(unittest.TestCase):
    def test_it_ends_and_names_tasks_that_are_not_ready(self):
        with tempfile.TemporaryDirectory() as folder:
            os.mkfifo(folder + "/pipe")  # for whose reader the logger waits
            words = ("--for", "0.2 s", "--start-limit", "4 s")
            with System(LOGGING.replace("PIPE", folder + "/pipe"), words, wait=False) as system:
                self.assertEqual(system.wait(), 1)
                self.assertIn("not ON after 4 s (--start-limit): log (csv_log): its `init` is under way", system.said())


class Limits(unittest.TestCase):
    def run_limited(self, *limits):
        """Exit code and standard error of a run under these limits."""
        def limit():
            for what, value in limits:
                resource.setrlimit(what, (value, value))
        reader, writer = os.pipe()  # a file would be under the limit itself
        with open(reader) as said:
            with System(TWO_RTPUS, ("--for", "0.2 s"), wait=False,
                        popen={"preexec_fn": limit, "stdout": subprocess.DEVNULL, "stderr": writer}) as system:
                os.close(writer)
                text = said.read()
                return system.wait(), text

    def test_a_low_limit_of_files_is_reported(self):
        for most in (0, 64 << 10):
            with self.subTest(most):
                code, said = self.run_limited((resource.RLIMIT_FSIZE, most))
                self.assertEqual(code, 1, said)
                self.assertIn(f"is limited to {most >> 10} KiB, expected at least 4096 KiB: ulimit -f", said)

    def test_a_run_with_few_open_files_is_refused_or_can_restart_every_process(self):
        for most in range(32, 100):
            limit = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))}
            with System(TWO_RTPUS, wait=False, popen=limit) as system:
                try:
                    system.await_started()
                except AssertionError:  # it has ended
                    self.assertEqual(system.wait(), 1, system.said())
                    self.assertRegex(system.said(), f"open files are limited to {most}, expected at least [0-9]+, or "
                                                    "no process could be restarted: ulimit -n|Too many open files")
                    continue
                before, manager = system.rtpu("second"), system.pids()["manager"]
                system.kill(before["pid"])
                system.await_restart("second", before)
                system.kill(manager)
                system.disconnect()
                await_that(lambda: system.pids()["manager"] != manager, "another manager")
                system.await_state("beside", "ON")
                return
        self.fail("no limit was enough")

    def test_a_low_stack_is_reported(self):
        for most in (64 << 10, 128 << 10) if is_sanitized() else (16 << 10, 32 << 10, 64 << 10):
            with self.subTest(most):
                code, said = self.run_limited((resource.RLIMIT_STACK, most))
                self.assertEqual(code, 1, said)
                self.assertIn(f"the stack is limited to {most >> 10} KiB", said)

    @unittest.skipIf(is_sanitized(), "the sanitizers reserve terabytes of addresses")
    def test_little_memory_is_reported(self):
        for megabytes in (11, 12, 14, 16, 18):
            with self.subTest(megabytes):
                code, said = self.run_limited((resource.RLIMIT_AS, megabytes << 20))
                self.assertIn(code, (1, 127), said)  # 127: the loader of the C library, which says so itself
                self.assertRegex(said, "out of memory|Cannot allocate memory|Resource temporarily unavailable|"
                                       "no thread can be started|failed to map")
                self.assertNotIn("terminate", said)


if __name__ == "__main__":
    unittest.main(verbosity=1)
