# SPDX-License-Identifier: Apache-2.0
"""chimera-web and its clients for tests, byte by byte: requests, WebSocket frames, and a server of the control protocol
that does what a test says."""
import base64
import json
import os
import pathlib
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time

BUILD = pathlib.Path(os.environ["CHIMERA_BUILD"]).resolve()
HANG = 60.0  # s, the only limit of these tests
TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10
QUIET = "detect_leaks=0:quarantine_size_mb=1"  # the sanitizer keeps freed memory, which these tests measure
FIELDS = {"Connection": "keep-alive, Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13"}


class Server:
    """A chimera-web at a free port, with a folder of sockets of its own."""

    def __init__(self, *words, port=0, runtime=None, state=None, prefix=(), stdout=subprocess.PIPE):
        self.place = pathlib.Path(tempfile.mkdtemp(prefix="chimera-page-"))
        self.runtime = runtime or self.place
        (self.runtime / "chimera").mkdir(mode=0o700, exist_ok=True)
        self.errors = open(self.place / "errors", "w+b")
        self.process = subprocess.Popen(
            [*prefix, str(BUILD / "bin" / "chimera-web"), "--port", str(port), *map(str, words)],
            stdin=subprocess.DEVNULL, stdout=stdout, stderr=self.errors,
            env=dict(os.environ, XDG_RUNTIME_DIR=str(self.runtime), ASAN_OPTIONS=QUIET,
                     XDG_STATE_HOME=str(state or self.place / "state")))
        self.link = self.process.stdout.readline().decode().strip() if stdout == subprocess.PIPE else ""
        if self.link:
            address, self.key = self.link.split("/#")
            self.port = int(address.rsplit(":", 1)[1])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()
        shutil.rmtree(self.place)

    def end(self, how=signal.SIGTERM):
        """The exit code."""
        if self.process.poll() is None:
            self.process.send_signal(how)
        code = self.process.wait(HANG)
        if self.process.stdout:
            self.process.stdout.close()
        self.errors.close()
        return code

    def said(self):
        return (self.place / "errors").read_text(errors="replace")

    def resident(self):
        """Bytes of memory."""
        return int(pathlib.Path(f"/proc/{self.process.pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    def request(self, target="/", fields=None, method="GET", version="HTTP/1.1"):
        """The bytes of a request; a field that is None is left out."""
        fields = {"Host": f"127.0.0.1:{self.port}", **(fields or {})}
        lines = [f"{method} {target} {version}", *(f"{n}: {v}" for n, v in fields.items() if v is not None)]
        return "\r\n".join([*lines, "", ""]).encode("latin1")

    def connect(self):
        return socket.create_connection(("127.0.0.1", self.port), HANG)

    def answer(self, data):
        """All that the server sends for these bytes: (status, rest)."""
        with self.connect() as wire:
            wire.sendall(data)
            answer = read_all(wire)
        return (int(answer.split()[1]), answer) if answer else (0, b"")

    def get(self, *words, **more):
        return self.answer(self.request(*words, **more))

    def open(self, target="/bench", key=None, **fields):
        """A WebSocket that has shown a key (b"": none yet)."""
        page = WebSocket(self, target, fields)
        if key != b"":
            page.send(self.key if key is None else key)
        return page


def read_all(wire):
    """Until the other end closes; a reset counts as an end."""
    got = b""
    try:
        while part := wire.recv(1 << 16):
            got += part
    except ConnectionResetError:
        pass
    return got


class WebSocket:
    """The browser's end."""

    def __init__(self, server, target, fields):
        self.wire, self.bytes = server.connect(), bytearray()
        key = base64.b64encode(os.urandom(16)).decode()
        self.wire.sendall(server.request(target, {**FIELDS, "Origin": f"http://127.0.0.1:{server.port}",
                                                  "Sec-WebSocket-Key": key, **fields}))
        while b"\r\n\r\n" not in self.bytes:
            part = self.wire.recv(1 << 16)
            if not part:
                break
            self.bytes += part
        head, _, self.bytes = self.bytes.partition(b"\r\n\r\n")
        self.status = int(head.split()[1]) if head else 0
        self.head = head.decode()
        self.number = 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.wire.close()

    def send(self, data, kind=TEXT, last=True, masked=True, bits=0):
        data = data.encode() if isinstance(data, str) else data
        self.wire.sendall(head_of_frame(len(data), kind, last, masked, bits) + (b"\0\0\0\0" if masked else b"") + data)

    def _take(self, n):
        while len(self.bytes) < n:
            part = self.wire.recv(1 << 20)
            if not part:
                raise EOFError
            self.bytes += part
        taken = bytes(self.bytes[:n])
        del self.bytes[:n]
        return taken

    def frame(self):
        """(kind, is the last one, bytes) of the next frame."""
        first, size = self._take(2)
        if size >= 126:
            size = struct.unpack(">H" if size == 126 else ">Q", self._take(2 if size == 126 else 8))[0]
        return first & 15, first >= 128, self._take(size)

    def message(self, until=float("inf")):
        """The next text; answers pings, but none later than `until`."""
        text = bytearray()
        while True:
            kind, last, data = self.frame()
            if kind == PING:
                assert time.monotonic() < until, "the server sends pings and no answer"
                self.send(data, PONG)
            elif kind == CLOSE:
                raise Closed(data)
            elif kind in (TEXT, 0):
                text += data
                if last:
                    return text.decode()

    def begin(self, method, **parameters):
        """Sends a request: finish() reads its answer."""
        self.number += 1
        self.send(json.dumps({"jsonrpc": "2.0", "id": self.number, "method": method, "params": parameters}))

    def finish(self):
        """The answer to the last request: a result, or an error."""
        until = time.monotonic() + HANG
        while (answer := json.loads(self.message(until))).get("id") != self.number:
            pass
        return answer

    def ask(self, method, **parameters):
        self.begin(method, **parameters)
        return self.finish()

    def call(self, method, **parameters):
        """The result; asks again if it came too fast."""
        while (answer := self.ask(method, **parameters)).get("error", {}).get("code") == -32003:
            time.sleep(answer["error"]["data"]["retry_ms"] / 1000)
        assert "result" in answer, answer
        return answer["result"]

    def code(self):
        """Reads to the end: the code of the server's close frame; 0: there was none."""
        try:
            while True:
                self.message()
        except Closed as end:
            return end.code
        except (EOFError, ConnectionResetError):
            return 0


def head_of_frame(size, kind=TEXT, last=True, masked=True, bits=0):
    mask = 128 if masked else 0
    length = (bytes([mask | size]) if size < 126 else bytes([mask | 126]) + struct.pack(">H", size) if size < 1 << 16
              else bytes([mask | 127]) + struct.pack(">Q", size))
    return bytes([(128 if last else 0) | bits << 4 | kind]) + length


class Closed(Exception):
    def __init__(self, data):
        self.code = struct.unpack(">H", data[:2])[0] if data else 1005
        super().__init__(f"{self.code}: {data[2:].decode()}")


class Machine:
    """Listens as the subsystem NAME; talk(connection) runs in a thread for each connection."""

    def __init__(self, server, name, talk):
        self.path, self.talk = server.runtime / "chimera" / f"{name}.sock", talk
        self.listening = socket.socket(socket.AF_UNIX)
        self.listening.bind(str(self.path))
        self.listening.listen(64)
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self):
        while True:
            try:
                connection, _ = self.listening.accept()
            except OSError:
                return
            threading.Thread(target=self._talk, args=(connection,), daemon=True).start()

    def _talk(self, connection):
        with connection:
            try:
                self.talk(connection)
            except OSError:
                pass

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.listening.shutdown(socket.SHUT_RDWR)
        self.listening.close()
        self.path.unlink()


def echo(connection):
    while part := connection.recv(1 << 16):
        connection.sendall(part)
