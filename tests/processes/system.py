# SPDX-License-Identifier: Apache-2.0
"""A whole subsystem of real processes: started by `chimera run`, seen through its control protocol and /proc. A test
waits for an event of the program and judges what the program decided, never how long it took."""
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

BUILD = pathlib.Path(os.environ["CHIMERA_BUILD"]).resolve()
CHIMERA = BUILD / "bin" / "chimera"
# A sanitizer that catches the signal would hide how the process died.
QUIET = "handle_segv=0:handle_abort=0:handle_sigbus=0:handle_sigfpe=0:handle_sigill=0:detect_leaks=0:use_sigaltstack=0"

TOO_FAST = -32003
HANG = 60.0  # s, the only limit of these tests: a program that lets a test wait longer hangs

# Two rtpus; each test says which tasks run in them.
RTPUS = """
subsystem: subject
rtpus:
  first: {cpu: 0, policy: edf}
  second: {cpu: 1, policy: edf}
"""

# One task in each rtpu.
TWO_RTPUS = RTPUS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  beside: {component: t_source, rtpu: second, rate: 100 Hz}
configurations: {all: [steady, beside]}
start: all
"""

# A chain over two rtpus: device -> a -> b -> c -> device. It says in which order the tasks end.
CHAIN = RTPUS + """
tasks:
  a: {component: t_recorder, rtpu: first, rate: 100 Hz, alias: {x: x0, y: x1}, constants: {label: a}}
  b: {component: t_recorder, rtpu: second, rate: 100 Hz, alias: {x: x1, y: x2}, constants: {label: b}}
  c: {component: t_recorder, rtpu: first, rate: 100 Hz, alias: {x: x2, y: x3}, constants: {label: c}}
operator: {x0: 0}
configurations:
  all: [a, b, c]
start: all
"""


class Refused(Exception):
    """An error of the protocol."""

    def __init__(self, error):
        super().__init__(error["message"])
        self.code, self.data = error["code"], error.get("data")


class Client:
    """One connection to the control protocol."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.socket.settimeout(HANG)
        try:
            self.socket.connect(str(path))
        except OSError:
            self.socket.close()
            raise
        self.bytes, self.number, self.notes = b"", 0, []

    def close(self):
        self.socket.close()

    def line(self):
        while b"\n" not in self.bytes:
            got = self.socket.recv(1 << 16)
            if not got:
                raise ConnectionError("closed")
            self.bytes += got
        line, self.bytes = self.bytes.split(b"\n", 1)
        return json.loads(line)

    def call(self, method, **parameters):
        self.number += 1
        request = {"jsonrpc": "2.0", "id": self.number, "method": method, "params": parameters}
        self.socket.sendall(json.dumps(request).encode() + b"\n")
        while True:
            answer = self.line()
            if answer.get("id") == self.number:
                break
            self.notes.append(answer)
        if "error" in answer:
            raise Refused(answer["error"])
        return answer["result"]

    def note(self):
        return self.notes.pop(0) if self.notes else self.line()


class Asking(threading.Thread):
    """One request on a connection of its own, made by a thread; `answered`: its answer, or the error."""

    def __init__(self, path, method, parameters):
        super().__init__()
        self.path, self.request, self.answered = path, (method, parameters), None
        self.start()

    def run(self):
        try:
            client = Client(self.path)
            self.answered = client.call(self.request[0], **self.request[1])
            client.close()
        except (Refused, OSError) as error:
            self.answered = error

    def answer(self):
        self.join(HANG)
        assert not self.is_alive(), f"{self.request} was not answered"
        return self.answered


def duration(what, seconds):
    """Prints how long something took. No test fails for it."""
    print(f"duration: {what} {seconds:.3f} s", file=sys.stderr, flush=True)


def await_that(condition, what="the condition", pause=0.002):
    """Polls until condition() is true and returns its value. `what`: words for the failure, or a function that gives
    them."""
    end = time.monotonic() + HANG
    while not (got := condition()):
        if time.monotonic() > end:
            raise AssertionError(f"{what() if callable(what) else what} did not come true within {HANG:.0f} s")
        time.sleep(pause)
    return got


def processes_of(marker):
    """Pids of the processes whose environment carries the marker: all that a system started."""
    found = []
    for entry in os.listdir("/proc"):
        if not entry.isdigit():
            continue
        try:
            environment = pathlib.Path(f"/proc/{entry}/environ").read_bytes()
            state = pathlib.Path(f"/proc/{entry}/stat").read_text().rsplit(")", 1)[1].split()[0]
        except OSError:
            continue
        if marker.encode() in environment and state != "Z":
            found.append(int(entry))
    return found


