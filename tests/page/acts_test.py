# SPDX-License-Identifier: Apache-2.0
"""What a person does on the page, and what it then asks of the subsystem: each act once, with the question before it
and the answer after it. Behind it is a server whose answers each test sets."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

from case import PageTest, main  # noqa: E402
from door import Door  # noqa: E402
from page import Keys  # noqa: E402
from subject import Subject  # noqa: E402


class ActsTest(PageTest):
    def look(self, subject=None):
        self.door = self.look_at(Door(self.runtime, subject))
        return self.door

    def await_message(self, words):
        self.page.await_text("[data-message]", words)

    def test_buttons_send_each_signal_once(self):
        self.look()
        self.page.choose("task1")
        for act, state in (("off", "OFF"), ("on", "ON"), ("off", "OFF"), ("kill", "NOT-CREATED"), ("spawn", "OFF")):
            self.page.click(self.page.button(f"{act} task1"))
            self.page.await_state("task1", state)
            self.await_message(state)
        self.assertEqual([(p["signal"], p["tasks"]) for p in self.door.asked("signal")],
                         [(act, ["task1"]) for act in ("off", "on", "off", "kill", "spawn")])

    def test_keys_act_on_the_chosen_tasks(self):
        self.look()
        self.page.choose("task0", "task2")
        self.page.press("f")
        self.page.await_state("task0", "OFF")
        self.page.await_state("task2", "OFF")
        self.page.press("o")
        self.page.await_state("task0", "ON")
        self.assertEqual([p["tasks"] for p in self.door.asked("signal")], [["task0", "task2"]] * 2)

    def test_a_key_in_a_field_is_no_act(self):
        self.look()
        self.page.choose("task0")
        self.page.click("#set-wish")
        self.page.press("f", "o", "k")
        self.assertEqual(self.page.attribute("#set-wish", "value"), "1fok")
        self.assertEqual(self.door.asked("signal"), [])

    def test_a_refused_on_offers_the_smallest_legal_set(self):
        subject = Subject.chain()
        subject.to("task0", "OFF")
        subject.to("task1", "OFF")
        self.look(subject)
        self.door.refuse("signal", -32000, "v0 would have no producer",
                         {"kind": "set", "where": "task1", "remedy": "the smallest legal set is: task0 task1",
                          "tasks": ["task0", "task1"]})
        self.page.choose("task1")
        self.page.press("o")
        self.await_message("v0 would have no producer")
        self.page.await_text(".message.error", "the smallest legal set is")
        self.door.refuse("signal", 0, None)
        self.page.click(self.page.button("Turn ON together: task0, task1"))
        self.page.await_state("task0", "ON")
        self.page.await_state("task1", "ON")
        self.assertEqual(self.door.asked("signal")[-1], {"signal": "on", "tasks": ["task0", "task1"]})

    def test_a_kill_of_a_task_that_is_on_asks_first(self):
        self.look()
        self.page.choose("task1")
        self.page.press("k")
        self.page.await_text(".question", "task1")
        self.assertEqual(self.page.script("return document.activeElement.textContent"), "Cancel")
        self.page.press(Keys.ENTER)
        self.page.await_none(".question")
        self.page.press("k")
        self.page.await_one(".question")
        self.page.press(Keys.ESCAPE)
        self.page.await_none(".question")
        self.assertEqual(self.door.asked("signal"), [])
        self.page.press("k")
        self.page.click(".question .danger")
        self.page.await_state("task1", "NOT-CREATED")
        self.assertEqual(len(self.door.asked("signal")), 1)

    def test_the_end_of_a_subsystem_asks_first(self):
        self.asks_first("End the subsystem", "end", "Every task goes OFF")

    def test_a_drill_asks_first(self):
        self.asks_first("Drill", "drill", "the machine stops")

    def asks_first(self, label, method, words):
        self.look()
        self.door.refuse(method, -32000, "not now", {"kind": "flag-up", "where": "plant"})
        for press in (".question button", ".question .danger"):
            self.page.click(self.page.button("More acts"))
            self.page.click(self.page.button(label))
            self.page.await_text(".question", words)
            self.assertEqual(self.door.asked(method), [])
            self.page.click(press)
        self.await_message("not now")
        self.assertEqual(self.door.asked(method), [{}])

    def test_a_slow_switch_asks_first(self):
        subject = Subject.chain()
        subject.way = "slow"
        self.look(subject)
        self.door.refuse("switch", -32000, "not now", {"kind": "set", "where": "first"})
        for press in (".question button", ".question .danger"):
            self.page.click(self.page.button("Switch configuration"))
            self.page.await_text("[data-plan=first]", "slow")
            self.page.click(self.page.button("Switch to first"))
            self.page.await_text(".question", "init of task1 fits no gap")
            self.assertEqual(self.door.asked("switch"), [])
            self.page.click(press)
        self.await_message("not now")
        self.assertEqual(self.door.asked("switch"), [{"configuration": "first"}])

    def test_a_switch_under_way_can_be_cancelled(self):
        self.look()
        self.door.refuse("cancel", -32000, "it is too late", {"kind": "too-late", "where": "first"})
        with self.door.change() as subject:
            subject.switch = {"to": "first", "progress": "agreeing", "deadline_ns": 1}
        self.page.click(self.page.button("Cancel the switch under way"))
        self.await_message("it is too late")
        self.assertEqual(self.door.asked("cancel"), [{}])
        with self.door.change() as subject:
            subject.switch = None
        self.page.await_none(self.page.button("Cancel the switch under way"))

    def test_escape_closes_what_is_open_and_nothing_else(self):
        self.look()
        self.page.choose("task1")
        for label, opened in (("Switch configuration", ".sheet"), ("More acts", ".sheet"), ("Help", ".help"),
                              ("Find", ".finder")):
            self.page.click(self.page.button(label))
            self.page.await_one(opened)
            self.page.press(Keys.ESCAPE)
            self.page.await_none(opened)
            self.assertEqual(len(self.page.all("g.box.chosen")), 1, label)
        self.page.press(Keys.ESCAPE)
        self.page.await_none("g.box.chosen")

    def test_the_flag_goes_up_at_once_by_button_and_key(self):
        self.look()
        self.page.click(self.page.button("Raise the FLAG"))
        self.page.await_root("flag", "up")
        self.page.await_text("[data-flag-by]", "operator")
        self.page.click(self.page.button("Lower the FLAG"))
        self.page.await_root("flag", "down")
        self.page.press_with(Keys.SHIFT, "F")
        self.page.await_root("flag", "up")
        self.assertEqual(self.door.asked("flag"), [{"up": True}, {"up": False}, {"up": True}])

    def test_the_flag_goes_up_over_an_open_question(self):
        self.look()
        self.page.choose("task1")
        self.page.press("k")
        self.page.await_one(".question")
        self.page.press_with(Keys.SHIFT, "F")
        self.page.await_root("flag", "up")
        self.assertEqual(self.door.asked("signal"), [])

    def test_a_field_sets_an_operator_variable(self):
        self.look()
        field = self.page.type_over("#set-wish", "2.5", Keys.ENTER)
        self.page.await_that("document.getElementById('set-wish').value === '2.5'", "the new value")
        self.assertEqual(self.door.asked("set"), [{"values": {"wish": "2.5"}}])
        field.send_keys("99", Keys.ESCAPE)
        self.page.await_that("document.getElementById('set-wish').value === '2.5'", "the value before")
        self.assertEqual(len(self.door.asked("set")), 1)

    def test_a_refused_value_stays_in_the_field_with_the_reason(self):
        self.look()
        self.door.refuse("set", -32602, "wish: 99 is above its maximum 10", {"where": "wish"})
        field = self.page.type_over("#set-wish", "99", Keys.ENTER)
        self.await_message("above its maximum")
        self.assertEqual(field.get_property("value"), "99")

    def test_a_slider_sets_by_keys_and_its_last_place_wins(self):
        self.look()
        slider = "input[aria-label='wish, slider']"
        self.page.focus(slider)
        self.page.press(*[Keys.ARROW_RIGHT] * 10)
        last = float(self.page.one(slider).get_property("value"))
        self.page.await_that(f"document.getElementById('set-wish').value === '{last:g}'", "the value of the slider")
        self.assertGreater(last, 1.0)
        self.assertEqual(self.door.asked("set")[-1], {"values": {"wish": last}})
        self.assertLessEqual(len(self.door.asked("set")), 10)

    def test_the_plan_of_a_switch_comes_before_it(self):
        self.look()
        self.page.click(self.page.button("Switch configuration"))
        self.page.await_text("[data-plan=first]", "OFF: task1, task2")
        self.page.await_text("[data-plan=all]", "is in force")
        self.assertEqual(self.page.attribute(self.page.button("Switch to all"), "aria-disabled"), "true")
        self.assertEqual(self.door.asked("switch"), [])

    def test_an_act_whose_answer_is_lost_is_not_sent_again(self):
        self.look()
        self.page.choose("task1")
        self.door.stall()
        self.page.press("f")
        self.door.await_asked("signal")
        self.door.cut()
        self.door.resume()
        self.await_message("may have been carried out")
        self.page.await_root("version", "2")
        self.assertEqual(len(self.door.asked("signal")), 1)


class Observer(PageTest):
    """A person who may only look."""

    def test_acts_are_not_allowed_and_say_why(self):
        subject = Subject.chain()
        subject.role = "observe"
        door = self.look_at(Door(self.runtime, subject))
        self.page.choose("task1")
        self.page.await_root("role", "observe")
        for label in ("off task1", "kill task1", "Raise the FLAG"):
            button = self.page.button(label)
            self.assertEqual(self.page.attribute(button, "aria-disabled"), "true", label)
            self.assertIn("role 'operate'", self.page.attribute(button, "title"), label)
            self.page.click(button)
        self.page.press("f", "k")
        self.page.press_with(Keys.SHIFT, "F")
        self.assertEqual(self.page.attribute("#set-wish", "readOnly"), "true")
        self.assertFalse(self.page.one("input[aria-label='wish, slider']").is_enabled())
        self.page.click(self.page.button("Switch configuration"))
        self.page.await_text("[data-plan=first]", "OFF")
        self.page.click(self.page.button("Switch to first"))
        self.page.click(self.page.button("More acts"))
        self.assertIn("role 'configure'", self.page.attribute(self.page.button("End the subsystem"), "title"))
        self.assertEqual([request["method"] for request in door.requests if request["method"] not in
                          ("hello", "status", "describe", "subscribe", "plan")], [])

    def test_what_is_refused_for_a_role_says_so(self):
        subject = Subject.chain()
        subject.role = "operate"
        door = self.look_at(Door(self.runtime, subject))
        with door.change():
            subject.role = "observe"  # the group was taken away while the page was open
        self.page.choose("task1")
        self.page.press("f")
        self.page.await_text("[data-message]", "needs the role operate")


if __name__ == "__main__":
    sys.exit(main())
