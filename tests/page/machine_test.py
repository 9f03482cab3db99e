# SPDX-License-Identifier: Apache-2.0
"""The page before a real subsystem: chimera run, its manager and its processes, which the tests also end."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

from case import PageTest, main  # noqa: E402
from drawing import expect_that_of_check  # noqa: E402
from machine import Machine, await_that  # noqa: E402
from page import Keys  # noqa: E402


class MachineTest(PageTest):
    def look(self, **more):
        self.machine = self.look_at(Machine(self.runtime, **more))
        return self.machine

    def await_event(self, number):
        self.page.await_that(f"Number(document.documentElement.dataset.events) >= {number}", f"event {number}")

    def shown_events(self):
        return sorted(int(number) for number in self.page.script(
            "return [...document.querySelectorAll('[data-event]')].map(e => e.dataset.event)"))


class Looking(MachineTest):
    def test_the_picture_is_that_of_check(self):
        self.look()
        expect_that_of_check(self, self.machine.file, 5)

    def test_no_text_of_the_picture_covers_another(self):
        self.look()
        self.page.await_one("text.value[data-value=smooth]:not(:empty)")
        self.page.await_one("text.value[data-value=bias]:not(:empty)")
        covered = self.page.script("""
          const place = (e) => {
            const box = e.getBBox(), size = parseFloat(getComputedStyle(e).fontSize), base = e.y.baseVal[0].value;
            return [e.textContent, box.x, box.x + box.width, base - 0.75 * size, base + 0.1 * size]; };
          const all = [...document.querySelectorAll('svg.picture text')].filter((e) => e.textContent).map(place);
          return all.flatMap((a, i) => all.slice(i + 1)
            .filter((b) => a[1] < b[2] && b[1] < a[2] && a[3] < b[4] && b[3] < a[4]).map((b) => [a[0], b[0]]));""")
        self.assertEqual(covered, [])

    def test_a_value_stands_at_the_port_of_its_producer_alone(self):
        self.look()
        self.page.await_one("text.value[data-of=strong][data-value=torque]:not(:empty)")
        self.assertEqual(self.page.texts("text.value[data-of=gentle][data-value=torque]"), [""])

    def test_off_and_on_are_shown_and_reach_the_tasks(self):
        self.look()
        self.assertEqual(self.page.states(), {"source": "ON", "trim": "ON", "strong": "ON", "gentle": "OFF",
                                              "shown": "ON"})
        self.page.choose("shown")
        self.page.click(self.page.button("off shown"))
        self.page.await_state("shown", "OFF")
        self.assertEqual(self.machine.state("shown"), "OFF")
        self.page.press("o")
        self.page.await_state("shown", "ON")
        self.assertEqual(self.machine.state("shown"), "ON")

    def test_an_act_of_another_is_shown(self):
        self.look()
        self.machine.signal("off", "shown")
        self.page.await_state("shown", "OFF")
        self.page.await_text("[data-event]", "ON -> OFF")

    def test_a_refused_on_offers_what_is_legal_together(self):
        self.look()
        self.machine.signal("off", "source", "trim", "strong", "shown")
        self.page.await_state("source", "OFF")
        self.page.choose("gentle")
        self.page.press("o")
        self.page.await_text("[data-message]", "would have no producer")
        self.page.click(self.page.button("Turn ON together: source, trim, gentle"))
        self.page.await_state("gentle", "ON")
        self.assertEqual(self.machine.on(), {"source", "trim", "gentle"})

    def test_a_switch_shows_its_plan_before_and_its_receipt_after(self):
        self.look()
        self.page.click(self.page.button("Switch configuration"))
        self.page.await_text("[data-plan=rest]", "ON: gentle; OFF: strong")
        self.assertEqual(self.machine.call("receipts")["receipts"], [])
        self.page.click(self.page.button("Switch to rest"))
        self.page.await_text("[data-message]", "work → rest: done")
        self.page.await_root("configuration", "rest")
        self.assertIn("rest", self.page.text("[data-in-force]"))
        self.page.click("#tab-receipts")
        self.page.await_text("#panel details summary", "work → rest")
        self.page.click("#panel details summary")
        self.assertIn("gentle", self.page.text("#panel details table"))

    def test_one_configuration_alone_can_be_drawn(self):
        self.look()
        self.page.click(self.page.button("Switch configuration"))
        self.page.click(self.page.button("Draw only work"))
        self.page.await_none(self.page.box("gentle"))
        self.assertEqual(set(self.page.states()), {"source", "trim", "strong", "shown"})
        self.page.click(self.page.button("Draw only work"))
        self.page.await_one(self.page.box("gentle"))

    def test_why_names_the_task_that_is_off(self):
        self.look()
        self.machine.signal("off", "source")
        self.page.await_state("source", "OFF")
        self.page.choose("shown")
        self.page.press("w")
        self.page.await_one("[data-why=smooth]")
        self.page.await_one("li[data-verdict=producer-off]")
        self.assertIn("source", self.page.text("li[data-verdict=producer-off]"))

    def test_an_operator_variable_is_set_in_its_unit(self):
        self.look()
        self.page.await_that("document.getElementById('set-bias').value === '0.5 m/s'", "the first value")
        self.page.type_over("#set-bias", "2", Keys.ENTER)
        self.page.await_that("document.getElementById('set-bias').value === '2 m/s'", "the new value")
        self.assertEqual(self.machine.value("bias"), 2.0)
        self.page.type_over("#set-bias", "1 kg", Keys.ENTER)
        self.page.await_one(".message.error")
        self.assertEqual(self.machine.value("bias"), 2.0)

    def test_the_slider_reaches_the_subsystem(self):
        self.look()
        self.page.focus("input[aria-label='bias, slider']")
        self.page.press(*[Keys.ARROW_RIGHT] * 20)
        last = float(self.page.attribute("input[aria-label='bias, slider']", "value"))
        await_that(lambda: self.machine.value("bias") == last, f"bias = {last}")
        self.assertGreater(last, 0.5)

    def test_the_flag_reaches_the_subsystem(self):
        self.look()
        self.page.press_with(Keys.SHIFT, "F")
        self.page.await_root("flag", "up")
        self.assertEqual(self.machine.call("status")["flag"], {"up": True, "by": ["operator"]})
        self.page.click(self.page.button("Lower the FLAG"))
        self.page.await_root("flag", "down")
        self.assertFalse(self.machine.call("status")["flag"]["up"])

    def test_the_profile_counts_cycles(self):
        self.look()
        self.page.click("#tab-profile")
        self.page.await_that("document.querySelectorAll('#panel tbody tr').length === 5", "five rows")
        self.page.await_text("#panel tbody tr", "source")


class Losses(MachineTest):
    """Something dies; the page says so, and goes on when it is back."""

    def test_events_have_no_gap_over_the_death_of_the_manager(self):
        self.look()
        self.expected = ["WebSocket"]
        before = self.machine.call("hello")["manager"]
        self.await_event(self.machine.call("events")["last"])
        self.machine.disconnect()
        self.assertTrue(self.machine.kill(before["pid"]))
        self.page.await_root("manager", str(before["starts"] + 1))
        self.machine.signal("off", "shown")
        self.page.await_state("shown", "OFF")
        numbers = [event["number"] for event in self.machine.events()]
        self.await_event(numbers[-1])
        self.assertEqual([number for number in self.shown_events() if number <= numbers[-1]], numbers)
        self.assertEqual(self.page.root("gaps"), "0")

    def test_a_killed_process_is_said_and_its_values_come_back(self):
        self.look()
        self.page.await_one("text.value[data-value=torque]:not(.old)")
        since = self.machine.next_event()
        before = self.machine.rtpu("back")
        self.assertTrue(self.machine.kill(before["pid"]))
        self.machine.await_restart("back", before)
        for kind in ("rtpu-ended", "rtpu-restarted"):
            event = self.machine.await_event(since, kind, rtpu="back")
            self.page.await_one(f"[data-event='{event['number']}']")
        self.page.await_state("strong", "ON")
        self.page.await_one("text.value[data-value=torque]:not(.old)")
        self.assertEqual(self.machine.state("source"), "ON")

    def test_a_process_that_is_given_up_stays_said_and_its_values_grey(self):
        self.look()
        for _ in range(4):
            before = self.machine.rtpu("back")
            self.assertTrue(self.machine.kill(before["pid"]))
            await_that(lambda: (now := self.machine.rtpu("back"))["given_up"]
                       or now["alive"] and now["incarnation"] > before["incarnation"], "the next incarnation")
        self.page.await_text(".banner.error", "It is not started again")
        self.page.await_one(f"{self.page.box('strong')}.dead")
        self.page.await_one("text.value[data-value=torque].old")
        self.page.await_one("text.value[data-value=total]:not(.old)")

    def test_a_new_link_goes_on_where_the_page_was(self):
        self.look()
        self.expected = ["WebSocket", "ERR_CONNECTION_REFUSED"]
        self.page.choose("trim")
        self.page.click("#tab-why")
        old = self.web_server
        on = self.machine.on()
        old.die()
        self.page.await_root("bench", "lost")
        self.assertIn("chimera web", self.page.text(".banner.lost"))
        self.page.await_one("main.stale")
        new = self.using(type(old)(self.runtime, port=old.port))
        self.assertNotEqual(new.key, old.key)
        self.page.await_root("bench", "refused")
        self.page.open(new.link)
        self.page.await_open()
        self.page.await_one(f"{self.page.box('trim')}.chosen")
        self.page.await_one("[data-why=total]")
        self.assertEqual(self.machine.on(), on)

    def test_the_end_of_a_page_changes_nothing(self):
        self.look()
        self.await_event(self.machine.call("events")["last"])
        before = (self.machine.on(), self.acts())
        self.browser.close_tabs()
        self.browser.new_tab()
        self.machine.await_cycles("source")
        self.assertEqual((self.machine.on(), self.acts()), before)

    def acts(self):
        """The events without those of a busy CPU, which come at any time."""
        return [event for event in self.machine.events() if event["kind"] not in ("miss", "blame", "demoted", "stale")]

    def test_a_subsystem_that_ends_is_said_and_shown_when_it_runs_again(self):
        self.look()
        self.page.await_text("[data-state-word]", "RUNNING")
        self.machine.call("end", code=0)
        self.page.await_text(".banner.lost", "plant has ended")
        self.page.await_root("machines", "0")
        self.page.await_text("[data-state-word]", "ENDED")
        self.using(Machine(self.runtime))
        self.page.await_text("[data-state-word]", "RUNNING")
        self.page.await_state("source", "ON")


if __name__ == "__main__":
    sys.exit(main())
