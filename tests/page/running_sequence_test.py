# SPDX-License-Identifier: Apache-2.0
"""A sequence that runs, on the page: the panel Steps and the large view, over deaths of what runs and of the page."""
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

from access import faint, unnamed  # noqa: E402
from case import PageTest, main  # noqa: E402
from door import Door  # noqa: E402
from machine import Machine, PLANT, await_that  # noqa: E402
from page import Keys  # noqa: E402
from subject import Subject  # noqa: E402

LESSON = pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "examples" / "21_sequence" / "cell.yaml"
# Each condition waits for what a test sets.
STEPS = PLANT.read_text().replace("bias: 0.5 m/s", "bias: 0.5 m/s\n  sequence_go: 0") + """
sequence:
  rtpu: front
  steps:
    - {name: fill, switch: work, until: 'total >= 1000 m/s', within: 1 h}
    - {name: drain, switch: rest, until: 'total < 500 m/s', within: 1 h, else: park, confirm: true, reentry: true}
    - {name: hold, switch: work, for: 1 h}
    - {name: park, switch: rest}
"""
PAUSED, RUNS, WAITS, INTERRUPTED, DONE = 0, 2, 3, 4, 6
BUSY = ("miss", "blame", "demoted", "stale", "overrun")  # events of a busy CPU, which come at any time
# Notes each loss of the connection with what the page shows then.
NOTE_LOSSES = """
  const root = document.documentElement;
  window.losses = [];
  new MutationObserver(() => losses.push([root.dataset.door, document.querySelector('.large.stale') !== null]))
    .observe(root, {attributes: true, attributeFilter: ['data-door']});"""


class SequenceTest(PageTest):
    def look(self, text=STEPS, name="plant", place=""):
        self.machine = self.using(Machine(self.runtime, text, name))
        self.web_server = self.web()
        self.open(self.web_server.link, place)
        return self.machine

    def open(self, link, place=""):
        self.page.open(link + place)
        self.page.await_root("door", "open")
        if not place:
            self.page.await_open()
            self.page.click("#tab-steps")

    def await_step(self, number, phase, panel=True):
        """Until the page shows the present step in that state, and it is so."""
        if panel and number > 0:
            self.page.await_one(f"[data-step='{number}'][aria-current=step] [data-sequence-state='{phase}']")
        elif not panel:
            self.page.await_one(f"[data-present='{number}']")
        self.page.await_one(f"[data-sequence-state='{phase}']")
        self.machine.await_value("sequence_step", number)
        self.machine.await_value("sequence_state", phase)

    def press(self, label):
        self.page.click(self.page.button(label))

    def await_free(self, label):
        self.page.await_one(self.page.button(label) + ":not([aria-disabled])")

    def go(self, number):
        """Begins a step from outside of the page."""
        self.machine.call("set", values={"sequence_go": number})

    def kill_rtpu(self, name):
        before = self.machine.rtpu(name)
        self.assertTrue(self.machine.kill(before["pid"]))
        return before


