# SPDX-License-Identifier: Apache-2.0
"""Common parts of the commands of ./dev: output, build trees, the machine-wide real-time lock."""
import contextlib
import csv
import fcntl
import os
import pathlib
import re
import stat
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"
RESULTS = ROOT / "bench" / "results"


def step(text):
    print(f"-- {text}", flush=True)


class Progress:
    """One moving line on a terminal; elsewhere a plain line now and then."""

    PLAIN_EVERY_S = 60.0

    def __init__(self):
        self.moving = sys.stdout.isatty()
        self.last = time.monotonic()

    def show(self, text):
        if self.moving:
            print(f"\r   {text[:100]}\033[K", end="", flush=True)
        elif time.monotonic() - self.last >= self.PLAIN_EVERY_S:
            self.last = time.monotonic()
            print(f"   {text}", flush=True)

    def clear(self):
        if self.moving:
            print("\r\033[K", end="", flush=True)


def run_logged(command, log, pattern, env=None, cwd=ROOT):
    """Runs `command` with its output in `log`; lines that match `pattern` are progress. Returns the exit code."""
    progress = Progress()
    log.parent.mkdir(parents=True, exist_ok=True)
    with open(log, "w", encoding="utf-8", errors="replace") as file:
        process = subprocess.Popen(command, cwd=cwd, env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True, errors="replace")
        for line in process.stdout:
            file.write(line)
            if re.match(pattern, line):
                progress.show(line.strip())
    progress.clear()
    return process.wait()


def configure(preset, *options):
    """True when the tree is configured; a message with the log has been printed otherwise."""
    log = BUILD / preset / "configure.log"
    if (BUILD / preset / "build.ninja").exists() and not options:
        return True
    step(f"configuring build/{preset}")
    if run_logged(["cmake", "--preset", preset, *options], log, r"$^") == 0:
        return True
    print(log.read_text(errors="replace"))
    return False


def configure_with_tests(preset):
    """The release tree may have been made for the demo, without tests."""
    cache = BUILD / preset / "CMakeCache.txt"
    if cache.exists() and "CHIMERA_TESTS:BOOL=ON" in cache.read_text(errors="replace"):
        return configure(preset)
    return configure(preset, "-DCHIMERA_TESTS=ON")


def compile_tree(preset, *targets):
    """True when built; otherwise what the compiler said has been printed."""
    log = BUILD / preset / "build.log"
    step(f"compiling build/{preset}" + (": " + " ".join(targets) if targets else ""))
    if run_logged(["ninja", "-C", f"build/{preset}", *targets], log, r"\[\d+/\d+\]") == 0:
        return True
    said = [line for line in log.read_text(errors="replace").splitlines() if not line.startswith("[")]
    print("\n".join(said[:80]))
    print(f"compiling build/{preset} failed; all of it: {log.relative_to(ROOT)}")
    return False


def commit():
    """The short name of the commit, with a '+' when files differ from it."""
    git = ["git", "-c", "safe.directory=*", "-C", str(ROOT)]
    try:
        name = subprocess.run(git + ["rev-parse", "--short=10", "HEAD"], capture_output=True, text=True, check=True)
        dirty = subprocess.run(git + ["status", "--porcelain", "--untracked-files=no"], capture_output=True, text=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return name.stdout.strip() + ("+" if dirty.stdout.strip() else "")


def record(name, lines, folder=RESULTS):
    """Adds lines to a file of measurements. Its first line names the columns."""
    with open(folder / name, "a", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(lines)


def _open_lock_file():
    """One file for every user of the machine. Opened without O_CREAT first: in a sticky directory the kernel
    refuses to 'create' another user's file (fs.protected_regular)."""
    folder = "/run/lock" if os.access("/run/lock", os.W_OK) else "/tmp"
    path = os.path.join(folder, "chimera-realtime.lock")
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
    except FileNotFoundError:
        descriptor = os.open(path, os.O_RDONLY | os.O_CREAT | os.O_NOFOLLOW, 0o644)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        raise OSError(f"{path} is not a plain file")
    return descriptor


@contextlib.contextmanager
def realtime_lock():
    """Lock for measurements of time: one process of the machine holds it, of any user and checkout."""
    descriptor = _open_lock_file()
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            step("waiting for the machine-wide real-time lock")
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)
