# SPDX-License-Identifier: Apache-2.0
"""The panel "Steps": a person builds a sequence by mouse and by keyboard, and sees switches and faults at its steps."""
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

from access import faint, unnamed  # noqa: E402
from assembling import AssembleTest, field  # noqa: E402
from case import main  # noqa: E402
from page import Keys, quoted  # noqa: E402

LESSON = (pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "examples" / "21_sequence" / "cell.yaml").read_text()
BEFORE, STEPS = LESSON.split("\nsequence:\n")
UNTIL = {1: "q_ref[0] >= 0.8 rad", 2: "q_ref[0] <= 0 rad", 3: "q_ref[0] <= -0.6 rad"}
PAIR = """subsystem: pair
tasks:
  source: {component: t_source, rate: 20 Hz, constants: {start: 1 m/s, slope: 1 m/s^2}}
  twice: {component: gain, rate: 20 Hz, constants: {k: 2}}
"""
LATE = """subsystem: late
tasks:
  slowly: {component: t_source, rate: 10 Hz, budget: 60 ms, constants: {start: 1 m/s, slope: 1 m/s^2}}
  often: {component: gain, rate: 100 Hz, budget: 6 ms, constants: {k: 2}, alias: {x: wish, y: z}}
operator: {wish: 1 m/s}
configurations: {one: [slowly], two: [often]}
sequence: {repeat: true, steps: [{switch: one, for: 1 s}, {switch: two, for: 1 s}]}
"""
SETS = PAIR + "configurations:\n  one: [source]\n  two: [source, twice]\n"


def of_step(number, key):
    return field(f"step {number} {key}")


def tile(number):
    return f'li[data-step="{number}"]'


class StepsTest(AssembleTest):
    def steps(self, text, name="cell.yaml"):
        """The page on a FILE of that text, with the panel."""
        self.assemble(text, name)
        self.page.click("[data-steps-button]")
        self.page.await_one("section[aria-label=Steps]")

    def choose(self, number, key, value):
        with self.one_act():
            self.page.one(f"select[data-field='step {number} {key}'] option[value={quoted(value)}]").click()

    def check(self, name):
        with self.one_act():
            self.page.click(f"input[aria-label={quoted(name)}]")

    def edges(self):
        """The words of each switch from tile to tile, once they are judged."""
        self.page.await_that("document.querySelector('li.between') && ![...document.querySelectorAll('li.between')]"
                             ".some(e => e.textContent.includes('not judged'))", "the switches")
        return [words.strip() for words in self.page.texts("li.between")]