class Panel(SequenceTest):
    def test_lesson_21_shows_its_steps_in_turn(self):
        """Steps of 2 s: a browser that stalls may miss one, but never shows one again."""
        self.look(LESSON.read_text() + "\noperator: {sequence_go: 0}\n", "cell")
        self.page.await_text("[data-sequence-state]", "paused")
        self.assertEqual(self.page.texts("[data-step] h3"), ["1. fetch_it", "2. weld_it", "3. carry_it", "4. home"])
        self.page.script("""
          window.steps = [];
          new MutationObserver(() => {
            const now = document.querySelector('[data-step][aria-current]')?.dataset.step;
            if (now && now !== steps[steps.length - 1]) steps.push(now); })
            .observe(document, {attributes: true, childList: true, subtree: true});""")
        self.press("Go")
        self.await_step(4, DONE)
        shown = self.page.script("return steps")
        self.assertEqual((shown, shown[-1]), (sorted(set(shown)), "4"))
        self.assertEqual([receipt["to"] for receipt in self.machine.call("receipts")["receipts"]],
                         ["weld_it", "carry_it", "home"])

    def test_a_step_shows_its_wait_and_the_value_it_waits_for(self):
        self.look()
        self.press("Go")
        self.await_step(1, RUNS)
        self.page.await_text("[aria-current=step] [data-waited]", "of at most 1 h")
        self.page.await_one("[aria-current=step] progress[aria-valuetext*='of at most 1 h']")
        self.page.await_text("[aria-current=step] .now", "total is")
        self.machine.call("set", values={"bias": "800 m/s"})
        self.page.await_that("/^8\\d\\d(\\.\\d+)? m\\/s$/.test("
                             "document.querySelector('[data-condition-value]').textContent)", "the value with its unit")

    def test_pause_go_and_begin_here_reach_the_sequence(self):
        self.look()
        self.press("Go")
        self.await_step(1, RUNS)
        self.assertEqual(self.page.attribute(self.page.button("Go"), "title"), "step 1 is under way")
        self.press("Pause")
        self.await_step(1, PAUSED)
        self.page.await_text("[data-note]", "sequence_go = 0")
        self.press("Begin step 3 hold")
        self.await_step(3, RUNS)
        self.press("Begin step 4 park")
        self.await_step(4, DONE)
        self.page.await_root("configuration", "rest")
        self.await_free("Go")
        self.press("Go")  # from the beginning
        self.await_step(1, RUNS)

    def test_a_step_with_confirm_waits_for_go(self):
        self.look()
        self.press("Go")
        self.await_step(1, RUNS)
        self.machine.call("set", values={"bias": "2000 m/s"})
        self.await_step(2, WAITS)
        self.page.await_root("configuration", "work")
        self.assertIn("waits for Go", self.page.text("[aria-current=step] .state-of"))
        self.await_free("Go")
        self.press("Go")
        self.await_step(2, RUNS)
        self.page.await_root("configuration", "rest")
        self.machine.call("set", values={"bias": "0 m/s"})
        self.await_step(3, RUNS)

    def test_after_the_flag_only_a_step_with_reentry_goes_on_by_itself(self):
        self.look(STEPS.replace("confirm: true, ", ""))
        self.press("Go")
        for step, after in ((1, PAUSED), (2, RUNS)):
            if step == 2:
                self.machine.call("set", values={"bias": "2000 m/s"})
                self.press("Begin step 2 drain")
            self.await_step(step, RUNS)
            self.press("Raise the FLAG")
            self.await_step(step, INTERRUPTED)
            self.assertIn("interrupted: may go on with step 2", self.page.text("[aria-current=step] .state-of"))
            self.press("Lower the FLAG")
            self.await_step(step, after)
            self.page.await_text("[data-note]", "interrupted in 'work': paused; may go on with step 2" if step == 1
                                 else "goes on with step 2 'drain'")

    def test_values_age_while_the_task_is_off_and_a_step_begins_after_that(self):
        self.look()
        self.press("Go")
        self.await_step(1, RUNS)
        self.machine.signal("off", "sequence")
        self.page.await_text(".state-of", "task sequence is OFF")
        self.page.await_one(".state-of.old")
        self.page.await_other_text(".state-of", self.page.text(".state-of"))
        self.machine.signal("on", "sequence")
        self.page.await_none(".state-of.old")
        self.press("Begin step 3 hold")
        self.await_step(3, RUNS)

    def test_the_end_of_the_page_changes_nothing_that_runs(self):
        self.look()
        self.press("Go")
        self.await_step(1, RUNS)
        before = self.acts()
        self.browser.close_tabs()
        self.browser.new_tab()
        self.machine.await_cycles("sequence")
        self.assertEqual(self.acts(), before)
        self.open(self.web_server.link)
        self.await_step(1, RUNS)
        self.assertEqual(self.acts(), before)

    def acts(self):
        return [event for event in self.machine.events() if event["kind"] not in BUSY]

    def test_a_person_who_may_only_observe_reads_why_nothing_can_be_pressed(self):
        door = Door(self.runtime, Subject.steps())
        door.subject.role = "observe"
        self.look_at(door)
        self.page.click("#tab-steps")
        self.page.await_one("[data-step='2'][aria-current=step]")
        for label in ("Go", "Pause", "Begin step 1 near"):
            button = self.page.one(self.page.button(label))
            self.assertEqual(button.get_attribute("aria-disabled"), "true", label)
            self.assertIn("needs the role 'operate'", button.get_attribute("title"))
            button.click()
        self.assertIn("your role here is 'observe'", self.page.text("#panel .acts"))
        door.subject.role = "operate"
        door.cut()
        self.expected = ["WebSocket"]
        self.await_free("Begin step 1 near")
        self.press("Begin step 1 near")
        door.await_asked("set")
        self.assertEqual(door.asked("set"), [{"values": {"sequence_go": 1}}])


