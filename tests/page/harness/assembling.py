# SPDX-License-Identifier: Apache-2.0
"""The mode Assemble in a tab: a FILE of the test, its draft, and acts on it. Each act waits for the next version."""
import contextlib
import json
import subprocess

from selenium.webdriver.common.action_chains import ActionChains

from case import PageTest
from machine import await_that
from page import Keys, quoted
from web import BUILD, Web

VERSION = "Number(document.documentElement.dataset.draft)"


def field(*names):
    """The field of a key: of a task ("pid", "rate"), or of the file ("operator/x")."""
    return f"input[data-field={quoted(' '.join(names))}]"


def link(task, port):
    return f"input[data-link={quoted(f'{task} {port}')}]"


def rename(name):
    return f"input[data-rename={quoted(name)}]"


def port_of(task, port):
    return f"[data-port={quoted(f'{task} {port}')}]"


class AssembleTest(PageTest):
    """`file`: FILE."""

    def assemble(self, text=None, name="plant.yaml"):
        """Opens the page on a FILE of that name with the text or bytes; None: there is no FILE."""
        self.file = self.place / name
        if text is not None:
            self.file.write_bytes(text if isinstance(text, bytes) else text.encode())
        self.web_server = self.web(self.file)
        self.open_draft()

    def open_draft(self):
        self.page.open(self.web_server.link)
        self.page.click('[data-mode-button="assemble"]')
        self.page.await_that(f"{VERSION} >= 1", "the draft")

    def another_tab(self):
        """Opens the page once more. Returns the handles of the tab before and of this one."""
        before = self.browser.driver.current_window_handle
        self.browser.driver.switch_to.new_window("tab")
        self.open_draft()
        return before, self.browser.driver.current_window_handle

    def go_to(self, tab):
        self.browser.driver.switch_to.window(tab)

    def begin_again(self):
        """A new chimera-web after the death of the one before, and its link opened."""
        self.web_server = self.using(Web(self.runtime, [self.file], port=self.web_server.port))
        self.open_draft()

    # ---- what is seen

    def version(self):
        return int(self.page.root("draft"))

    def text(self):
        return self.page.attribute("#draft-text", "value")

    def disk(self):
        return self.file.read_bytes().decode()

    def await_text(self, text):
        self.page.await_that(f"document.getElementById('draft-text').value === {json.dumps(text)}", "the text")

    def await_focus(self, name):
        """Polls: a focus is no change of the document."""
        await_that(lambda: self.page.script("return document.activeElement.id") == name, f"the focus of {name}")

    def await_verdict(self, verdict):
        self.page.await_root("verdict", verdict)

    def check(self, *words):
        """What `chimera check` says of FILE."""
        return subprocess.run([BUILD / "bin" / "chimera", "check", *words, self.file], capture_output=True, text=True,
                              check=False, cwd=self.place).stdout

    # ---- what is done

    @contextlib.contextmanager
    def one_act(self):
        """The act inside makes one version, which one undo takes back."""
        version, undo = self.version(), int(self.page.root("undo"))
        yield
        self.page.await_that(f"{VERSION} > {version}", f"a version after {version}")
        self.assertEqual((self.version(), int(self.page.root("undo"))), (version + 1, undo + 1))

    def type_into(self, selector, words, key=Keys.ENTER):
        """Types in the place of what a field holds, then presses the key."""
        place = self.page.one(selector)
        place.send_keys(Keys.CONTROL + "a")
        place.send_keys(words or Keys.DELETE, key)

    def fill(self, selector, words):
        with self.one_act():
            self.type_into(selector, words)

    def press(self, label):
        with self.one_act():
            self.page.click(self.page.button(label))

    def choose_nothing(self):
        self.page.script("document.activeElement.blur()")
        self.page.press(Keys.ESCAPE)
        self.page.await_one("#add-task-component")

    def add_task(self, component, name=""):
        if not self.page.all("#add-task-component"):
            self.choose_nothing()
        with self.one_act():
            self.page.one("#add-task-component").send_keys(component)
            self.page.one("#add-task-name").send_keys(name, Keys.ENTER)
        self.page.await_one(self.page.box(name or component))

    def undo(self, label="Undo"):
        version = self.version()
        self.page.click(self.page.button(label))
        self.page.await_that(f"{VERSION} > {version}", label)

    def pull(self, start, end):
        """Pulls a line from port to port with the mouse."""
        ActionChains(self.browser.driver, duration=0).move_to_element(self.page.one(port_of(*start))) \
            .click_and_hold().move_to_element(self.page.one(port_of(*end))).release().perform()

    def type_text(self, text):
        """Puts a text into the drawer at once, as a paste does."""
        self.page.focus("#draft-text")
        self.page.press_with(Keys.CONTROL, "a")
        self.assertTrue(self.page.script("return document.execCommand('insertText', false, arguments[0])", text))