class Building(StepsTest):
    def test_the_sequence_of_lesson_21_is_built_by_mouse(self):
        self.steps(BEFORE)
        self.page.await_text("section[aria-label=Steps]", "Add its first step")
        for number in range(1, 5):
            self.press("Add step")
            self.page.await_one(tile(number))
        for number, words in UNTIL.items():
            self.fill(of_step(number, "until"), words)
            self.fill(of_step(number, "within"), "3 s")
        self.choose(2, "else", "home")
        self.choose(3, "else", "home")
        self.fill(of_step(4, "for"), "2 s")
        self.check("reentry of step 4")
        self.await_verdict("legal")
        self.assertEqual(self.text(), BEFORE + "\nsequence:\n" + STEPS.replace("'", '"'))
        slow = "slow unless the constants keep their values to step"
        self.assertEqual(self.edges(), [f"{slow} 2", f"{slow} 3", "fast to step 4"])
        self.page.await_text(f"{tile(2)} .edge", "slow unless the constants keep their values else home")
        self.page.await_text(f"{tile(3)} .edge", "fast else home")
        self.assertIn("constant payload_mass comes from welder instead of gripper",
                      self.page.attribute("li.between .edge", "title"))
        self.undo()
        self.assertNotIn("reentry", self.text())
        for _ in range(13):
            self.undo()
        self.assertEqual(self.text(), BEFORE)

    def test_keys_alone_change_a_sequence(self):
        self.assemble(LESSON, "cell.yaml")
        self.page.script("document.activeElement.blur()")
        self.page.press("s")
        self.await_focus("add-step")
        text = LESSON
        with self.one_act():
            self.page.tab_to(of_step(2, "within"))
            self.page.press_with(Keys.CONTROL, "a")
            self.page.press("5 s", Keys.ENTER)
        text = text.replace("0 rad', within: 3 s", "0 rad', within: 5 s")
        self.assertEqual(self.text(), text)
        with self.one_act():
            self.page.tab_to("input[aria-label='confirm of step 2']")
            self.page.press(Keys.SPACE)
        text = text.replace("5 s, else: home", "5 s, else: home, confirm: true")
        self.assertEqual(self.text(), text)
        with self.one_act():
            self.page.tab_to(self.page.button("Move step 2 right"))
            self.page.press(Keys.ENTER)
        second, third = [line for line in text.splitlines() if "{switch: weld" in line or "{switch: carry" in line]
        moved = text.replace(f"{second}\n{third}", f"{third}\n{second}")
        self.assertEqual(self.text(), moved)
        self.page.await_that("document.activeElement.getAttribute('aria-label') === 'Move step 3 right'", "the focus")
        self.page.press_with(Keys.CONTROL, "z")
        self.await_text(text)
        with self.one_act():
            self.page.tab_to(self.page.button("Remove step 1"))
            self.page.press(Keys.ENTER)
        self.assertEqual(self.text(), "".join(
            line for line in text.splitlines(keepends=True) if "{switch: fetch" not in line))

    def test_a_list_becomes_one_that_repeats_and_stays_a_map(self):
        self.steps(SETS + "sequence: [{switch: one, for: 1 s}, {switch: two, for: 2 s}]\n")
        self.check("repeat")
        steps = "    - {switch: one, for: 1 s}\n    - {switch: two, for: 2 s}\n"
        self.assertEqual(self.text(), SETS + "sequence:\n  repeat: true\n  steps:\n" + steps)
        self.assertEqual(len(self.edges()), 2)
        self.press("Add step")
        self.fill(of_step(3, "name"), "again")
        self.fill(of_step(3, "for"), "3 s")
        self.assertEqual(self.edges()[2], "no switch to step 1")
        self.check("repeat")
        self.assertEqual(self.text(), SETS + "sequence:\n  steps:\n" + steps +
                         "    - {name: again, switch: one, for: 3 s}\n")
        self.await_verdict("legal")

    def test_a_switch_without_guarantee_is_open_and_one_for_deadlines_slow(self):
        self.steps(LATE)
        self.assertEqual(self.edges(), ["not schedulable to step 2", "slow to step 1"])
        self.assertEqual([edge.get_attribute("title") for edge in self.page.all("li.between .edge")],
                         ["slowly may miss its deadline on cpu0", "often may miss its deadline on cpu0"])

    def test_else_follows_a_renamed_step(self):
        self.steps(LESSON)
        self.fill(of_step(4, "name"), "rest")
        self.assertEqual(self.text(), LESSON.replace("else: home", "else: rest").replace(
            "{switch: home", "{name: rest, switch: home"))
        self.await_verdict("legal")
        self.fill(of_step(4, "name"), "")
        self.assertEqual(self.text(), LESSON)

    def test_until_is_completed_while_it_is_typed(self):
        self.steps(LESSON)
        until = self.page.one(of_step(1, "until"))
        until.send_keys(Keys.CONTROL + "a")
        until.send_keys("q_re")
        words = "return [...arguments[0].list.options].map(e => e.value)"
        self.assertIn("q_ref[5] ", self.page.script(words, until))
        self.assertNotIn("sequence_step ", self.page.script(words, until))
        until.send_keys("f[5] ")
        self.assertEqual(self.page.script(words, until)[0], "q_ref[5] >= ")
        until.send_keys("< 9")
        self.assertEqual(self.page.script(words, until)[:2], ["q_ref[5] < 9 rad", "q_ref[5] < 9 deg"])
        until.send_keys(Keys.ESCAPE)
        self.assertEqual(self.page.attribute(of_step(1, "until"), "value"), UNTIL[1])

    def test_the_box_of_the_task_leads_to_the_steps(self):
        self.assemble(LESSON, "cell.yaml")
        self.page.click(self.page.box("sequence"))
        self.page.await_one("section[aria-label=Steps]")
        self.page.await_text("aside article", "The key sequence makes this task")
        self.assertEqual(self.page.all("aside input[data-rename]"), [])
        self.page.click(self.page.button("Close"))
        self.page.await_none("section[aria-label=Steps]")
        self.page.click(self.page.button("Show the steps"))
        self.await_focus("add-step")

    def test_no_act_writes_the_task_of_the_key(self):
        self.steps(SETS + "sequence: [{switch: one, for: 1 s}, {switch: two}]\n")
        self.page.focus(self.page.box("source"))
        with self.one_act():
            self.page.one("#add-configuration-name").send_keys("three", Keys.ENTER)
        self.assertIn("  three: [source, twice]\n", self.text())


