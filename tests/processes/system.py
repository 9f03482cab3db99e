# SPDX-License-Identifier: Apache-2.0
"""A whole subsystem of real processes: started by `chimera run`, seen through its control protocol and /proc."""
import json
import os
import pathlib
import select
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time

BUILD = pathlib.Path(os.environ["CHIMERA_BUILD"]).resolve()
CHIMERA = BUILD / "bin" / "chimera"
# A sanitizer that catches the signal would hide how the process died.
QUIET = "handle_segv=0:handle_abort=0:handle_sigbus=0:handle_sigfpe=0:handle_sigill=0:detect_leaks=0:use_sigaltstack=0"

TOO_FAST = -32003

# Two units, of which each test says what runs in them.
UNITS = """
subsystem: subject
rtpus:
  first: {cpu: 0, policy: edf}
  second: {cpu: 1, policy: edf}
"""

# A task of its own in each of them.
TWO_UNITS = UNITS + """
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  beside: {component: t_source, rtpu: second, rate: 100 Hz}
configurations: {all: [steady, beside]}
start: all
"""

# A chain over two units: device -> a -> b -> c -> device, so that the order of the end is known.
CHAIN = UNITS + """
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

    def __init__(self, path, limit=10):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.socket.settimeout(limit)
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


def await_that(condition, limit=10.0, what="it"):
    """Polls until condition() is true; fails after `limit` seconds."""
    end = time.monotonic() + limit
    while True:
        got = condition()
        if got:
            return got
        if time.monotonic() > end:
            raise AssertionError(f"{what} did not come true within {limit} s")
        time.sleep(0.002)


def processes_of(marker):
    """Pids whose environment carries the marker: everything a system started, whoever its parent is by now."""
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
    """Has it a thread that is neither stopped nor ended?"""
    for thread in pathlib.Path(f"/proc/{pid}/task").glob("*/stat"):
        try:
            if thread.read_text().rsplit(")", 1)[1].split()[0] not in "TtZX":
                return True
        except OSError:
            pass  # it has ended
    return False


def kill(pid, marker, how=signal.SIGKILL):
    """Signals a process that carries the marker. The number may be another's by now, the descriptor is not: whether it
    is ours is asked while it is held. One that is stopped does nothing any more when this returns. True when it was
    sent."""
    try:
        held = os.pidfd_open(pid)
    except OSError:
        return False
    try:
        if marker.encode() not in pathlib.Path(f"/proc/{pid}/environ").read_bytes():
            return False
        signal.pidfd_send_signal(held, how)
        if how == signal.SIGSTOP:  # a thread that waits for a CPU goes on until it has one
            await_that(lambda: not runs(pid), 5, f"process {pid} stopped")
        return True
    except OSError:
        return False  # it has ended
    finally:
        os.close(held)


class System:
    """`chimera run` of a description, in a place of its own. `popen`: where its output goes instead, and the like."""

    def __init__(self, text, arguments=(), environment=None, name="subject", wait=True, popen=None):
        if "--priority" not in arguments:  # several systems at once: none claims a CPU
            arguments = ("--priority", "0", *arguments)
        self.place = pathlib.Path(tempfile.mkdtemp(prefix="chimera-processes-"))
        self.runtime = self.place / "runtime"
        self.runtime.mkdir(mode=0o700)
        self.state_home = self.place / "state"  # of what outlives it: receipts
        self.record = self.place / "record"
        self.armed = self.place / "armed"
        self.file = self.place / f"{name}.yaml"
        self.file.write_text(text.replace("ARMED", str(self.armed)))
        self.marker = f"CHIMERA_TEST_MARK={self.place}"
        self.environment = dict(os.environ, XDG_RUNTIME_DIR=str(self.runtime), XDG_STATE_HOME=str(self.state_home),
                                CHIMERA_TEST_MARK=str(self.place),
                                CHIMERA_TEST_RECORD=str(self.record), **{"ASAN_OPTIONS": QUIET, **(environment or {})})
        self.output = open(self.place / "output", "w+b")
        streams = {"stdout": self.output, "stderr": self.output, **(popen or {})}
        self.process = subprocess.Popen([str(CHIMERA), "run", str(self.file), *arguments], stdin=subprocess.DEVNULL,
                                        env=self.environment, cwd=self.place, **streams)
        self.socket = self.runtime / "chimera" / f"{name}.sock"
        self.client = None
        if wait:
            try:
                self.await_started()
            except BaseException:
                self.end()
                raise

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
            except (OSError, ConnectionError):
                self.disconnect()
                return False
        await_that(ready, 20, f"the start ({self.said()})")

    def disconnect(self):
        if self.client is not None:
            self.client.close()
            self.client = None

    def call(self, method, **parameters):
        """Over a connection that survives a restart of the manager, at the rate that is allowed."""
        for attempt in range(200):
            try:
                if self.client is None:
                    self.client = Client(self.socket)
                return self.client.call(method, **parameters)
            except Refused as refusal:
                if refusal.code != TOO_FAST or attempt == 199:
                    raise
                time.sleep(refusal.data["retry_ms"] / 1e3)
            except (OSError, ConnectionError):
                self.disconnect()
                if attempt == 199:
                    raise ConnectionError(f"no answer, {self.process.poll()}: {self.said()}") from None
                time.sleep(0.01)

    def task(self, name):
        return next(t for t in self.call("status")["tasks"] if t["task"] == name)

    def rtpu(self, name):
        return next(r for r in self.call("status")["rtpus"] if r["name"] == name)

    def state(self, name):
        return self.task(name)["state"]

    def await_state(self, name, state, limit=10):
        """Fails with what the subsystem is and has told, so that the reason is seen where it cannot be asked again."""
        try:
            await_that(lambda: self.state(name) == state, limit, f"{name} {state}")
        except AssertionError as failure:
            told = [f"{e['kind']}: {e['text']}" for e in self.events()[-12:]]
            tasks = [(t["task"], t["state"]) for t in self.call("status")["tasks"]]
            raise AssertionError(f"{failure}: {tasks}; told at last: {told}; said: {self.said()}") from None

    def await_running(self, unit, what, limit=10):
        """Until a unit is seen in the same method twice, with a hundredth of a second between."""
        def stays():
            if self.rtpu(unit)["running"] != what:
                return False
            time.sleep(0.01)
            return self.rtpu(unit)["running"] == what
        await_that(stays, limit, f"{unit} in {what}")

    def signal(self, word, *tasks):
        return self.call("signal", signal=word, tasks=list(tasks))

    def events(self, since=0):
        """All that are kept: they come a thousand at a time."""
        found = []
        while more := self.call("events", since=since)["events"]:
            found += more
            since = more[-1]["number"] + 1
        return found

    def pids(self):
        status = self.call("status")
        hello = self.call("hello")
        return {"keeper": hello["keeper_pid"], "manager": hello["manager"]["pid"],
                **{r["name"]: r["pid"] for r in status["rtpus"] if r["alive"]}}

    def arm(self):
        self.armed.write_text("")

    def disarm(self):
        self.armed.unlink(missing_ok=True)

    def lines(self):
        """What t_recorder wrote: (label, method, ns)."""
        if not self.record.exists():
            return []
        return [(w[0], w[1], int(w[2])) for w in (line.split() for line in self.record.read_text().splitlines())]

    def kill(self, pid, how=9):  # SIGKILL
        return kill(pid, self.marker, how)

    def switch(self, configuration):
        """The receipt; a unit that was away is too late to agree, and that is told: then it is asked again."""
        for _ in range(5):
            receipt = self.call("switch", configuration=configuration)
            if receipt.get("reason") != "late":
                break
        return receipt

    def kill_in_a_switch(self, who, target, page, step, later):
        """Asks for a slow switch to `target`, kills `who` when so many steps are done and so many seconds later, and
        waits for its successor. How far it was then."""
        pid, last = self.pids()[who], page.plan()[0]

        def ask():
            try:
                client = Client(self.socket, 30)
                client.call("switch", configuration=target)
                client.close()
            except (Refused, OSError):
                pass

        asking = threading.Thread(target=ask)
        asking.start()
        page.await_step(last, step)
        time.sleep(later)
        hit = f"{page.plan()[1]}, step {page.step()}"
        assert self.kill(pid), who
        asking.join(30)
        assert not asking.is_alive(), "the switch was not answered"
        await_that(lambda: self.pids().get(who) not in (None, pid), 20, f"a new {who}")
        return hit

    def left_over(self):
        return processes_of(self.marker)

    def await_nothing_left(self, limit=10):
        await_that(lambda: not self.left_over(), limit, f"the end of {self.left_over()}")

    def end(self, how=15):  # SIGTERM; `signal` is a method here
        """Ends it in order; whatever is left is killed by its pid and is a failure."""
        try:
            self.disconnect()
            if self.process.poll() is None:
                self.process.send_signal(how)
                self.process.wait(15)
            self.await_nothing_left(10)
        finally:
            for pid in self.left_over():
                self.kill(pid)
            if self.process.poll() is None:
                self.process.kill()
                self.process.wait()
            self.output.close()
            shutil.rmtree(self.place, ignore_errors=True)
        return self.process.returncode


def readable(descriptor, seconds):
    return bool(select.select([descriptor], [], [], seconds)[0])