def runs(pid):
    """True if the process has a thread that is neither stopped nor ended."""
    for thread in pathlib.Path(f"/proc/{pid}/task").glob("*/stat"):
        try:
            if thread.read_text().rsplit(")", 1)[1].split()[0] not in "TtZX":
                return True
        except OSError:
            pass  # the thread has ended
    return False


def kill(pid, marker, how=signal.SIGKILL):
    """Signals a process that carries the marker; true if the signal was sent. A descriptor holds the process while the
    marker is read, because the kernel may give the number to another process. After SIGSTOP the process is stopped when
    this returns."""
    try:
        held = os.pidfd_open(pid)
    except OSError:
        return False
    try:
        if marker.encode() not in pathlib.Path(f"/proc/{pid}/environ").read_bytes():
            return False
        signal.pidfd_send_signal(held, how)
        if how == signal.SIGSTOP:  # a thread that waits for a CPU goes on until it has one
            await_that(lambda: not runs(pid), f"the stop of process {pid}")
        return True
    except OSError:
        return False  # the process has ended
    finally:
        os.close(held)


class System:
    """`chimera run` of a description, in a folder of its own. `popen`: more arguments of subprocess.Popen."""

    def __init__(self, text, arguments=(), environment=None, name="subject", wait=True, popen=None):
        if "--priority" not in arguments:  # several systems run at once: none claims a CPU
            arguments = ("--priority", "0", *arguments)
        self.place = pathlib.Path(tempfile.mkdtemp(prefix="chimera-processes-"))
        self.runtime = self.place / "runtime"
        self.runtime.mkdir(mode=0o700)
        self.state_home = self.place / "state"  # where receipts are filed
        self.receipt_file = self.state_home / "chimera" / name / "receipts.jsonl"
        self.record = self.place / "record"
        self.armed = self.place / "armed"
        self.file = self.place / f"{name}.yaml"
        self.file.write_text(text.replace("ARMED", str(self.armed)))
        self.marker = f"CHIMERA_TEST_MARK={self.place}"
        self.environment = dict(os.environ, XDG_RUNTIME_DIR=str(self.runtime), XDG_STATE_HOME=str(self.state_home),
                                CHIMERA_TEST_MARK=str(self.place),
                                CHIMERA_TEST_RECORD=str(self.record), **{"ASAN_OPTIONS": QUIET, **(environment or {})})
        self.output = open(self.place / "output", "w+b")
        self.socket = self.runtime / "chimera" / f"{name}.sock"
        self.client = None
        self.start(arguments, popen or {})
        if wait:
            try:
                self.await_started()
            except BaseException:
                self.end()
                raise

    def start(self, arguments, popen):
        streams = {"stdout": self.output, "stderr": self.output, **popen}
        self.process = subprocess.Popen([str(CHIMERA), "run", str(self.file), *arguments], stdin=subprocess.DEVNULL,
                                        env=self.environment, cwd=self.place, **streams)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()

    def said(self):
        self.output.flush()
        return (self.place / "output").read_text(errors="replace")

    def await_started(self):
        def ready():
            if self.process.poll() is not None:
                raise AssertionError(f"chimera run ended with {self.process.returncode}:\n{self.said()}")
            try:
                if self.client is None:
                    self.client = Client(self.socket)
                return self.client.call("status")["started_ns"] is not None
            except OSError:
                self.disconnect()
                return False
        await_that(ready, lambda: f"the start ({self.said()})")

    def disconnect(self):
        if self.client is not None:
            self.client.close()
            self.client = None

    def call(self, method, **parameters):
        """The result. Connects again after a death of the manager, and asks again if it asked too fast."""
        end = time.monotonic() + HANG
        while True:
            try:
                if self.client is None:
                    self.client = Client(self.socket)
                return self.client.call(method, **parameters)
            except Refused as refusal:
                if refusal.code != TOO_FAST or time.monotonic() > end:
                    raise
                time.sleep(refusal.data["retry_ms"] / 1e3)
            except OSError:
                self.disconnect()
                if self.process.poll() is not None or time.monotonic() > end:
                    raise ConnectionError(f"no answer, {self.process.poll()}: {self.said()}") from None
                time.sleep(0.01)

    def ask(self, method, **parameters):
        return Asking(self.socket, method, parameters)

    def chimera(self, *words, code=0, **more):
        """The output of a command; fails unless its exit code is `code` (None: any)."""
        done = subprocess.run([str(CHIMERA), *map(str, words)], **{
            "env": self.environment, "cwd": self.place, "capture_output": True, "text": True, "timeout": HANG,
            "stdin": subprocess.DEVNULL, **more})
        assert code is None or done.returncode == code, f"{words}: exit {done.returncode}: {done.stdout}{done.stderr}"
        return done

    def task(self, name):
        return next(t for t in self.call("status")["tasks"] if t["task"] == name)

    def rtpu(self, name):
        return next(r for r in self.call("status")["rtpus"] if r["name"] == name)

    def state(self, name):
        return self.task(name)["state"]

    def on(self):
        return {task["task"] for task in self.call("status")["tasks"] if task["state"] == "ON"}

    def await_state(self, name, state):
        await_that(lambda: self.state(name) == state, lambda: f"{name} {state}: {self.told()}")

    def told(self):
        """States, the last events and the output: what a failure shows."""
        events = [f"{e['kind']}: {e['text']}" for e in self.events()[-12:]]
        return f"{[(t['task'], t['state']) for t in self.call('status')['tasks']]}; {events}; said: {self.said()}"

    def await_cycles(self, name, n=10):
        """Until the task has made that many more cycles. The task as it is then."""
        before = self.task(name)["cycles"]
        return await_that(lambda: (t := self.task(name))["cycles"] >= before + n and t, f"{n} cycles of {name}")

    def value(self, name):
        return self.call("get", variables=[name])["values"][name]["value"]

    def await_value(self, name, wanted):
        await_that(lambda: self.value(name) == wanted, lambda: f"{name} = {wanted}, it is {self.value(name)}")

    def await_restart(self, unit, before):
        """Until the rtpu lives in a later incarnation than `before`, its status then."""
        return await_that(lambda: (r := self.rtpu(unit))["incarnation"] > before["incarnation"] and r["alive"] and r,
                          lambda: f"a restart of {unit}: {self.told()}")

    def signal(self, word, *tasks):
        return self.call("signal", signal=word, tasks=list(tasks))

    def events(self, since=0, kind=None, **about):
        """All kept events, which come a thousand at a time; of one kind, with these properties."""
        found = []
        while more := self.call("events", since=since)["events"]:
            found += more
            since = more[-1]["number"] + 1
        return [e for e in found if kind in (None, e["kind"]) and all(e.get(key) == about[key] for key in about)]

    def texts(self, kind, since=0):
        return [event["text"] for event in self.events(since, kind)]

    def next_event(self):
        """The number that the next event will have."""
        return self.call("events", since=0)["last"] + 1

    def await_event(self, since, kind, words="", **about):
        """The first such event from the number `since` on that has these words in its text."""
        def found():
            return next((e for e in self.events(since, kind, **about) if words in e["text"]), None)
        return await_that(found, lambda: f"an event {kind} {about} with '{words}': {self.told()}")

    def pids(self):
        status = self.call("status")
        hello = self.call("hello")
        return {"keeper": hello["keeper_pid"], "manager": hello["manager"]["pid"],
                **{r["name"]: r["pid"] for r in status["rtpus"] if r["alive"]}}

    def named(self, comm):
        """Pids of the processes of this system with that name."""
        found = []
        for pid in self.left_over():
            try:
                if pathlib.Path(f"/proc/{pid}/comm").read_text().strip() == comm:
                    found.append(pid)
            except OSError:
                pass  # it has ended
        return found

    def arm(self):
        self.armed.write_text("")

    def disarm(self):
        self.armed.unlink(missing_ok=True)

    def lines(self):
        """What t_recorder wrote: (label, method, ns)."""
        if not self.record.exists():
            return []
        return [(w[0], w[1], int(w[2])) for w in (line.split() for line in self.record.read_text().splitlines())]

    def kill(self, pid, how=9):  # SIGKILL; `signal` is a method here
        return kill(pid, self.marker, how)

    def filed(self):
        """The receipts in the file."""
        lines = self.receipt_file.read_text().splitlines() if self.receipt_file.is_file() else []
        return [json.loads(line) for line in lines]

    @staticmethod
    def descriptors(pid):
        return len(os.listdir(f"/proc/{pid}/fd"))

    def left_over(self):
        return processes_of(self.marker)

    def await_nothing_left(self):
        await_that(lambda: not self.left_over(), lambda: f"the end of {self.left_over()}")

    def wait(self):
        """The exit code of the run, once it has ended."""
        return self.process.wait(HANG)

    def end(self, how=15):  # SIGTERM
        """Ends the run in order. A process that stays is a failure, and is killed."""
        try:
            self.disconnect()
            if self.process.poll() is None:
                self.process.send_signal(how)
                self.wait()
            self.await_nothing_left()
        finally:
            for pid in self.left_over():
                self.kill(pid)
            if self.process.poll() is None:
                self.process.kill()
                self.process.wait()
            self.output.close()
            shutil.rmtree(self.place, ignore_errors=True)
        return self.process.returncode
