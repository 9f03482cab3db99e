# SPDX-License-Identifier: Apache-2.0
"""One test file of the page: PageTest is the base of its tests, main() runs them. After each test the console has no
error, and each frame fits the schema. What a failed test leaves is in BUILD/page_failures/TEST."""
import os
import pathlib
import re
import shutil
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree as xml

from browser import Browser
from frames import Frames
from page import Page
from web import Web

BUILD = pathlib.Path(os.environ["CHIMERA_BUILD"]).resolve()


class PageTest(unittest.TestCase):
    """A test with a tab, and an XDG_RUNTIME_DIR of its own. `expected`: patterns of console errors that the test itself
    causes, as by an end of the server. `is_newer`: the server speaks a later protocol than the schema has."""

    browser, is_newer = None, False

    def setUp(self):
        self.place = pathlib.Path(tempfile.mkdtemp(prefix="chimera-page-"))
        self.addCleanup(shutil.rmtree, self.place, ignore_errors=True)
        self.runtime = self.place / "runtime"
        self.runtime.mkdir(mode=0o700)
        self.expected, self.messages, self.frames, self.speakers = [], [], Frames(), []
        if PageTest.browser is None:
            PageTest.browser = Browser()
        self.browser.new_tab()
        self.addCleanup(self.browser.close_tabs)
        self.page = Page(self.browser)

    def tearDown(self):
        self.read_logs()
        errors = [text for level, text in self.messages if level == "SEVERE" or "Content Security Policy" in text]
        errors = [text for text in errors if not any(re.search(pattern, text) for pattern in self.expected)]
        self.assertEqual(errors, [], "errors of the console")
        if not self.is_newer:
            self.assertEqual(self.frames.faults(), [], "frames that do not fit the schema")

    def read_logs(self):
        self.messages += self.browser.messages()
        self.frames.add(self.browser.notices())

    def using(self, context):
        """Enters the context, and leaves it when the test ends."""
        self.addCleanup(context.__exit__, None, None, None)
        if hasattr(context, "said"):
            self.speakers.append(context)
        return context.__enter__()

    def look_at(self, door, name="", arguments=()):
        """Starts `door`, the server or machine behind the page, and a chimera-web. Opens the page, and waits until it
        shows the subsystem `name` (empty: the only one). Returns `door`."""
        door = self.using(door)
        self.web_server = self.web(*arguments)
        self.page.open(self.web_server.link + (f"&machine={name}" if name else ""))
        self.page.await_open()
        return door

    def web(self, *arguments, **more):
        """A running chimera-web of this test."""
        return self.using(Web(self.runtime, arguments, **more))

    def sent(self, name, method):
        """Parameters of what the page asked the machine of that name so far."""
        self.read_logs()
        return self.frames.sent("/machine/" + name, method)

    def leave_evidence(self):
        """Picture, console, frames and text of the page, what the programs said. Returns their folder."""
        folder = BUILD / "page_failures" / self.id().removeprefix("__main__.")
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        try:
            self.read_logs()
            self.browser.driver.save_screenshot(str(folder / "page.png"))
            (folder / "page.html").write_text(self.browser.driver.page_source)
        finally:
            (folder / "console.txt").write_text("".join(f"{level} {text}\n" for level, text in self.messages))
            (folder / "programs.txt").write_text("\n".join(program.said() for program in self.speakers))
            (folder / "frames.txt").write_text("".join(line + "\n" for line in self.frames.lines()))
        return folder


class Result(unittest.TestResult):
    """Prints a line for each test, and keeps all as cases of a file of GoogleTest: tools/dev/results.py counts them."""

    def __init__(self, suite):
        super().__init__()
        self.suite, self.begin, self.case = suite, 0.0, None

    def startTest(self, test):
        super().startTest(test)
        self.begin = time.monotonic()
        kind, name = test.id().rsplit(".", 2)[-2:]
        self.case = xml.SubElement(self.suite, "testcase", classname=kind, name=name, status="run", result="completed")

    def stopTest(self, test):
        super().stopTest(test)
        word = {"failure": "FAILED", "skipped": "skipped"}.get(self.case[0].tag if len(self.case) else "", "passed")
        print(f"{word} {self.case.get('name')}  {time.monotonic() - self.begin:.1f} s", flush=True)

    def note(self, tag, text):
        print(text, flush=True)
        if not len(self.case):
            xml.SubElement(self.case, tag, message=text)

    def fault(self, test, text):
        """A failure of the test: the first one leaves its evidence."""
        if self.case is None:  # outside of a test: the class of tests
            self.startTest(test)
        if isinstance(test, PageTest) and not len(self.case):
            try:
                text += f"picture, console and frames: {test.leave_evidence()}"
            except Exception as error:  # pylint: disable=broad-except
                text += f"no picture: {error}"
        self.note("failure", text)

    def addFailure(self, test, err):
        super().addFailure(test, err)
        self.fault(test, self.failures[-1][1])

    def addError(self, test, err):
        super().addError(test, err)
        self.fault(test, self.errors[-1][1])

    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        self.note("skipped", reason)


def main():
    """Runs the tests of the calling file; `FILE NAME...` those of that name. Exit 1 if one fails."""
    tests = unittest.TestSuite()
    for test in flat(unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"])):
        if not sys.argv[1:] or any(word in test.id() for word in sys.argv[1:]):
            tests.addTest(test)
    root = xml.Element("testsuites")
    result = Result(xml.SubElement(root, "testsuite", name=pathlib.Path(sys.argv[0]).stem))
    try:
        tests.run(result)
    finally:
        if PageTest.browser is not None:
            PageTest.browser.close()
        kind, _, path = os.environ.get("GTEST_OUTPUT", "").partition(":")
        if kind == "xml" and path:
            pathlib.Path(path).parent.mkdir(parents=True, exist_ok=True)
            xml.ElementTree(root).write(path)
    print(f"{result.testsRun} tests, {len(result.failures) + len(result.errors)} failed")
    return 0 if result.testsRun and result.wasSuccessful() else 1


def flat(tests):
    for test in tests:
        yield from flat(test) if isinstance(test, unittest.TestSuite) else [test]
