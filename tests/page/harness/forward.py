# SPDX-License-Identifier: Apache-2.0
"""What `ssh -L` does on the computer of a person: takes connections at a port of its own and hands every byte on."""
import contextlib
import socket
import socketserver
import threading


def pump(source, target):
    with contextlib.suppress(OSError):
        while data := source.recv(1 << 16):
            target.sendall(data)
    for end, how in ((source, socket.SHUT_RD), (target, socket.SHUT_WR)):
        with contextlib.suppress(OSError):
            end.shutdown(how)


class Forward:
    """Leads from `port`, one that is free, to another port of 127.0.0.1. `taken`: connections so far."""

    def __init__(self, to):
        self.to, self.taken = to, 0

    def __enter__(self):
        forward = self

        class Handler(socketserver.BaseRequestHandler):
            def handle(self):
                forward.taken += 1
                with socket.create_connection(("127.0.0.1", forward.to)) as there:
                    back = threading.Thread(target=pump, args=(there, self.request), daemon=True)
                    back.start()
                    pump(self.request, there)
                    back.join()

        self.server = socketserver.ThreadingTCPServer(("127.0.0.1", 0), Handler)
        self.server.daemon_threads, self.server.block_on_close = True, False
        self.port = self.server.server_address[1]
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        return self

    def __exit__(self, *_):
        self.server.shutdown()
        self.server.server_close()
