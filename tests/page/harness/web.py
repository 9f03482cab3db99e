# SPDX-License-Identifier: Apache-2.0
"""`chimera-web`, started for one test at a port that is free: the origin of its page is one that no other test has."""
import os
import pathlib
import re
import selectors
import signal
import socket
import subprocess

from browser import PATIENCE

BUILD = pathlib.Path(os.environ["CHIMERA_BUILD"]).resolve()
LINK = re.compile(r"http://127\.0\.0\.1:(\d+)/#([A-Za-z0-9_-]{43})")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Web:
    """A chimera-web. `link`: the printed one; `port`, `key`: its parts; `said()`: what it wrote to standard error."""

    def __init__(self, runtime, arguments=(), port=None):
        self.runtime, self.arguments, self.wanted = runtime, arguments, port or free_port()
        self.errors = runtime.parent / f"web-{self.wanted}"
        self.process, self.link, self.port, self.key = None, "", 0, ""

    def __enter__(self):
        # The search for leaks at the end may never end where a process must not trace another one.
        environment = dict(os.environ, ASAN_OPTIONS="detect_leaks=0", XDG_RUNTIME_DIR=str(self.runtime),
                           XDG_STATE_HOME=str(self.runtime.parent / "state"))
        with open(self.errors, "ab") as errors:
            self.process = subprocess.Popen(
                [str(BUILD / "bin" / "chimera-web"), "--port", str(self.wanted), *map(str, self.arguments)],
                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors, env=environment,
                cwd=self.runtime.parent)
        try:
            self.read_link()
        except BaseException:
            self.__exit__()
            raise
        return self

    def read_link(self):
        text = b""
        with selectors.DefaultSelector() as waiting:
            waiting.register(self.process.stdout, selectors.EVENT_READ)
            while not (match := LINK.search(text.decode(errors="replace"))):
                assert waiting.select(PATIENCE), f"chimera-web printed no link: {text} {self.said()}"
                more = os.read(self.process.stdout.fileno(), 1 << 16)
                assert more, f"chimera-web ended with {self.process.wait()}: {text} {self.said()}"
                text += more
        self.link, self.port, self.key = match[0], int(match[1]), match[2]

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
                raise AssertionError("chimera-web did not end after SIGTERM") from None
        self.process.stdout.close()

    def die(self):
        """Ends it as a fault would."""
        self.process.kill()
        self.process.wait()

    def said(self):
        return self.errors.read_text(errors="replace")

    def origin(self):
        return f"http://127.0.0.1:{self.port}"