class LargeView(SequenceTest):
    def test_a_press_leads_there_and_back(self):
        self.look()
        self.page.script("[...document.querySelectorAll('#panel a')].find(e => e.textContent === 'Large view').click()")
        self.page.await_root("place", "steps")
        self.assertTrue(self.page.script("return location.href").endswith("&doc=steps"))
        self.page.await_text("[data-sequence-state]", "paused")
        self.press("Back to the page")
        self.page.await_root("place", "")
        self.page.await_one("ol.steps")

    def test_it_shows_the_present_step_and_is_used_by_keyboard_alone(self):
        self.look(place="&doc=steps")
        self.page.tab_to(self.page.button("Go"))
        self.page.press(Keys.ENTER)
        self.await_step(1, RUNS, panel=False)
        self.assertEqual(self.page.text("h1"), "fill")
        self.assertEqual(self.page.text("[data-until]"), "until total >= 1000 m/s")
        self.page.await_text("[data-waited]", "of at most 1 h")
        self.page.await_text("[data-next]", "2. drain, which waits for Go")
        self.assertEqual(self.page.text("[data-else]"), "stop")
        self.page.tab_to(self.page.button("Pause"))
        self.page.press(Keys.SPACE)
        self.await_step(1, PAUSED, panel=False)
        self.go(4)
        self.await_step(4, DONE, panel=False)
        self.assertEqual(self.page.text("[data-next]"), "stays")
        self.page.tab_to(self.page.button("Raise the FLAG"))
        self.page.press(Keys.ENTER)
        self.page.await_root("flag", "up")
        self.page.press(Keys.ESCAPE)
        self.page.await_root("place", "")

    def test_the_death_of_the_manager_is_said_and_the_page_is_back_by_itself(self):
        self.look(place="&doc=steps")
        self.press("Go")
        self.await_step(1, RUNS, panel=False)
        self.expected = ["WebSocket"]
        before = self.machine.call("hello")["manager"]
        self.page.script(NOTE_LOSSES)
        self.machine.disconnect()
        self.assertTrue(self.machine.kill(before["pid"]))
        self.page.await_root("manager", str(before["starts"] + 1))
        self.page.await_that("losses.some(([door, isStale]) => door === 'lost' && isStale)", "the loss")
        self.page.await_none(".large.stale")
        self.await_step(1, RUNS, panel=False)
        self.machine.call("set", values={"bias": "2000 m/s"})
        self.await_step(2, WAITS, panel=False)

    def test_the_death_of_a_process_is_said_and_what_stopped_the_sequence(self):
        self.look(place="&doc=steps")
        self.press("Go")
        self.await_step(1, RUNS, panel=False)
        self.machine.await_restart("back", self.kill_rtpu("back"))
        self.await_step(1, PAUSED, panel=False)
        self.page.await_text("[data-note]", "paused; may go on with step 2")
        self.await_free("Go")
        self.press("Go")
        self.await_step(1, RUNS, panel=False)

    def test_values_of_a_process_that_is_given_up_are_grey(self):
        self.look(place="&doc=steps")
        self.press("Go")
        self.await_step(1, RUNS, panel=False)
        for _ in range(4):
            before = self.kill_rtpu("front")
            await_that(lambda: (now := self.machine.rtpu("front"))["given_up"]
                       or now["alive"] and now["incarnation"] > before["incarnation"], "the next incarnation")
        self.page.await_text(".banner.error", "It is not started again")
        self.page.await_text(".state-of.old", "its rtpu front has ended, ")
        self.page.await_one("h1.old")
        self.assertEqual(self.page.attribute(self.page.button("Go"), "title"), "its rtpu front has ended")

    def test_the_death_of_chimera_web_is_said_and_a_new_link_shows_the_same(self):
        self.look(place="&doc=steps")
        self.press("Go")
        self.await_step(1, RUNS, panel=False)
        self.expected = ["WebSocket", "ERR_CONNECTION_REFUSED"]
        old = self.web_server
        old.die()
        self.page.await_root("bench", "lost")
        self.page.await_text(".banner.lost", "What runs goes on")
        self.page.await_one(".large.stale")
        new = self.web(port=old.port)
        self.page.await_root("bench", "refused")
        self.page.open(new.origin() + "/#&doc=steps")  # a link without its key, as it is kept
        self.page.await_root("bench", "refused")
        self.page.open(new.link)
        self.page.await_root("place", "steps")
        self.await_step(1, RUNS, panel=False)

    def test_a_subsystem_without_a_sequence_says_so(self):
        self.using(Door(self.runtime))
        self.page.open(self.web().link + "&doc=steps")
        self.page.await_text("main", "plant has no sequence.")