class Wrong(StepsTest):
    def test_a_fault_stands_at_its_step(self):
        self.steps(LESSON)
        self.fill(of_step(2, "until"), "speed >= 1 m/s")
        self.await_verdict("faulty")
        self.page.await_text(f"{tile(2)} li[data-fault]", "names the variable 'speed', which is not there")
        self.assertEqual(len(self.page.all("section[aria-label=Steps] li[data-fault]")), 1)
        self.page.await_text("li.between", "not judged")
        self.page.script("document.activeElement.blur()")
        self.page.press(Keys.F8)
        self.page.await_that(f"document.activeElement.closest({quoted(tile(2) + ' li[data-fault]')})", "the focus")
        self.page.click(self.page.button("Close"))
        self.page.click("li[data-fault] .link")
        self.page.await_one(tile(2))
        self.page.await_that(f"document.activeElement.matches({quoted(of_step(2, 'until'))})", "the focus of the field")
        self.undo()
        self.assertEqual(self.text(), LESSON)
        self.page.await_none("section[aria-label=Steps] li[data-fault]")

    def test_faults_of_the_form_stand_at_their_steps(self):
        self.steps(SETS + "sequence:\n  - {switch: one}\n  - {switch: three, for: 0 s}\n"
                   "  - {switch: two, until: 'y > 1', for: 1 s}\n")
        for number, words in ((1, "neither 'until' nor 'for'"), (2, "names the configuration 'three'"),
                              (2, "expected more than 0"), (3, "has 'until' and 'for'"), (3, "no 'within' limits")):
            self.page.await_text(f"{tile(number)} li[data-fault]", words)

    def test_a_name_of_no_words_is_no_name(self):
        self.steps(LESSON)
        self.type_into(of_step(1, "name"), "   ")
        self.fill(of_step(1, "name"), "9 lives")
        self.page.await_text(f"{tile(1)} li[data-fault]", "is '9 lives'; expected a letter")
        self.fill(of_step(1, "name"), " ")
        self.assertEqual(self.text(), LESSON)

    def test_a_refused_word_stays_in_its_field(self):
        text = SETS + "sequence:\n  - one\n"
        self.steps(text)
        self.type_into(of_step(1, "for"), "2 s")
        self.page.await_one(f"{of_step(1, 'for')}[aria-invalid=true]")
        self.page.await_text(f"{tile(1)} [role=alert]", "has a value without parts")
        self.assertEqual(self.page.attribute(of_step(1, "for"), "value"), "2 s")
        self.assertEqual(self.text(), text)

    def test_a_seventeenth_step_is_refused(self):
        steps = ["  - {switch: one, for: 1 s}\n", "  - {switch: two, for: 1 s}\n"]
        self.steps(SETS + "sequence:\n" + "".join(steps * 8))
        self.page.await_one(tile(16))
        self.page.await_one(f"{self.page.button('Add step')}[aria-disabled=true][title*='at most 16 steps']")
        self.file.write_text(SETS + "sequence:\n" + "".join(steps * 8 + steps[:1]))
        self.page.await_text("ul[aria-label='Faults of the sequence']", "has 17 steps; expected 1 to 16")

    def test_without_configurations_the_first_is_added(self):
        self.steps(PAIR)
        self.page.await_text("section[aria-label=Steps]", "The text has no configurations")
        self.assertEqual(self.page.all(self.page.button("Add step")), [])
        self.page.click(self.page.button("Add a configuration"))
        self.await_focus("add-configuration-name")
        with self.one_act():
            self.page.press("one", Keys.ENTER)
        self.press("Add step")
        self.assertTrue(self.text().endswith("sequence:\n  - {switch: one}\n"), self.text())

    def test_a_text_that_is_no_yaml_leaves_the_steps_as_they_stand(self):
        self.steps(LESSON)
        self.file.write_text(LESSON + "  [")
        self.await_verdict("unreadable")
        self.page.await_one(f"{tile(1)} input[readonly]")


class Access(StepsTest):
    def test_each_control_has_a_name_and_each_text_contrast(self):
        self.addCleanup(self.browser.command, "Emulation.setEmulatedMedia", features=[])
        for scheme in ("light", "dark"):
            self.browser.command("Emulation.setEmulatedMedia",
                                 features=[{"name": "prefers-color-scheme", "value": scheme}])
            self.steps(LESSON.replace("within: 3 s}", "}"), f"{scheme}.yaml")
            self.page.await_one(f"{tile(1)} li[data-fault]")
            self.assertEqual(unnamed(self.browser), [])
            self.assertEqual(faint(self.browser), [])


if __name__ == "__main__":
    sys.exit(main())
