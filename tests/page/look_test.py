# SPDX-License-Identifier: Apache-2.0
"""What the page shows of a subsystem: the picture, states, values, events, and what it says when nothing runs. Behind
it is a server whose state each test sets."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

from case import PageTest, main  # noqa: E402
from door import Door  # noqa: E402
from page import Keys  # noqa: E402
from subject import Subject, port  # noqa: E402

MARKUP = "<img src=x onerror=alert(1)>"
# All that is drawn, as the answer to `describe` has it.
DRAWN = """
const number = (element, names) => names.map((name) => Number(element.getAttribute(name)));
const all = (selector, take) => [...document.querySelectorAll('svg.picture ' + selector)].map(take);
return {
  size: document.querySelector('svg.picture').getAttribute('viewBox'),
  boxes: all('g.box', (e) => [e.dataset.task, ...number(e.querySelector('rect.frame'), ['x', 'y', 'width', 'height'])]),
  lines: all('.drawing line', (e) => [e.dataset.variable, ...number(e, ['x1', 'y1', 'x2', 'y2'])]),
  labels: all('.labels text', (e) => [e.textContent, e.getAttribute('text-anchor'), ...number(e, ['x', 'y'])])};
"""


class LookTest(PageTest):
    def test_the_picture_is_drawn_as_the_subsystem_describes_it(self):
        door = self.look_at(Door(self.runtime))
        picture, drawn = door.subject.picture(), self.page.script(DRAWN)
        self.assertEqual(drawn["size"], f"0 0 {picture['width']} {picture['height']}")
        self.assertEqual(drawn["boxes"], [[b[key] for key in ("task", "x", "y", "width", "height")]
                                          for b in picture["boxes"]])
        self.assertEqual(drawn["lines"], [[line[key] for key in ("variable", "x1", "y1", "x2", "y2")]
                                          for line in picture["lines"]])
        self.assertEqual(drawn["labels"], [[label[key] for key in ("text", "anchor", "x", "y")]
                                           for label in picture["labels"] if label["style"] != "title"])

    def test_states_are_a_word_an_outline_and_change(self):
        door = self.look_at(Door(self.runtime))
        looks = {}
        for state in ("ON", "OFF", "ERROR", "NOT-CREATED"):
            with door.change() as subject:
                subject.to("task1", state)
            self.page.await_state("task1", state)
            self.assertEqual(self.page.text(f"{self.page.box('task1')} text.state"), state)
            looks[state] = self.page.script(
                "const frame = arguments[0].querySelector('.frame'), look = getComputedStyle(frame);"
                "return [look.strokeWidth, look.strokeDasharray, arguments[0].querySelectorAll('rect').length].join();",
                self.page.one(self.page.box("task1")))
        self.assertEqual(len(set(looks.values())), 4, looks)
        self.assertEqual(self.page.states(), {"task0": "ON", "task1": "NOT-CREATED", "task2": "ON"})

    def test_a_fault_is_said_with_its_task_and_words(self):
        door = self.look_at(Door(self.runtime))
        with door.change() as subject:
            subject.to("task1", "ERROR", "the sensor does not answer")
        self.page.await_text(".banner.error", "task1 (the sensor does not answer)")
        self.assertEqual(self.page.text("[data-state-word]"), "IN ERROR")
        with door.change() as subject:
            subject.to("task1", "OFF")
        self.page.await_none(".banner.error")

    def test_values_are_shown_with_age_and_change(self):
        door = self.look_at(Door(self.runtime))
        self.page.await_text("text.value[data-value=v1]", "1 ")
        with door.change() as subject:
            subject.values["v1"] = -0.4123
        self.page.await_text("text.value[data-value=v1]", "-0.412 ")
        self.assertRegex(self.page.text("text.value[data-value=v1]"), r"^-0\.412 \d+(\.\d)?(ns|us|ms|s)$")

    def test_a_chosen_task_shows_its_inputs_and_its_sentence(self):
        subject = Subject.chain()
        subject.values["v0"] = 0.5
        self.look_at(Door(self.runtime, subject))
        self.page.choose("task1")
        self.page.await_text("[data-live=v0]", "0.5")
        self.page.await_text("article[aria-label='Task task1'] .doc", "Adds one.")

    def test_a_value_whose_producer_is_off_is_grey(self):
        door = self.look_at(Door(self.runtime))
        self.page.await_one("text.value[data-value=v1]:not(.old)")
        with door.change() as subject:
            subject.to("task1", "OFF")
        self.page.await_one("text.value[data-value=v1].old")
        self.page.await_one("text.value[data-value=v0]:not(.old)")

    def test_a_variable_that_was_never_written_says_so(self):
        subject = Subject.chain()
        subject.values["v2"] = None
        self.look_at(Door(self.runtime, subject))
        self.page.await_text("text.value[data-value=v2]", "never")

    def test_a_dead_process_is_said_and_its_values_are_grey_until_it_is_back(self):
        subject = Subject.chain()
        subject.rtpus["beside"] = True
        subject.tasks["task2"]["rtpu"] = "beside"
        door = self.look_at(Door(self.runtime, subject))
        with door.change():
            subject.rtpus["beside"] = False
            subject.to("task2", "ERROR", "its process has ended")
        self.page.await_text(".banner.error", "rtpu beside has ended: was killed by SIGKILL")
        self.page.await_one(f"{self.page.box('task2')}.dead")
        self.page.await_one("text.value[data-value=v2].old")
        self.page.await_one("text.value[data-value=v1]:not(.old)")
        self.page.await_text(".cpu[data-cpu='1']", "beside has ended")
        with door.change():
            subject.rtpus["beside"] = True
            subject.to("task2", "ON")
        self.page.await_none(".banner")
        self.page.await_none("g.box.dead")
        self.page.await_one("text.value[data-value=v2]:not(.old)")

    def test_a_manager_that_does_not_answer_is_said_until_it_does(self):
        door = self.look_at(Door(self.runtime))
        door.stall()
        door.cut()
        self.page.await_text(".banner.lost", "The manager of plant does not answer")
        self.page.await_text("[data-state-word]", "NO CONNECTION")
        self.page.await_one("main.stale")
        door.resume()
        self.page.await_none(".banner")
        self.page.await_none("main.stale")
        self.page.await_text("[data-state-word]", "RUNNING")

    def test_a_manager_that_falls_silent_is_said_until_it_speaks(self):
        door = self.look_at(Door(self.runtime))
        door.stall()
        self.page.await_text(".banner.lost", "The manager of plant has said nothing")
        self.page.await_text("[data-state-word]", "NO CONNECTION")
        self.page.await_one("main.stale")
        door.resume()
        self.page.await_none(".banner")
        self.page.await_text("[data-state-word]", "RUNNING")

    def test_events_that_are_lost_are_counted(self):
        door = self.look_at(Door(self.runtime))
        with door.change() as subject:
            subject.event("note", "the first")
        self.page.await_root("events", "1")
        with door.change() as subject:
            subject.event("note", "the second")
            subject.lost = 7
        self.page.await_root("gaps", "7")
        self.page.await_text("#panel", "7 events are lost")

    def test_a_flag_of_another_is_shown_with_its_origin(self):
        door = self.look_at(Door(self.runtime))
        with door.change() as subject:
            subject.flag_by = ["servo"]
        self.page.await_text("[data-flag-by]", "servo")
        self.page.await_root("flag", "up")
        self.assertEqual(self.page.all(self.page.button("Lower the FLAG")), [])

    def test_the_last_event_comes_first_and_the_filter_finds_words(self):
        door = self.look_at(Door(self.runtime))
        with door.change() as subject:
            for number in range(1500):
                subject.event("note", f"remark {number}")
        self.page.await_root("events", "1500")
        self.assertIn("remark 1499", self.page.text("[data-event]"))
        self.page.one("input[aria-label='Filter of events']").send_keys("remark 77")
        self.page.await_that("document.querySelectorAll('[data-event]').length === 11", "eleven events")
        self.assertEqual(self.page.root("gaps"), "0")

    def test_text_of_a_component_is_never_markup(self):
        subject = Subject.chain(doc=MARKUP)
        subject.add(MARKUP, MARKUP, [port("x", "in-var", "v0"), port(MARKUP, "out-var", MARKUP)])
        subject.values[MARKUP] = 1.0
        subject.configurations[MARKUP] = [MARKUP]
        subject.event("note", MARKUP, task=MARKUP)
        door = self.look_at(Door(self.runtime, subject))
        self.page.choose(MARKUP)
        self.page.await_text("article p.doc", MARKUP)
        with door.change():
            subject.to(MARKUP, "ERROR", MARKUP)
        self.page.await_text(".banner.error", MARKUP)
        for tab in ("receipts", "profile", "why", "events"):
            self.page.click(f"#tab-{tab}")
        self.page.await_text("[data-event]", MARKUP)
        self.page.click(self.page.button("Switch configuration"))
        self.page.await_text("[data-plan]", "stay")
        self.assertEqual(self.page.all("img, script:not([src]), [onerror]"), [])
        self.assertIn(MARKUP, self.page.texts("g.labels text"))

    def test_a_hundred_tasks_are_drawn_and_live(self):
        door = self.look_at(Door(self.runtime, Subject.chain(length=100)))
        self.assertEqual(len(self.page.all("g.box")), 100)
        self.assertEqual(len(self.page.all("text.value")), 101 if self.page.all("text.given") else 100)
        with door.change() as subject:
            subject.values.update({f"v{number}": number + 0.5 for number in range(100)})
        self.page.await_text("text.value[data-value=v99]", "99.5")
        with door.change() as subject:
            subject.to("task99", "OFF")
        self.page.await_state("task99", "OFF")

    def test_anything_is_found_by_its_name(self):
        self.look_at(Door(self.runtime, Subject.chain(length=30)))
        self.page.press_with(Keys.CONTROL, "k")
        self.page.await_one(".finder input")
        self.page.press("task27", Keys.ENTER)
        self.page.await_one(f"{self.page.box('task27')}.chosen")
        self.page.press_with(Keys.CONTROL, "k")
        self.page.await_one(".finder input")
        self.page.press("v12", Keys.ENTER)
        self.page.await_one("[data-why=v12]")

    def test_why_names_the_producer(self):
        door = self.look_at(Door(self.runtime))
        with door.change() as subject:
            subject.to("task1", "ERROR", "broken")
        self.page.choose("task1")
        self.page.press("w")
        self.page.await_text("[data-why=v1]", "producer-error")
        self.page.await_one("[data-verdict=producer-error]")


class Which(PageTest):
    """Which subsystem the page shows."""

    def test_it_says_that_nothing_runs_and_shows_what_begins(self):
        server = self.web()
        self.page.open(server.link)
        self.page.await_text("main", "chimera run")
        self.assertEqual(self.page.root("machines"), "0")
        self.using(Door(self.runtime))
        self.page.await_open()
        self.assertEqual(self.page.root("machine"), "plant")

    def test_each_of_two_subsystems_can_be_chosen(self):
        self.using(Door(self.runtime, Subject.chain("second", length=5)))
        self.look_at(Door(self.runtime, Subject.chain("first", length=2)))
        self.page.await_root("machines", "2")
        shown = self.page.root("machine")
        other = {"first": "second", "second": "first"}[shown]
        self.page.one("select[aria-label=Subsystem]").send_keys(other)
        self.page.await_root("machine", other)
        self.page.await_that("document.querySelectorAll('g.box').length === "
                             f"{5 if other == 'second' else 2}", "the other picture")

    def test_a_link_may_name_the_subsystem(self):
        self.using(Door(self.runtime, Subject.chain("alpha")))
        self.look_at(Door(self.runtime, Subject.chain("omega")), "omega")
        self.assertEqual(self.page.root("machine"), "omega")

    def test_the_file_of_the_command_chooses_the_subsystem(self):
        self.using(Door(self.runtime, Subject.chain("alpha")))
        self.look_at(Door(self.runtime, Subject.chain("omega")), arguments=("/machines/omega.yaml",))
        self.assertEqual(self.page.root("machine"), "omega")

    def test_the_file_of_a_new_link_wins_over_the_subsystem_before_and_may_start_later(self):
        self.look_at(Door(self.runtime, Subject.chain("alpha")))
        self.assertEqual(self.page.root("machine"), "alpha")
        self.expected = ["WebSocket", "ERR_CONNECTION_REFUSED"]
        self.web_server.die()
        self.page.await_root("bench", "lost")
        new = self.web("/machines/omega.yaml", port=self.web_server.port)
        self.page.open(new.link)
        self.page.await_text("h1", "Nothing runs /machines/omega.yaml")
        self.using(Door(self.runtime, Subject.chain("omega")))
        self.page.await_root("machine", "omega")
        self.page.await_open()

    def test_a_subsystem_that_has_ended_stays_said_while_the_page_tries_again(self):
        door = self.look_at(Door(self.runtime))
        self.expected = ["WebSocket"]
        door.die()
        self.page.await_root("door", "gone")
        self.page.script("""
            const root = document.documentElement, Real = WebSocket;
            window.seen = [];
            window.WebSocket = class extends Real {
              constructor(...of) { super(...of); root.dataset.tries = Number(root.dataset.tries ?? 0) + 1; } };
            new MutationObserver(() => seen.push(root.dataset.door))
              .observe(root, {attributes: true, attributeFilter: ['data-door']});""")
        self.page.await_that("Number(document.documentElement.dataset.tries) >= 4", "four tries to connect")
        self.assertEqual(self.page.script("return seen"), [])
        self.page.await_text(".banner.lost", "plant has ended")
        door.listen()
        self.page.await_root("door", "open")
        self.page.await_none(".banner")

    def test_an_old_link_is_refused_with_the_remedy(self):
        server = self.web()
        self.page.open(server.link[:-43] + 43 * "A")
        self.page.await_root("bench", "refused")
        self.assertIn("`chimera web`", self.page.text(".banner.error"))

    def test_a_page_that_is_loaded_again_goes_on_where_it_was(self):
        self.look_at(Door(self.runtime))
        self.page.choose("task1", "task2")
        self.page.click("#tab-profile")
        self.browser.driver.refresh()
        self.page.await_open()
        self.page.await_that("document.querySelectorAll('g.box.chosen').length === 2", "the chosen tasks")
        self.assertEqual(self.page.attribute("#tab-profile", "aria-selected"), "true")

    def test_a_newer_subsystem_with_more_keys_is_shown(self):
        self.is_newer = True
        subject = Newer.chain()
        door = self.look_at(Door(self.runtime, subject))
        with door.change():
            subject.event("an-event-of-tomorrow", "something new")
            subject.to("task1", "OFF")
        self.page.await_state("task1", "OFF")
        self.page.await_text("[data-event]", "something new")


class Newer(Subject):
    """Answers with keys, kinds and numbers that this page does not know."""

    @staticmethod
    def chain(*arguments, **more):
        made = Subject.chain(*arguments, **more)
        made.__class__ = Newer
        return made

    def hello(self):
        return {**super().hello(), "program": "9.9.9", "protocol": 1, "colour": "green"}

    def status(self):
        return {**super().status(), "weather": {"wind": [1, 2]}}

    def describe(self, picture=False):
        return {**super().describe(picture), "notes": []}

    def reading(self, name):
        return {**super().reading(name), "short": "0"}


if __name__ == "__main__":
    sys.exit(main())
