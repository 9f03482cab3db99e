# SPDX-License-Identifier: Apache-2.0
"""A person tries the draft: its curves, its verdict, the question before it opens something, and its end."""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

from access import faint, unnamed  # noqa: E402
from case import PageTest, main  # noqa: E402
from machine import PLANT  # noqa: E402
from page import Keys  # noqa: E402
from system import await_that  # noqa: E402

LOGGED = """subsystem: logged
tasks:
  count: {component: t_counter, rate: 20 Hz}
  log: {component: csv_log, rate: 20 Hz, alias: {in: [count]}, resources: {file: "%s"}}
"""
ENDLESS = """subsystem: endless
tasks:
  stuck: {component: t_crash, rate: 20 Hz, constants: {how: hang}, resources: {armed: "%s"}}
"""
LATE = """subsystem: late
tasks:
  slow: {component: t_source, rate: 20 Hz, constants: {spend: 60 ms}}
"""


def vertices(path):
    """The corners of a path of M, H, V and h0, in order."""
    x = y = 0.0
    for letter, words in re.findall(r"([MHVh])([-\d. ]+)", path):
        if letter == "M":
            x, y = map(float, words.split())
        elif letter == "H":
            x = float(words)
        elif letter == "V":
            y = float(words)
        if letter in "MV":
            yield x, y


class TryTest(PageTest):
    def draft(self, text):
        """A page with a draft of this text, in its saved file."""
        self.file = self.place / "subject.yaml"
        self.file.write_text(text)
        self.page.open(self.web(self.file).link)
        self.page.await_root("draft", "1")
        return self.file

    def await_end(self):
        self.page.await_one("[data-try=ended]")

    def answers(self):
        """The results of trials that ended, in order."""
        self.read_logs()
        return [line["result"] for socket in self.frames.of("/bench") for line in socket.received
                if (line.get("result") or {}).get("ended")]

    def choose_variables(self, *names):
        for button in self.page.all(".names:first-of-type button.name"):
            button.click()
        field = self.page.one("#try-watch")
        for name in names:
            field.send_keys(name, Keys.ENTER)
            self.page.await_one(self.page.button(f"Take {name} away"))

    def test_one_key_tries_the_draft_and_the_curves_follow_the_table(self):
        self.draft(PLANT.read_text())
        self.page.press("t")
        self.await_end()
        [result] = self.answers()
        heading, *lines = result["csv"].splitlines()
        names = [name.split("(")[0] for name in heading.split(",")[1:]]
        drawn = "return [...document.querySelectorAll('[data-channel]')].map(e => e.dataset.channel)"
        self.assertEqual(sorted(self.page.script(drawn)), sorted(names))
        self.assertIn("speed", names)
        for number, name in enumerate(names):
            rows = [line.split(",") for line in lines]
            rows = [(float(row[0]), float(row[number + 1])) for row in rows if row[number + 1] not in ("", "nan")]
            drawn = list(vertices(self.page.attribute(f"path[data-channel='{name}']", "d")))
            self.assertEqual(len(drawn), len(rows), name)
            (t0, v0), (t1, v1), (x0, y0), (x1, y1) = min(rows), max(rows), drawn[0], drawn[-1]
            for (t, v), (x, y) in zip(rows, drawn):
                self.assertAlmostEqual(x, x0 + (x1 - x0) * (t - t0) / (t1 - t0), delta=0.2)
                if v1 != v0:
                    self.assertAlmostEqual(y, y0 + (y1 - y0) * (v - v0) / (v1 - v0), delta=0.2)
        self.assertEqual(self.page.attribute("[data-verdict-of-try]", "data-verdict-of-try"), "clean")

    def test_a_chosen_try_says_what_was_expected_and_switched(self):
        self.draft(PLANT.read_text())
        self.page.click(self.page.button("Try"))
        self.await_end()
        self.choose_variables("torque", "bias")
        self.page.one("#try-at").send_keys("1 s: switch rest", Keys.ENTER)
        self.page.one("#try-expect").send_keys("max |speed| <= 1 m/s", Keys.ENTER)
        self.page.await_one(self.page.button("Take max |speed| <= 1 m/s away"))
        self.page.click(self.page.button("Try the draft"))
        self.page.await_text("[data-verdict-of-try]", "FAILS: max |speed| <= 1 m/s")
        self.page.await_text("[data-verdict-of-try]", "rest: done in")
        result = self.answers()[-1]
        self.assertEqual(result["csv"].splitlines()[0], "t(s),torque(N.m),bias(m/s)")

    def test_the_curves_before_stay_pale_behind(self):
        self.draft(PLANT.read_text())
        self.page.press("t")
        self.await_end()
        self.page.await_none("path.pale")
        before = self.page.attribute("path[data-channel=torque]", "d")
        self.page.click(self.page.box("strong"))
        field = "input[data-field='strong constants/k']"
        self.page.type_over(field, "5 N.s", Keys.ENTER)
        self.page.await_root("draft", "2")
        self.page.await_text("[data-try]", "the draft has changed since")
        self.page.click(self.page.button("Try the draft"))
        self.page.await_one("path.pale[data-before=torque]")
        self.assertNotEqual(self.page.attribute("path[data-channel=torque]", "d"), before)

    def test_missed_deadlines_are_in_the_verdict(self):
        self.draft(LATE)
        self.page.press("t")
        self.page.await_text("[data-verdict-of-try='not clean']", "deadlines missed")
        self.assertRegex(self.page.text("table[aria-label='Missed deadlines']"), r"slow\d+")

    def test_what_would_be_opened_is_asked_about(self):
        log = self.place / "log.csv"
        self.draft(LOGGED % log)
        self.page.press("t")
        self.page.await_text(".question", f"log.file {log}")
        self.page.press(Keys.ESCAPE)
        self.page.await_none(".question")
        self.assertFalse(log.exists())
        self.page.press("t")
        self.page.click(".question .danger")
        self.await_end()
        self.assertTrue(log.exists())

    def test_a_try_that_never_ends_is_halted_by_a_button(self):
        armed = self.place / "armed"
        armed.touch()
        self.draft(ENDLESS % armed)
        self.page.press("t")
        await_that(lambda: armed.read_text(), "the cycle that does not end")
        self.page.click(self.page.button("Halt"))
        self.page.await_text("[data-try-why]", "halted")
        self.page.await_text("[data-try-message]", "stuck.cycle did not return")

    def test_a_draft_that_cannot_run_says_why(self):
        self.draft("subsystem: [\n")
        self.page.press("t")
        self.page.await_text("[data-try-message]", "no task of the draft produces a variable")

    def test_the_panel_has_names_contrast_and_cursors_by_keyboard(self):
        self.draft(PLANT.read_text())
        self.page.press("t")
        self.await_end()
        self.assertEqual(unnamed(self.browser), [])
        self.assertEqual(faint(self.browser), [])
        before = self.page.text("table[aria-label='Values at the cursors']")
        self.page.focus("input[aria-label='Cursor B']")
        self.page.press(*[Keys.ARROW_LEFT] * 5)
        self.page.await_other_text("table[aria-label='Values at the cursors']", before)
        self.page.click(self.page.button("Close"))
        self.page.await_none("[data-try]")


if __name__ == "__main__":
    sys.exit(main())
