# SPDX-License-Identifier: Apache-2.0
"""A web server of another origin, with an empty page: what a test runs there, the browser sends as that origin."""
import http.server
import threading


class Answer(http.server.BaseHTTPRequestHandler):
    """Answers each request with an empty document."""

    def do_GET(self):
        text = b"<!doctype html><html lang=en><title>elsewhere</title><body></body></html>"
        self.send_response(200)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.send_header("Content-Length", str(len(text)))
        self.end_headers()
        self.wfile.write(text)

    def log_message(self, *_):
        pass


class Elsewhere:
    """The server. evil.test is another site: the browser takes this name for 127.0.0.1."""

    def __enter__(self):
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Answer)
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        return self

    def __exit__(self, *_):
        self.server.shutdown()
        self.server.server_close()

    def address(self, host):
        return f"http://{host}:{self.server.server_port}/"