class Access(SequenceTest):
    """Without a mouse, with little sight, on a screen of half the size."""

    def setUp(self):
        super().setUp()
        self.addCleanup(self.browser.command, "Emulation.clearDeviceMetricsOverride")
        self.addCleanup(self.browser.command, "Emulation.setEmulatedMedia", features=[])

    def views(self):
        """The panel and the large view, running, interrupted and lost."""
        door = self.using(Door(self.runtime, Subject.steps()))
        self.page.open(self.web().link)
        self.page.await_open()
        self.page.click("#tab-steps")
        self.page.await_one("[data-step='2'][aria-current=step] progress")
        yield "panel"
        self.page.script("[...document.querySelectorAll('#panel a')].find(e => e.textContent === 'Large view').click()")
        self.page.await_one(".large progress")
        yield "large view"
        with door.change() as subject:
            subject.values["sequence_state"], subject.flag_by = INTERRUPTED, ["operator"]
        self.page.await_text(".large .state-of", "may go on with step 2")
        yield "interrupted"
        self.expected = ["WebSocket"]
        door.die()
        self.page.await_one(".large.stale")
        yield "lost"

    def test_each_text_has_contrast_and_each_control_a_name(self):
        for scheme in ("light", "dark"):
            self.browser.command("Emulation.setEmulatedMedia", features=[
                {"name": "prefers-color-scheme", "value": scheme},
                {"name": "prefers-reduced-motion", "value": "reduce"}])
            for view in self.views():
                self.assertEqual((faint(self.browser), unnamed(self.browser)), ([], []), f"{view}, {scheme}")

    def test_go_pause_and_flag_are_in_sight_at_twice_the_size(self):
        self.browser.command("Emulation.setDeviceMetricsOverride", width=640, height=400, deviceScaleFactor=2,
                             mobile=False)
        for view in self.views():
            self.assertLessEqual(self.page.script("return document.documentElement.scrollWidth"), 640, view)
            for label in ("Go", "Pause", "Raise the FLAG") if view != "panel" else ():
                place = self.page.script("const place = arguments[0].getBoundingClientRect();"
                                         "return [place.left, place.right, place.top, place.bottom];",
                                         self.page.one(self.page.button(label)))
                self.assertGreaterEqual(min(place), 0, (view, label))
                self.assertLessEqual(place[1], 640, (view, label))
                self.assertLessEqual(place[3], 400, (view, label))


if __name__ == "__main__":
    sys.exit(main())
