# SPDX-License-Identifier: Apache-2.0
"""A newcomer builds Figure 4 of the 1994 paper from an empty file, and sees that the arm follows: by the steps of
docs/howto/assemble.md, with the mouse and by keyboard alone. The acts are added up by the keystroke-level model."""
import csv
import json
import os
import pathlib
import re
import sys

from selenium.webdriver.common.action_chains import ActionChains

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

from case import PageTest, main  # noqa: E402
from page import Keys, quoted  # noqa: E402

SOURCE = pathlib.Path(os.environ["CHIMERA_SOURCE"])
DOCUMENT = SOURCE / "docs" / "howto" / "assemble.md"
LESSON = SOURCE / "examples" / "01_puma_pid" / "puma_pid.yaml"
# Seconds of the keystroke-level model: a key or a click, a pointing, a hand that changes its place, a decision.
K, P, H, M = 0.28, 1.1, 0.4, 1.35
MOST = 150.0
ACT = re.compile(r"press \*([^*]+)\*|type `([^`]+)`|key `([^`]+)`")
# Elements with that name that can be seen: buttons, and fields by their label.
NAMED = """
const fits = (words) => words === arguments[0] || words.startsWith(arguments[0] + ':');
const nameOf = (e) => (e.getAttribute('aria-label') ?? e.textContent).trim();
const labels = [...document.querySelectorAll('label')].filter((e) => fits(e.firstChild?.textContent?.trim() ?? ''))
  .map((e) => e.control);
return [...document.querySelectorAll('button')].filter((e) => fits(nameOf(e))).concat(labels)
  .find((e) => e && e.getClientRects().length > 0) ?? null;
"""
CENTRE_IS_SEEN = """
const box = arguments[0].getBoundingClientRect();
const top = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
return top !== null && arguments[0].contains(top);
"""
# A press of it, or Enter in it, makes a version of the draft: it is a button at a fault, or adds a task.
EDITS = """
const [e, isKey] = arguments;
const buttons = '.faults .acts button, [data-try-message] ~ .acts button, form[aria-label="Add task"] button';
return e.matches(buttons) || (isKey && e.matches('form[aria-label="Add task"] input'));
"""
# What follows from an act is shown: the next version, remedies and where the keyboard goes on, the end of a try.
IS_AT_REST = """((version, isInFaults) => {
  const data = document.documentElement.dataset, tried = document.querySelector('[data-try]');
  const remedy = data.verdict === 'faulty' ? 'li[data-fault] .acts button' : '';
  return Number(data.draft) >= version && (remedy === '' || document.querySelector(remedy)) &&
    (remedy === '' || !isInFaults || document.activeElement.matches(remedy)) &&
    (!tried || (tried.dataset.try === 'ended' && tried.textContent === '' &&
      document.querySelector('[data-verdict-of-try], [data-try-message] ~ .acts')));
})(%d, %s)"""


class Sum:
    """Counts of keys and clicks, pointings, changes of hand, decisions."""

    def __init__(self):
        self.keys = self.pointings = self.hands = self.decisions = 0
        self.hand, self.before = "", ""

    def move_to(self, place):
        self.hands += self.hand != place
        self.hand = place

    def add(self, verb, words):
        """A decision precedes each act but Tab, and Enter behind typed words. A letter with Shift is two keys."""
        self.move_to("mouse" if verb == "press" else "keyboard")
        self.decisions += not (words == "Tab" or (words == "Enter" and self.before == "type"))
        self.pointings += verb == "press"
        self.keys += sum(2 if letter.isupper() or letter == "_" else 1 for letter in words) if verb == "type" else 1
        self.before = verb

    def seconds(self):
        return K * self.keys + P * self.pointings + H * self.hands + M * self.decisions

    def __str__(self):
        return (f"{self.seconds():.1f} s: {self.keys} keys and clicks, {self.pointings} pointings, {self.hands} "
                f"changes of hand, {self.decisions} decisions")


