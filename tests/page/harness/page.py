# SPDX-License-Identifier: Apache-2.0
"""The page in a tab: what a person does there, and what the person sees. Each wait is for a change of the document."""
import json

from selenium.common.exceptions import StaleElementReferenceException
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys


def quoted(text):
    return json.dumps(text)


class Page:
    """The present tab of the browser."""

    def __init__(self, browser):
        self.browser, self.driver = browser, browser.driver

    def open(self, link):
        self.driver.get("about:blank")  # another fragment alone would not load the page again
        self.driver.get(link)

    # ---- what is seen

    def script(self, text, *arguments):
        return self.driver.execute_script(text, *arguments)

    def all(self, selector):
        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def one(self, selector):
        """The element, once it is there."""
        return self.await_that(f"document.querySelector({quoted(selector)})", selector)

    def text(self, selector):
        return self.await_that(f"[document.querySelector({quoted(selector)}).textContent]", selector)[0]

    def texts(self, selector):
        return self.script("return [...document.querySelectorAll(arguments[0])].map(e => e.textContent)", selector)

    def attribute(self, selector, name):
        """The property of that name as text, or else the attribute."""
        return self.await_that(f"((e, name) => [name in e ? String(e[name]) : e.getAttribute(name)])"
                               f"(document.querySelector({quoted(selector)}), {quoted(name)})", selector)[0]

    def root(self, name):
        """An attribute data-NAME of the root."""
        return self.script("return document.documentElement.getAttribute('data-' + arguments[0])", name)

    # ---- waits

    def await_that(self, condition, what="the condition"):
        return self.browser.await_that(condition, what)

    def await_root(self, name, value):
        self.await_that(f"document.documentElement.getAttribute({quoted('data-' + name)}) === {quoted(value)}",
                        f"data-{name} = {value}")

    def await_one(self, selector):
        return self.one(selector)

    def await_none(self, selector):
        self.await_that(f"!document.querySelector({quoted(selector)})", f"no {selector}")

    def await_text(self, selector, words):
        """Until an element of the selector has the words in its text."""
        self.await_that(f"[...document.querySelectorAll({quoted(selector)})]"
                        f".some(e => e.textContent.includes({quoted(words)}))", f"'{words}' in {selector}")

    def await_other_text(self, selector, before):
        self.await_that(f"document.querySelector({quoted(selector)}).textContent !== {quoted(before)}",
                        f"another text than '{before}' in {selector}")

    def await_open(self, version=None):
        """Until the page shows a subsystem: connected, described and with its states."""
        self.await_root("door", "open")
        self.await_that("document.querySelector('svg.picture')", "the picture")
        if version is not None:
            self.await_root("version", str(version))

    # ---- boxes of the picture

    @staticmethod
    def box(task):
        return f"g.box[data-task={quoted(task)}]"

    def await_state(self, task, state):
        self.await_one(f"{self.box(task)}[data-state={quoted(state)}]")

    def states(self):
        return self.script("return Object.fromEntries([...document.querySelectorAll('g.box')]"
                           ".map(e => [e.dataset.task, e.dataset.state]))")

    def choose(self, *tasks):
        """Presses the boxes, the second and later ones with Ctrl."""
        for number, task in enumerate(tasks):
            if number == 0:
                self.click(self.box(task))
            else:
                ActionChains(self.driver, duration=0).key_down(Keys.CONTROL).click(self.one(self.box(task))).key_up(
                    Keys.CONTROL).perform()
        self.await_that(f"document.querySelectorAll('g.box.chosen').length === {len(tasks)}", f"{tasks} chosen")

    @staticmethod
    def button(label):
        return f"button[aria-label={quoted(label)}]"

    # ---- what is done

    def click(self, selector):
        for _ in range(5):  # a page that draws itself anew replaces elements
            try:
                return self.one(selector).click()
            except StaleElementReferenceException:
                continue
        raise AssertionError(f"{selector} is replaced again and again")

    def focus(self, selector):
        self.script("arguments[0].focus()", self.one(selector))

    def press(self, *keys):
        """Keys in turn, to what has the focus."""
        actions = ActionChains(self.driver, duration=0)
        for key in keys:
            actions.send_keys(key)
        actions.perform()

    def press_with(self, modifier, key):
        ActionChains(self.driver, duration=0).key_down(modifier).send_keys(key).key_up(modifier).perform()

    def type_over(self, selector, text, *keys):
        """Types in the place of what a field holds, then presses keys. Returns the field."""
        field = self.one(selector)
        self.await_that(f"document.querySelector({json.dumps(selector)}).value !== ''", "a value in the field")
        field.send_keys(Keys.CONTROL + "a")
        field.send_keys(text, *keys)
        return field

    def tab_to(self, selector, most=200):
        """Presses Tab until an element of the selector has the focus."""
        for _ in range(most):
            if self.script("return document.activeElement.matches(arguments[0])", selector):
                return
            self.press(Keys.TAB)
        raise AssertionError(f"{most} presses of Tab do not reach {selector}")
