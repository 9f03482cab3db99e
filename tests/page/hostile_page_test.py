# SPDX-License-Identifier: Apache-2.0
"""What other sites, other users and broken browsers may send to chimera-web: each is refused by a status or a close
code, and a browser with the key gets in afterwards."""
import json
import os
import pathlib
import resource
import socket
import struct
import subprocess
import sys
import threading
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "processes"))
from protocol_test import JUDGES  # noqa: E402
from system import TWO_RTPUS, System, await_that  # noqa: E402
from wire import BINARY, CLOSE, FIELDS, PING, Machine, Server, echo, head_of_frame, read_all  # noqa: E402

MIB = 1 << 20


class Hostile(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server()
        cls.machine = Machine(cls.server, "echo", echo)

    @classmethod
    def tearDownClass(cls):
        cls.machine.__exit__()
        cls.server.__exit__()

    def tearDown(self):
        self.good(self.server)

    def good(self, server):
        """A browser with the key gets the page and an answer."""
        self.assertEqual(server.get("/")[0], 200)
        with server.open() as page:
            self.assertEqual(page.call("hello")["protocol"], 1)
        await_that(lambda: server.process.poll() is None, "the server lives")

    def closes(self, code, send, target="/machine/echo", **more):
        with self.server.open(target, **more) as page:
            send(page)
            self.assertEqual(page.code(), code)

    # Requests

    def test_foreign_hosts_are_refused(self):
        port = self.server.port
        for host in (None, "", "evil.org", f"evil.org:{port}", "127.0.0.1.evil.org", f"localhost:{port}@evil.org",
                     "0.0.0.0", "127.0.0.2", f"127.0.0.1:{port}\r\nHost: 127.0.0.1:{port}"):
            with self.subTest(host):
                self.assertEqual(self.server.get("/", {"Host": host})[0], 421)
                fields = {**FIELDS, "Host": host, "Sec-WebSocket-Key": "A" * 24}
                self.assertEqual(self.server.get("/bench", fields)[0], 421)

    def test_pages_of_other_origins_are_refused(self):
        port = self.server.port
        for origin in ("null", "http://evil.org", f"https://127.0.0.1:{port}", f"http://127.0.0.1:{port + 1}",
                       f"http://localhost:{port}", f"http://127.0.0.1:{port}.evil.org"):
            for target in ("/", "/bench", "/machine/echo"):
                with self.subTest((origin, target)), self.server.open(target, b"", Origin=origin) as page:
                    self.assertEqual(page.status, 403)
        self.assertEqual(self.server.get("/page.js", {"Sec-Fetch-Site": "cross-site"})[0], 403)

    def test_other_methods_and_bodies_are_refused(self):
        for method in ("POST", "PUT", "HEAD", "OPTIONS", "CONNECT"):
            self.assertEqual(self.server.get("/", method=method)[0], 405)
        self.assertEqual(self.server.answer(self.server.request("/", {"Content-Length": "5"}) + b"hello")[0], 413)
        self.assertEqual(self.server.get("/", {"Transfer-Encoding": "chunked"})[0], 413)

    def test_targets_that_are_no_names_are_refused(self):
        for target in ("/index.html", "//bench", "/bench?", "/bench/", "/%62ench", "/../../etc/passwd", "*",
                       f"http://127.0.0.1:{self.server.port}/", "/machine/", "/machine/..", "/machine/a/b",
                       "/machine/../echo", "/machine/%2e%2e", "/machine/%65cho", "/machine/echo.sock",
                       "/machine/" + "a" * 65):
            with self.subTest(target), self.server.open(target, b"") as page:
                self.assertEqual(page.status, 404)
        for target, status in (("/machine/echo\0", 400), ("/machine/" + "a" * 10_000, 431), ("/machine/e cho", 400)):
            with self.subTest(target), self.server.open(target, b"") as page:
                self.assertEqual(page.status, status)

    def test_bytes_that_are_no_request_are_refused(self):
        host = f"Host: 127.0.0.1:{self.server.port}\r\n".encode()
        for data, status in ((b"\x16\x03\x01\x02\x00\x01", 400), (b"GET / HTTP/1.1\n", 400),
                             (b"GET / HTTP/1.1\rH", 400), (b"\r\n\r\n", 400),
                             (b"GET / HTTP/1.1\r\n" + host + b" folded: x\r\n\r\n", 400),
                             (b"GET / HTTP/1.1\r\nA: \0\r\n", 400), (b"GET / HTTP/1.0\r\n\r\n", 505),
                             (b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", 505), (b"A" * 8192, 431),
                             (b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 5000, 431), (b"\0" * 64, 400)):
            with self.subTest(data[:40]):
                self.assertEqual(self.server.answer(data)[0], status)

    def test_a_second_request_on_a_connection_is_not_answered(self):
        answer = self.server.answer(self.server.request("/icon.svg") * 3)[1]
        self.assertEqual(answer.count(b"HTTP/1.1"), 1)

    def test_cookies_of_other_ports_are_no_hindrance(self):
        with self.server.open(Cookie="a=" + "b" * 7000) as page:
            self.assertEqual(page.call("hello")["protocol"], 1)

    def test_a_key_before_the_websocket_is_open_is_refused(self):
        head = self.server.request("/bench", {**FIELDS, "Sec-WebSocket-Key": "A" * 22 + "=="})
        self.assertEqual(self.server.answer(head + head_of_frame(1) + b"\0\0\0\0x")[0], 400)

    def test_a_websocket_without_upgrade_is_refused(self):
        self.assertEqual(self.server.get("/bench")[0], 426)
        with self.server.open("/bench", b"", **{"Sec-WebSocket-Version": "8"}) as page:
            self.assertEqual(page.status, 426)

    def test_every_answer_has_the_fields_of_safety(self):
        with self.server.open() as page:
            heads = [page.head, self.server.get("/")[1].decode(), self.server.get("/x")[1].decode()]
        for head in heads:
            self.assertIn("\r\nContent-Security-Policy: default-src 'none'; ", head)
            self.assertIn("frame-ancestors 'none'\r\n", head)
            self.assertIn("\r\nX-Content-Type-Options: nosniff\r\n", head)

    # Keys

    def test_other_keys_are_refused(self):
        key = self.server.key
        for wrong in ("x", "", key[:-1], key + "A", key.swapcase(), key + "\n", key[1:] + key[0], key * 2):
            for target in ("/bench", "/machine/echo", "/machine/nothing"):
                with self.subTest((wrong, target)), self.server.open(target, wrong) as page:
                    self.assertEqual(page.code(), 4401)

    def test_frames_that_are_no_key_are_refused(self):
        self.closes(1003, lambda page: page.send(self.server.key, BINARY), key=b"")
        self.closes(1009, lambda page: page.send("A" * 129), key=b"")
        self.closes(1009, lambda page: page.wire.sendall(head_of_frame(1 << 62) + b"\0\0\0\0"), key=b"")
        self.closes(1002, lambda page: page.send(self.server.key, masked=False), key=b"")

    def test_the_key_of_an_earlier_start_is_refused_at_the_same_port(self):
        with Server() as first:
            key, port = first.key, first.port
            with first.open() as page:
                page.call("hello")
                first.process.terminate()
                self.assertEqual(page.code(), 1001)
            self.assertEqual(first.end(), 0)
            with Server(port=port) as second:
                self.assertEqual(second.port, port)
                with second.open(key=key) as page:
                    self.assertEqual(page.code(), 4401)
                self.good(second)

    # Frames

    def test_frames_that_break_the_protocol_end_the_websocket(self):
        self.closes(1002, lambda page: page.send("x", masked=False))
        self.closes(1002, lambda page: page.send("x", 3))
        self.closes(1002, lambda page: page.send("x", bits=4))
        self.closes(1002, lambda page: page.send("x", 0))
        self.closes(1002, lambda page: page.send("x" * 126, PING))
        self.closes(1002, lambda page: page.send(b"\x03", CLOSE))

    def test_frames_that_are_no_line_end_the_websocket(self):
        self.closes(1003, lambda page: page.send(b"{}", BINARY))
        self.closes(1007, lambda page: page.send("{}\n{}"))
        self.closes(1007, lambda page: page.send(b"\xff\xfe"))
        self.closes(1009, lambda page: page.send("x" * (MIB + 1)))
        self.closes(1009, lambda page: page.wire.sendall(head_of_frame(1 << 62) + b"\0\0\0\0"))

    def test_a_line_comes_back_whole_however_it_is_cut(self):
        with self.server.open("/machine/echo") as page:
            for text in ("{}", "", "ä" * 1000, "x" * MIB):
                threading.Thread(target=page.send, args=(text,)).start()
                self.assertEqual(page.message(), text)
            page.send("a", last=False)
            page.send("between", PING)
            page.send(b"\xc3", 0, last=False)
            page.send(b"", 0, last=False)
            page.send(b"\xa4", 0)
            self.assertEqual(page.message(), "aä")

    def test_a_flood_of_pings_and_of_empty_frames_ends_nothing(self):
        with self.server.open("/machine/echo") as page:
            reader = threading.Thread(target=lambda: self.assertEqual(page.message(), "last"))
            reader.start()
            for _ in range(50):
                page.wire.sendall((head_of_frame(1, PING) + b"\0\0\0\0x") * 100)
            page.send("", last=False)
            page.wire.sendall((head_of_frame(0, 0, last=False) + b"\0\0\0\0") * 5000)
            page.send("last", 0)
            reader.join()

    def test_ends_of_all_kinds_leave_the_others_alone(self):
        for end in (lambda page: page.send(b"", CLOSE), lambda page: page.send(struct.pack(">H", 1000), CLOSE),
                    lambda page: page.wire.shutdown(socket.SHUT_WR), lambda page: page.wire.close(),
                    lambda page: (page.wire.sendall(head_of_frame(100) + b"half"), page.wire.close()),
                    lambda page: (page.wire.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0)),
                                  page.wire.close())):
            for target in ("/bench", "/machine/echo"):
                for key in (None, b""):
                    with self.server.open(target, key) as page:
                        end(page)
                    self.good(self.server)

    # Numbers

    def test_clients_that_hang_are_ended_each_for_its_reason(self):
        def flood(connection):
            line = b"x" * 1000 + b"\n"
            while True:
                connection.sendall(line * 100)

        server, before, n_before = self.server, self.server.resident(), descriptors(self.server.process.pid)
        with Machine(server, "flood", flood), Machine(server, "deaf", lambda c: threading.Event().wait(30)):
            silent, half, keyless = server.connect(), server.connect(), server.open(key=b"")
            half.sendall(b"GET / HTTP/1.1\r\nHost: ")
            idle, unread, deaf = server.open(), server.open("/machine/flood"), server.open("/machine/deaf")
            deaf.wire.settimeout(0.1)
            try:
                while True:
                    deaf.send("x" * MIB)
            except OSError:
                deaf.wire.settimeout(60)
            self.good(server)
            self.assertEqual(keyless.code(), 4408)
            self.assertEqual(read_all(silent), b"")
            self.assertEqual(read_all(half).split()[1], b"408")
            kinds = []
            while (frame := idle.frame())[0] != CLOSE:
                kinds.append(frame[0])
            self.assertEqual((set(kinds), struct.unpack(">H", frame[2][:2])[0]), ({PING}, 4408))
            self.assertEqual(deaf.code(), 4502)
            # At the beginning those of the test before may still be closing: fewer are right too.
            await_that(lambda: descriptors(server.process.pid) <= n_before, "the end of what is not read")
            self.assertLess(server.resident() - before, 64 * MIB)
            for one in (silent, half, keyless.wire, idle.wire, unread.wire, deaf.wire):
                one.close()

    def test_two_hundred_clients_without_a_key_shut_no_browser_out(self):
        before = self.server.resident()
        crowd = [self.server.connect() for _ in range(100)]
        for one in crowd[:50]:
            one.sendall(b"GET / HTTP/1.1\r\n")
        sockets = [self.server.connect() for _ in range(100)]
        for one in sockets:
            one.sendall(self.server.request("/bench", {**FIELDS, "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA=="}))
        self.good(self.server)
        self.assertLess(self.server.resident() - before, 64 * MIB)
        for one in crowd + sockets:
            one.close()

    def test_two_hundred_browsers_at_once_are_all_served(self):
        found = []
        crowd = [threading.Thread(target=lambda: found.append(self.server.get("/page.js")[0])) for _ in range(200)]
        for one in crowd:
            one.start()
        for one in crowd:
            one.join()
        self.assertEqual(found, [200] * 200)

    def test_places_are_counted(self):
        pages = [self.server.open() for _ in range(12)]
        for page in pages:
            page.call("hello")
        with self.server.open() as page:
            self.assertEqual(page.code(), 4429)
        machines = [self.server.open("/machine/echo") for _ in range(52)]
        for machine in machines:
            machine.send("{}")
            self.assertEqual(machine.message(), "{}")
        with self.server.open("/machine/echo") as page:
            self.assertEqual(page.code(), 4429)
        for one in pages + machines:
            one.send(b"", CLOSE)
            one.code()
            one.wire.close()

    def test_a_line_of_any_length_passes_in_little_memory(self):
        line = b"x" * (40 * MIB)
        before = self.server.resident()
        with Machine(self.server, "long", lambda c: (c.sendall(line + b"\nend\n"), c.recv(1))):
            with self.server.open("/machine/long") as page:
                self.assertEqual(len(page.message()), len(line))
                self.assertEqual(page.message(), "end")
                self.assertLess(self.server.resident() - before, 32 * MIB)

    # The server

    def test_refusals_are_counted_beyond_sixteen_and_cannot_steer_a_terminal(self):
        with Server() as server:
            for i in range(40):
                server.get(f"/{i}\x9b31m")
            server.end()
            lines = server.said().splitlines()
            self.assertEqual(len(lines), 16)
            self.assertTrue(all(line.startswith("chimera-web: 404: there is no ") for line in lines), lines)
            self.assertNotIn("\x9b", server.said())

    def test_a_low_limit_of_files_is_reported_and_the_server_goes_on(self):
        with Server(prefix=("prlimit", "--nofile=24:24")) as server:
            crowd = []
            while "ulimit -n" not in server.said() and len(crowd) < 200:
                crowd.append(server.connect())
                crowd[-1].sendall(b"GET /")
            await_that(lambda: "ulimit -n" in server.said(), "the report")
            for one in crowd:
                one.close()
            self.good(server)

    def test_a_lost_output_ends_nothing(self):
        reading, writing = os.pipe()
        os.close(reading)
        with Server(stdout=writing) as server:
            os.close(writing)
            await_that(lambda: server.process.poll() is not None or listens(server.process.pid), "a port")
            self.assertEqual(server.end(), 0)

    def test_a_port_in_use_is_refused(self):
        words = [str(self.server.process.args[0]), "--port", str(self.server.port)]
        done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn(f"port {self.server.port} of 127.0.0.1: Address already in use", done.stderr)

    def test_only_loopback_is_bound(self):
        self.assertEqual(listens(self.server.process.pid), [f"0100007F:{self.server.port:04X}"])

    def test_a_killed_manager_ends_the_websocket_and_the_next_one_is_reached(self):
        with System(TWO_RTPUS) as system, Server(runtime=system.runtime) as server:
            with server.open("/machine/subject") as page:
                hello = page.call("hello")
                page.call("subscribe", to="status")
                self.assertTrue(system.kill(hello["manager"]["pid"]))
                self.assertEqual(page.code(), 4502)
            with server.open("/machine/subject") as page:
                self.assertGreater(page.call("hello")["manager"]["starts"], hello["manager"]["starts"])
            with server.open() as page:
                self.assertEqual(page.call("machines"), {"machines": [{"name": "subject", "service": False}]})
                JUDGES["bench_hello"].validate(page.call("hello"))
                page.call("subscribe", to="machines")
                JUDGES["notification"].validate(json.loads(page.message()))
                page.send(json.dumps({"jsonrpc": "2.0", "id": 9, "method": "status"}))
                JUDGES["answer"].validate(json.loads(page.message()))
                system.client.close()
                self.assertEqual(system.process.send_signal(2), None)
                note = json.loads(page.message())
                self.assertEqual(note["params"]["machines"], [])

    def test_without_file_there_is_no_draft(self):
        with self.server.open() as page:
            for method, parameters in (("draft", {}), ("edit", {"version": 1, "acts": []}), ("start", {}),
                                       ("replace", {"version": 1, "text": ""}), ("remedies", {"version": 1}),
                                       ("transitions", {"version": 1}), ("differences", {}), ("write", {"version": 1}),
                                       ("keep", {"what": "file"})):
                answer = page.ask(method, **parameters)
                JUDGES["answer"].validate(answer)
                self.assertEqual(answer["error"]["data"]["kind"], "draft", method)


def descriptors(pid):
    return len(os.listdir(f"/proc/{pid}/fd"))


def listens(pid):
    """The addresses at which a process listens, as /proc/net/tcp has them."""
    held = {os.readlink(entry) for entry in pathlib.Path(f"/proc/{pid}/fd").iterdir() if entry.is_symlink()}
    rows = [row.split() for name in ("tcp", "tcp6") for row in
            pathlib.Path(f"/proc/net/{name}").read_text().splitlines()[1:]]
    return [row[1] for row in rows if row[3] == "0A" and f"socket:[{row[9]}]" in held]


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_NOFILE, (4096, resource.getrlimit(resource.RLIMIT_NOFILE)[1]))
    unittest.main(verbosity=2)