def steps(way):
    """The acts of the document for that way, "Mouse" or "Keyboard": (verb, words) each."""
    found = re.findall(rf"^   - {way}: (.*(?:\n     .*)*)$", DOCUMENT.read_text(), re.MULTILINE)
    acts = []
    for words in found:
        left = ACT.sub("", words)
        assert re.fullmatch(r"[,\s]*", left), f"{DOCUMENT}: no act: {left}"
        acts += [("press", name) if name else ("type", text) if text else ("key", key)
                 for name, text, key in ACT.findall(words)]
    assert len(found) >= 5, f"{DOCUMENT}: {len(found)} steps for {way}"
    return acts


class NewcomerTest(PageTest):
    def named(self, name):
        """What has the name, once it is there, at a place that is seen without scrolling."""
        self.page.await_that(f"(() => {{ {NAMED.replace('arguments[0]', quoted(name))} }})()", name)
        element = self.page.script(NAMED, name)
        self.assertTrue(self.page.script(CENTRE_IS_SEEN, element), f"{name} is hidden")
        return element

    def carry_out(self, verb, words):
        if verb == "type":
            return self.page.press(words)
        element = self.named(words) if verb == "press" else self.page.script("return document.activeElement")
        edits = (verb == "press" or words == "Enter") and self.page.script(EDITS, element, verb == "key")
        is_in_faults = verb == "key" and self.page.script("return arguments[0].matches('.faults *')", element)
        version = int(self.page.root("draft")) + bool(edits)
        if verb == "press":
            ActionChains(self.browser.driver, duration=0).move_to_element(element).click().perform()
        else:
            self.page.press(getattr(Keys, words.upper()) if len(words) > 1 else words)
        self.page.await_that(IS_AT_REST % (version, json.dumps(bool(is_in_faults))), f"the end of {verb} {words}")

    def build(self, way):
        self.page.open(self.web(self.place / "arm.yaml").link)
        self.page.await_root("draft", "1")
        total = Sum()
        for verb, words in steps(way):
            self.carry_out(verb, words)
            total.add(verb, words)
        print(f"{way}: {total}")
        return total

    def expect_that_the_arm_follows(self):
        self.page.await_one("[data-verdict-of-try=clean]")
        self.read_logs()
        tries = [line["result"]["csv"] for socket in self.frames.of("/bench") for line in socket.received
                 if (line.get("result") or {}).get("ended")]
        heading, *rows = csv.reader(tries[-1].splitlines())
        names = [name.split("(")[0] for name in heading]
        self.assertEqual(names[1:], [f"{name}[{joint}]" for name in ("q", "q_ref") for joint in range(6)])
        rows = [[float(word) for word in row] for row in rows]
        self.assertGreaterEqual(rows[-1][0], 1.9)
        for joint in range(1, 7):
            self.page.await_one(f"path[data-channel='{names[joint]}']")
            self.page.await_one(f"path[data-channel='{names[joint + 6]}']")
            self.assertLess(max(abs(row[joint] - row[joint + 6]) for row in rows), 0.05)
            self.assertLess(abs(rows[-1][joint] - rows[-1][joint + 6]), 0.002)
            self.assertGreater(abs(rows[-1][joint] - rows[0][joint]), 0.5)

    def expect_values_of_the_lesson(self):
        text = self.page.attribute("#draft-text", "value")
        for name in ("start_pose", "goal", "kp", "ki", "kd"):
            self.assertIn(re.search(rf"^  {name}: (\[.*\])", LESSON.read_text(), re.MULTILINE)[1], text)
        self.assertIn("puma560.xml", text)

    def expect_sum_of_the_document(self, total, words):
        self.assertLessEqual(total.seconds(), MOST)
        self.assertIn(f"{total.seconds():.0f} s {words}", " ".join(DOCUMENT.read_text().split()))

    def test_figure_4_of_1994_with_the_mouse(self):
        total = self.build("Mouse")
        self.expect_that_the_arm_follows()
        self.expect_values_of_the_lesson()
        self.expect_sum_of_the_document(total, "with the mouse")

    def test_figure_4_of_1994_by_keyboard_alone(self):
        self.assertNotIn("press", [verb for verb, _ in steps("Keyboard")])
        total = self.build("Keyboard")
        self.assertEqual((total.pointings, total.hands), (0, 1))
        self.expect_that_the_arm_follows()
        self.expect_values_of_the_lesson()
        self.expect_sum_of_the_document(total, "by keyboard")


if __name__ == "__main__":
    sys.exit(main())
