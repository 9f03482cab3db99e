# SPDX-License-Identifier: Apache-2.0
"""Pages of other origins, in a real browser, against chimera-web: each knows the port, and even the key, and none
reaches a file, the bench or a machine. docs/security.md, "The page"."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

from case import PageTest, main  # noqa: E402
from door import Door  # noqa: E402
from forward import Forward  # noqa: E402
from hostile import Elsewhere  # noqa: E402
from page import Keys  # noqa: E402

OWN = "/page.css"  # a document of the origin of chimera-web that connects to nothing by itself
REFUSED = r"(?m)^chimera-web: 4\d\d: "  # a line of standard error
HELLO = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "hello", "params": {}})
# Opens a WebSocket, sends the key and a question; `seen`: what it heard.
SOCKET = """
const [address, key, hello, done] = arguments, seen = [];
const socket = new WebSocket(address);
socket.onopen = () => { seen.push('open'); socket.send(key); socket.send(hello); };
socket.onmessage = (message) => { seen.push(message.data); socket.close(); };
socket.onclose = () => done(seen);
document.addEventListener('securitypolicyviolation', () => done(seen));
"""
# A document without an origin does the same, and reports to the page around it.
APART = """
const [address, key, hello, kind, isolation, done] = arguments;
const text = `<script>const seen = [], socket = new WebSocket('${address}');
  socket.onopen = () => { seen.push('open'); socket.send('${key}'); };
  socket.onclose = () => parent.postMessage(seen, '*');<` + `/script>`;
const frame = document.createElement('iframe');
if (kind === 'data') frame.src = 'data:text/html,' + encodeURIComponent(text);
else { frame.setAttribute(isolation, 'allow-scripts'); frame.srcdoc = text; }
window.onmessage = (message) => done(message.data);
document.body.append(frame);
"""
# Loads what an element names; the answer is 'load' or 'error'.
ELEMENT = """
const [tag, name, address, done] = arguments;
const element = document.createElement(tag);
if (tag === 'link') element.rel = 'stylesheet';
element.onload = () => done('load');
element.onerror = () => done('error');
element[name] = address;
document.body.append(element);
"""
# A request by script; the answer is its text, or the name of the failure.
FETCH = """
const [address, options, done] = arguments;
fetch(address, options).then((answer) => answer.text().then((text) => done(answer.type + ' ' + text)),
                             (error) => done(error.name));
