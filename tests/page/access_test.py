# SPDX-License-Identifier: Apache-2.0
"""The page without a mouse, with a screen reader, with little sight, on a small screen."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

import access  # noqa: E402
from case import PageTest, main  # noqa: E402
from door import Door  # noqa: E402
from page import Keys  # noqa: E402
from subject import Subject  # noqa: E402


class AccessTest(PageTest):
    def setUp(self):
        super().setUp()
        self.addCleanup(self.browser.command, "Emulation.clearDeviceMetricsOverride")
        self.addCleanup(self.media)

    def look(self, subject=None):
        self.door = self.look_at(Door(self.runtime, subject))
        return self.door

    def media(self, **features):
        """Emulates wishes of a person, as prefers_color_scheme="dark"; none: those of the system."""
        self.browser.command("Emulation.setEmulatedMedia", features=[
            {"name": name.replace("_", "-"), "value": value} for name, value in features.items()])

    def screen(self, width, height, scale):
        self.browser.command("Emulation.setDeviceMetricsOverride", width=width, height=height,
                             deviceScaleFactor=scale, mobile=False)

    @staticmethod
    def troubled():
        """A subject that shows each state, a flag, a fault and a banner."""
        subject = Subject.chain(length=4)
        subject.to("task1", "OFF")
        subject.to("task2", "ERROR", "the sensor does not answer")
        subject.to("task3", "NOT-CREATED")
        subject.flag_by = ["operator", "servo"]
        return subject

    def views(self):
        """The page in each of its views: panels, menus, questions, old values."""
        self.page.choose("task0", "task2")
        for tab in ("why", "receipts", "profile", "events"):
            self.page.click(f"#tab-{tab}")
            if tab == "why":
                self.page.await_one("[data-why]")
            yield tab
        for label, opened in (("Switch configuration", "[data-plan]"), ("More acts", ".sheet"), ("Help", ".help"),
                              ("Find", ".finder")):
            self.page.click(self.page.button(label))
            self.page.await_one(opened)
            yield label
            self.page.press(Keys.ESCAPE)
            self.page.await_none(opened)
        self.page.press("k")
        self.page.await_one(".question")
        yield "question"
        self.page.press(Keys.ESCAPE)
        self.door.refuse("signal", -32000, "v0 would have no producer", {
            "kind": "set", "where": "task2", "remedy": "the smallest legal set is: task0 task2",
            "tasks": ["task0", "task2"]})
        self.page.press("o")
        self.page.await_one(".message.error")
        yield "refusal"
        self.expected = ["WebSocket"]
        self.door.die()
        self.page.await_one("main.stale")
        yield "loss"

    # ---- sight

    def test_each_text_has_contrast_in_light(self):
        self.contrast("light")

    def test_each_text_has_contrast_in_dark(self):
        self.contrast("dark")

    def contrast(self, scheme):
        self.media(prefers_color_scheme=scheme, prefers_reduced_motion="reduce")
        self.look(self.troubled())
        for view in self.views():
            self.assertEqual(access.faint(self.browser), [], view)

    def test_dark_is_dark(self):
        self.media(prefers_color_scheme="dark")
        self.look()
        self.assertLess(self.page.script("return getComputedStyle(document.body).backgroundColor.match(/\\d+/g)"
                                         ".reduce((sum, part) => sum + Number(part), 0)"), 200)

    def test_the_flag_is_in_sight_at_twice_the_size(self):
        self.small(700, 450, 2)

    def test_the_flag_is_in_sight_on_a_small_screen(self):
        self.small(320, 640, 2)

    def small(self, width, height, scale):
        self.screen(width, height, scale)
        self.look(self.troubled())
        flag = self.page.script("const place = arguments[0].getBoundingClientRect();"
                                "return [place.left, place.right, place.top, place.bottom];",
                                self.page.one(self.page.button("Raise the FLAG")))
        self.assertGreaterEqual(min(flag), 0)
        self.assertLessEqual(flag[1], width)
        self.assertLessEqual(flag[3], height)
        self.assertLessEqual(self.page.script("return document.documentElement.scrollWidth"), width)
        self.page.choose("task0")
        self.page.script("arguments[0].scrollIntoView()", self.page.one("#panel"))
        self.page.click(self.page.button("Raise the FLAG"))
        self.door.await_asked("flag")

    def test_nothing_moves_for_a_person_who_wants_no_motion(self):
        self.media(prefers_reduced_motion="reduce")
        self.look(self.troubled())
        self.page.choose("task0")
        moving = self.page.script(
            "return [...document.querySelectorAll('*')].filter((e) => { const s = getComputedStyle(e);"
            "return s.animationName !== 'none' || s.transitionDuration.split(',').some((d) => parseFloat(d) > 0); })"
            ".map((e) => e.outerHTML.slice(0, 80))")
        self.assertEqual(moving, [])

    # ---- screen readers

    def test_each_control_has_a_name(self):
        self.look(self.troubled())
        for view in self.views():
            self.assertEqual(access.unnamed(self.browser), [], view)

    def test_trouble_is_announced(self):
        self.look()
        with self.door.change() as subject:
            subject.to("task1", "ERROR", "the sensor does not answer")
        self.page.await_text("[role=status]", "the sensor does not answer")
        self.door.refuse("signal", -32000, "not now", {"kind": "state", "where": "task0"})
        self.page.choose("task0")
        self.page.press("f")
        self.page.await_text("[role=alert]", "not now")

    def test_a_box_says_its_state(self):
        self.look(self.troubled())
        for task, state in self.page.states().items():
            self.assertIn(state, self.page.attribute(self.page.box(task), "aria-label"))
        self.assertEqual(self.page.script("return document.documentElement.lang"), "en")
        self.assertIn("plant", self.page.script("return document.title"))

    # ---- keyboard

    def test_a_task_is_turned_off_by_keys_alone(self):
        self.look()
        self.page.tab_to("g.box")
        self.page.press(Keys.ARROW_RIGHT)
        self.page.await_one(f"{self.page.box('task1')}.chosen")
        self.page.press("f")
        self.page.await_state("task1", "OFF")
        self.page.press(Keys.ARROW_RIGHT, Keys.SPACE, "f")
        self.page.await_state("task2", "OFF")
        self.assertEqual([p["tasks"] for p in self.door.asked("signal")], [["task1"], ["task2"]])

    def test_each_button_is_reached_by_keys_and_shows_it(self):
        self.look(self.troubled())
        self.page.choose("task0")
        self.page.script("document.activeElement.blur()")
        wanted = ("select[aria-label=Subsystem]", self.page.button("Switch configuration"),
                  self.page.button("More acts"), self.page.button("Raise the FLAG"), "g.box", "#set-wish",
                  "input[aria-label='wish, slider']", self.page.button("off task0"), "#tab-events",
                  "input[aria-label='Filter of events']")
        for selector in wanted:
            self.page.tab_to(selector)
            shown = self.page.script(
                "const e = document.activeElement, look = getComputedStyle(e.querySelector('.frame') ?? e);"
                "return parseFloat(e.matches('g') ? look.strokeWidth : look.outlineWidth);")
            self.assertGreater(shown, 2, selector)

    def test_tabs_are_chosen_by_arrows(self):
        self.look()
        self.page.focus("#tab-events")
        for name in ("receipts", "profile", "why", "scope", "timeline", "events"):
            self.page.press(Keys.ARROW_RIGHT)
            self.page.await_one(f"#tab-{name}[aria-selected=true]")
        self.assertEqual(self.page.script("return document.activeElement.id"), "tab-events")

    def test_the_focus_returns_after_a_question(self):
        self.look()
        self.page.tab_to("g.box")
        self.page.press(Keys.SPACE, "k")
        self.page.await_one(".question")
        self.page.press(Keys.ESCAPE)
        self.page.await_none(".question")
        self.assertEqual(self.page.script("return document.activeElement.dataset.task"), "task0")


if __name__ == "__main__":
    sys.exit(main())
