# SPDX-License-Identifier: Apache-2.0
"""Row 28: the kernel gives the number of a dead process to another one; a pidfd stays with its process. Where the
kernel allows it (Linux 6.14) all of this runs where there are only 400 numbers, so that each is soon used again."""
import os
import pathlib
import re
import subprocess
import sys
import unittest

from campaign import ROUNDS, counted
from system import BUILD, RTPUS, System, await_that

SOURCE = pathlib.Path(os.environ.get("CHIMERA_SOURCE", BUILD.parents[1]))

BY_NUMBER = r"(?<![\w.>:])(?:::|std::)?(?:kill|killpg|tgkill|sigqueue|waitpid)\s*\((?=\s*[^)\s])"
BY_NUMBER_IN_TESTS = BY_NUMBER.replace("|waitpid", "")  # waits for children of its own only
BY_NUMBER_IN_PYTHON = r"\bos\.(?:kill|killpg)\s*\("
# A declaration `kill(Cycle)` is no call; signal 0 is sent to no process; a child that was not reaped keeps its number.
NOT_MEANT = re.compile(r"kill\(Cycle\b|kill\([^,()]*(?:\([^()]*\))?, 0\)|(?://|#) (?:still ours|not reaped)")

APPLICATION = RTPUS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  victim: {component: t_source, rtpu: second, rate: 200 Hz}
configurations: {all: [steady, victim]}
start: all
"""


def found_in(path):
    is_test = "_test" in path.name or "tests" in path.relative_to(SOURCE).parts
    pattern = BY_NUMBER_IN_PYTHON if path.suffix == ".py" else BY_NUMBER_IN_TESTS if is_test else BY_NUMBER
    return [f"{path}:{n}" for n, line in enumerate(path.read_text().splitlines(), 1)
            if re.search(pattern, re.split("//(?! still ours| not reaped)", line)[0]) and not NOT_MEANT.search(line)]


class Storm:
    """Short-lived processes, some hundred a second, so that numbers come round sooner; two at a time."""

    def __init__(self):
        self.process = subprocess.Popen(["/bin/sh", "-c", "while :; do /bin/true & /bin/true; wait; done"],
                                        stdin=subprocess.DEVNULL, start_new_session=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()


def numbers_given():
    """Since the machine was started: one for each process and thread."""
    return int(re.search(r"^processes (\d+)", pathlib.Path("/proc/stat").read_text(), re.M)[1])


def memory_holders():
    """Alive or dead, among the processes that this one sees."""
    found = 0
    for comm in pathlib.Path("/proc").glob("[0-9]*/comm"):
        try:
            found += comm.read_text() == "memory-holder\n"
        except OSError:
            continue  # it has gone
    return found


def number_limit():
    return int(pathlib.Path("/proc/sys/kernel/pid_max").read_text())


def go_where_numbers_are_few():
    """Becomes the same program among processes of its own; goes on here where that is not allowed."""
    limit = "echo 400 > /proc/sys/kernel/pid_max && exec"
    apart = ["unshare", "--pid", "--fork", "--mount-proc", "--kill-child"]
    apart += [] if os.getuid() == 0 else ["--user", "--map-root-user"]
    tried = subprocess.run([*apart, "/bin/sh", "-c", f"{limit} grep -qx 400 /proc/sys/kernel/pid_max"],
                           capture_output=True)
    outside = subprocess.run(["grep", "-qx", "400", "/proc/sys/kernel/pid_max"])
    if tried.returncode == 0 and outside.returncode != 0 and "CHIMERA_FEW_NUMBERS" not in os.environ:
        os.environ["CHIMERA_FEW_NUMBERS"] = "1"
        os.execvp(apart[0], [*apart, "/bin/sh", "-c", f'{limit} "$@"', "sh", sys.executable, *sys.argv])


class Numbers(unittest.TestCase):
    def test_row_28_no_process_is_signalled_by_number(self):
        self.assertTrue(re.search(BY_NUMBER, "  ::kill(pid, SIGKILL);"))
        self.assertFalse(re.search(BY_NUMBER, "  Outcome kill() {"))
        self.assertTrue(re.search(BY_NUMBER_IN_PYTHON, "os.kill(pid, 9)"))
        files = [p for folder in ("chimera", "apps", "tests", "library") for p in (SOURCE / folder).rglob("*")
                 if p.suffix in (".cc", ".h", ".c", ".py") and p.name != pathlib.Path(__file__).name]
        self.assertGreater(len(files), 500)
        found = [place for path in files for place in found_in(path)]
        self.assertFalse(found, "\n".join(found))

    def test_row_28_restarts_in_a_storm_of_other_processes_hit_no_other_process(self):
        numbers = numbers_given()
        bystanders = [subprocess.Popen(["/bin/sleep", "3600"]) for _ in range(20)]
        self.addCleanup(lambda: [(b.kill(), b.wait()) for b in bystanders])
        for _ in range(ROUNDS):
            with System(APPLICATION) as system, Storm():
                before = system.task("steady")
                for _ in range(3):  # as often as an rtpu is restarted in 10 s
                    unit = system.rtpu("second")
                    self.assertTrue(system.kill(unit["pid"]))
                    system.await_restart("second", unit)
                    system.await_state("victim", "ON")
                after = system.task("steady")
                self.assertEqual((after["state"], after["incarnation"], after["faults"]),
                                 ("ON", before["incarnation"], 0))
                self.assertEqual({p.poll() for p in bystanders}, {None}, "another process was hit")
                ends = system.texts("rtpu-ended")
                self.assertEqual(len([text for text in ends if "signal 9" in text]), 3, ends)
                if "CHIMERA_FEW_NUMBERS" in os.environ:  # all processes are ours
                    await_that(lambda: memory_holders() <= 2, "the end of the dead rtpus with their memory holders")
                counted("restarts", 3)
        print(f"{numbers_given() - numbers} numbers given of {number_limit()}", file=sys.stderr)


if __name__ == "__main__":
    go_where_numbers_are_few()
    unittest.main(verbosity=1)