"""


class OriginTest(PageTest):
    """Each test begins with a page of another site; at its end chimera-web has answered nothing but refusals."""

    def setUp(self):
        super().setUp()
        self.expected = [""]  # the browser reports each refusal
        self.elsewhere = self.using(Elsewhere())
        self.door = self.using(Door(self.runtime))
        self.server = self.web()
        self.mine, self.statuses = set(), []

    def at(self, host="evil.test"):
        self.browser.driver.get(self.elsewhere.address(host))

    def run_there(self, script, *arguments):
        return self.browser.driver.execute_async_script(script, *arguments)

    def answers(self):
        """Status of each answer of chimera-web so far, as the browser saw it."""
        for method, facts in self.browser.notices():
            url = facts.get("request", facts.get("response", {})).get("url", "")
            if f":{self.server.port}/" in url:
                self.mine.add(facts["requestId"])
            if method == "Network.responseReceivedExtraInfo" and facts["requestId"] in self.mine:
                self.statuses.append(facts["statusCode"])
        return self.statuses

    def assert_nothing_reached(self):
        self.assertEqual(self.door.requests, [])
        self.assertRegex(self.server.said(), REFUSED)

    def socket(self, address):
        return self.run_there(SOCKET, address, self.server.key, HELLO)

    def refused_socket(self, path, server_host="127.0.0.1"):
        self.assertEqual(self.socket(f"ws://{server_host}:{self.server.port}{path}"), [])
        self.assert_nothing_reached()

    # ---- WebSockets

    def test_the_own_page_is_heard(self):
        """The control: the same script from the origin of chimera-web is answered."""
        self.browser.driver.get(self.server.origin() + OWN)
        for path in ("/bench", "/machine/plant"):
            seen = self.socket(f"ws://127.0.0.1:{self.server.port}{path}")
            self.assertEqual(seen[0], "open")
            self.assertEqual(json.loads(seen[1])["result"]["protocol"], 1)
        self.assertEqual(len(self.door.asked("hello")), 1)

    def test_a_wrong_key_is_refused(self):
        self.browser.driver.get(self.server.origin() + OWN)
        address = f"ws://127.0.0.1:{self.server.port}/machine/plant"
        for key in ("", "A" * 43, self.server.key[:-1], self.server.key + "A", self.server.key.swapcase()):
            self.assertEqual(self.run_there(SOCKET, address, key, HELLO), ["open"], key)
        self.assertEqual(self.door.requests, [])
        self.read_logs()
        self.assertEqual(len(self.frames.faults()), 3)  # the shorter and longer keys
        self.frames.sockets.clear()

    def test_a_websocket_of_another_site_is_refused(self):
        self.at()
        self.refused_socket("/bench")

    def test_a_websocket_of_another_site_to_a_machine_is_refused(self):
        self.at()
        self.refused_socket("/machine/plant")

    def test_a_websocket_of_another_port_of_this_host_is_refused(self):
        self.at("127.0.0.1")
        self.refused_socket("/machine/plant")

    def test_a_websocket_to_another_name_of_this_host_is_stopped_by_the_policy(self):
        self.browser.driver.get(f"http://localhost:{self.server.port}{OWN}")
        self.assertEqual(self.socket(f"ws://127.0.0.1:{self.server.port}/machine/plant"), [])
        self.assertEqual(self.door.requests, [])

    def test_a_websocket_of_an_isolated_frame_is_refused(self):
        self.apart("frame")

    def test_a_websocket_of_a_data_document_is_refused(self):
        self.apart("data")

    def apart(self, kind):
        self.at()
        address = f"ws://127.0.0.1:{self.server.port}/machine/plant"
        self.assertEqual(self.run_there(APART, address, self.server.key, HELLO, kind, "sand" + "box"), [])
        self.assert_nothing_reached()

    # ---- a name that leads here

    def test_a_page_by_a_foreign_name_is_refused(self):
        self.browser.driver.get(f"http://evil.test:{self.server.port}/")
        self.assertNotIn("id=\"page\"", self.browser.driver.page_source)
        self.assertEqual(set(self.answers()), {421})

    def test_a_websocket_by_a_foreign_name_is_refused(self):
        self.browser.driver.get(f"http://evil.test:{self.server.port}/")
        self.refused_socket("/machine/plant", "evil.test")

    # ---- requests by script

    def fetched(self, path, **options):
        self.at()
        said = self.run_there(FETCH, self.server.origin() + path, options)
        self.assertRegex(self.server.said(), REFUSED)
        self.assertTrue(all(status >= 400 for status in self.answers()), self.statuses)
        return said

    def test_a_read_by_script_is_refused(self):
        self.assertEqual(self.fetched("/"), "TypeError")

    def test_a_read_without_looking_is_refused(self):
        self.assertIn(self.fetched("/page.js", mode="no-cors"), ("TypeError", "opaque "))

    def test_a_post_without_looking_is_refused(self):
        self.assertIn(self.fetched("/bench", mode="no-cors", method="POST", body=HELLO), ("TypeError", "opaque "))

    def test_a_question_before_a_request_is_refused(self):
        self.assertEqual(self.fetched("/bench", method="PUT", headers={"X-Key": "1"}), "TypeError")

    def test_a_beacon_is_refused(self):
        self.at()
        self.run_there("const [to, text, done] = arguments; navigator.sendBeacon(to, text);"
                       "fetch(to).then(() => done(1), () => done(0));", self.server.origin() + "/bench", HELLO)
        self.assert_nothing_reached()

    def test_a_stream_of_events_is_refused(self):
        self.at()
        heard = self.run_there("const [to, done] = arguments, source = new EventSource(to);"
                               "source.onopen = () => done('open');"
                               "source.onerror = () => { source.close(); done('error'); };",
                               self.server.origin() + "/bench")
        self.assertEqual(heard, "error")
        self.assert_nothing_reached()

    # ---- elements of another page

    def element(self, tag, name, path):
        self.at()
        self.assertEqual(self.run_there(ELEMENT, tag, name, self.server.origin() + path), "error")
        self.assertTrue(all(status >= 400 for status in self.answers()), self.statuses)

    def test_the_script_is_not_loaded_elsewhere(self):
        self.element("script", "src", "/page.js")

    def test_the_style_is_not_loaded_elsewhere(self):
        self.element("link", "href", "/page.css")

    def test_the_picture_is_not_loaded_elsewhere(self):
        self.element("img", "src", "/icon.svg")

    def test_the_page_is_not_framed(self):
        for host in ("evil.test", "127.0.0.1"):
            self.at(host)
            self.run_there("const [to, done] = arguments, frame = document.createElement('iframe');"
                           "frame.onload = () => done(1); frame.src = to; document.body.append(frame);",
                           self.server.origin() + "/#" + self.server.key)
            self.browser.driver.switch_to.frame(0)
            self.assertNotIn("id=\"page\"", self.browser.driver.page_source)
            self.browser.driver.switch_to.default_content()
        self.assert_nothing_reached()

    def test_the_page_does_not_frame_itself(self):
        self.browser.driver.get(self.server.origin() + OWN)
        self.browser.driver.execute_script("const frame = document.createElement('iframe'); frame.src = '/';"
                                           "document.body.append(frame);")
        self.assertTrue(any("frame" in text or "Content Security Policy" in text
                            for _, text in self.browser.messages()))

    def test_a_form_is_refused(self):
        self.at()
        self.browser.driver.execute_script(
            "const form = document.createElement('form'); form.method = 'post'; form.action = arguments[0];"
            "document.body.append(form); form.submit();", self.server.origin() + "/")
        self.page.await_that("!document.querySelector('title') || document.title !== 'elsewhere'", "the answer")
        self.assertNotIn("id=\"page\"", self.browser.driver.page_source)
        self.assert_nothing_reached()

    def test_a_link_of_another_site_is_refused(self):
        self.at()
        self.browser.driver.execute_script(
            "const link = document.createElement('a'); link.href = arguments[0]; document.body.append(link);"
            "link.click();", self.server.link)
        self.page.await_that("document.title !== 'elsewhere'", "the answer")
        self.assertNotIn("id=\"page\"", self.browser.driver.page_source)
        self.assert_nothing_reached()


class ForwardTest(PageTest):
    """A person at another computer, whose `ssh -L` has another port there."""

    def test_the_page_works_through_a_forwarded_port(self):
        door, server = self.using(Door(self.runtime)), self.web()
        forward = self.using(Forward(server.port))
        for host in ("127.0.0.1", "localhost"):
            self.page.open(f"http://{host}:{forward.port}/#{server.key}")
            self.page.await_open()
            self.assertEqual(self.page.states(), {"task0": "ON", "task1": "ON", "task2": "ON"})
            before = len(door.asked("set"))
            self.page.type_over("#set-wish", "2.5", Keys.ENTER)
            door.await_asked("set", before + 1)
            self.assertEqual(door.asked("set")[-1], {"values": {"wish": "2.5"}})
        self.assertGreater(forward.taken, 2)
        self.assertNotRegex(server.said(), REFUSED)


if __name__ == "__main__":
    sys.exit(main())
