# SPDX-License-Identifier: Apache-2.0
"""A person assembles a description on the page: every act once, faults at their places, remedies, and the text."""
import json
import os
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

from access import faint, unnamed  # noqa: E402
from assembling import AssembleTest, field, link, port_of, rename  # noqa: E402
from case import main  # noqa: E402
from drawing import expect_that_of_check  # noqa: E402
from machine import PLANT  # noqa: E402
from page import Keys, quoted  # noqa: E402
from web import BUILD  # noqa: E402

SOURCE = pathlib.Path(os.environ["CHIMERA_SOURCE"])
VERIFY = SOURCE / "tests" / "verify"
FAULTY = ("component_unknown", "configurations", "constant_unmet", "input_unmet", "loop_without_initial",
          "rate_missing", "repeated_port", "resource_missing", "rtpu_unknown", "shape_clash", "two_producers",
          "unit_clash")
# docs/howto/assemble.md has the tasks and values of Figure 4.
FIGURE_4 = """version: 1
subsystem: puma_pid
tasks:
  trajectory: {component: joint_trajectory}
  pid: {component: pid_joint}
  arm: {component: puma_torque}
"""
VALUES = (("trajectory", "constants/duration", "2 s"), ("", "constants/goal", "0.5 rad"),
          ("", "operator/kp", "1000 N.m/rad"), ("", "operator/kd", "50 N.m.s/rad"))
CHAIN = """# two tasks
subsystem: chain
tasks:
  source: {component: t_source, rate: 20 Hz, constants: {start: 1 m/s, slope: 1 m/s^2}}  # the first

  twice: {component: gain, alias: {x: speed}, rate: 20 Hz, constants: {k: 2}}
"""


def keys_of(faults, task, port=None):
    """Messages of the errors at a box, or at a port: a fault of all instances of a port belongs to each."""
    return [fault["message"] for fault in faults if fault["severity"] == "error" and fault["task"] == task and (
        port is None or fault["port"] and re.fullmatch(re.escape(fault["port"]) + r"(\[\d+\])?", port))]


class Acts(AssembleTest):
    def test_a_file_that_is_not_there_becomes_a_legal_saved_one(self):
        self.assemble(name="first.yaml")
        self.assertEqual(self.page.root("touched"), "no")
        self.add_task("t_source", "source")
        self.fill(field("source", "constants/start"), "1 m/s")
        self.fill(field("source", "constants/slope"), "2 m/s^2")
        self.fill(field("source", "rate"), "20 Hz")
        self.await_verdict("legal")
        self.assertFalse(self.file.exists())
        self.page.click(self.page.button("Save FILE"))
        self.page.await_root("touched", "no")
        self.page.await_root("lamp-file", "same")
        self.assertEqual(self.disk(), self.text())
        self.assertIn("first: legal. 1 task", self.check())
        expect_that_of_check(self, self.file, 1)

    def test_a_port_is_linked_by_its_field(self):
        self.assemble(CHAIN)
        self.await_verdict("faulty")
        self.page.choose("twice")
        self.fill(link("twice", "x"), "x")
        self.await_verdict("legal")
        self.assertEqual(self.text(), CHAIN.replace("alias: {x: speed}, ", ""))

    def test_a_pulled_line_links_either_way(self):
        for start, end in ((("source", "x"), ("twice", "x")), (("twice", "x"), ("source", "x"))):
            with self.subTest(start):
                self.assemble(CHAIN, f"{start[0]}.yaml")
                with self.one_act():
                    self.pull(start, end)
                self.await_verdict("legal")
                self.page.click(self.page.button("Save FILE"))
                self.page.await_root("touched", "no")
                expect_that_of_check(self, self.file, 2)

    def test_a_line_between_two_outputs_is_refused_in_words(self):
        self.assemble(CHAIN)
        version = self.version()
        self.pull(("source", "x"), ("twice", "y"))
        self.page.await_text("[data-message]", "both ports are outputs")
        self.assertEqual(self.version(), version)

    def test_a_renamed_task_is_followed_and_one_undo_gives_the_bytes_back(self):
        before = PLANT.read_text()
        self.assemble(before)
        self.page.choose("trim")
        self.fill(rename("trim"), "shift")
        self.page.await_one(self.page.box("shift"))
        after = before.replace("  trim: {component", "  shift: {component").replace("[source, trim,", "[source, shift,")
        self.assertEqual(self.text(), after)
        self.undo()
        self.assertEqual(self.text(), before)
        self.page.await_root("undo", "0")
        self.undo("Redo")
        self.assertEqual(self.text(), after)
        self.await_verdict("legal")

    def test_a_renamed_variable_is_followed_at_each_port(self):
        self.assemble(PLANT.read_text())
        self.page.click("text.link[data-label=torque]")
        self.fill(rename("torque"), "moment")
        head, body = PLANT.read_text().split("version", 1)
        self.assertEqual(self.text(), head + "version" + body.replace("torque", "moment"))
        self.await_verdict("legal")

    def test_keys_of_a_task_are_fields(self):
        self.assemble(PLANT.read_text())
        self.page.choose("trim")
        self.fill(field("trim", "rate"), "40 Hz")
        self.fill(field("trim", "budget"), "100 us")
        for name, value in (("criticality", "high"), ("rtpu", "back")):
            with self.one_act():
                self.page.one(f"select[data-field='trim {name}'] option[value={value}]").click()
        self.await_verdict("legal")
        line = next(line for line in self.text().splitlines() if line.startswith("  trim:"))
        for word in ("rate: 40 Hz", "budget: 100 us", "criticality: high", "rtpu: back"):
            self.assertIn(word, line)
        self.fill(field("trim", "budget"), "")
        self.assertNotIn("budget", self.text())

    def test_a_refused_value_keeps_the_words_and_says_why(self):
        self.assemble(PLANT.read_text())
        self.page.choose("trim")
        self.type_into(rename("trim"), "9 lives")
        self.page.await_one(f"{rename('trim')}[aria-invalid=true]")
        self.assertEqual(self.page.attribute(rename("trim"), "value"), "9 lives")
        self.assertEqual(self.text(), PLANT.read_text())
        self.page.press(Keys.ESCAPE)
        self.page.await_none(f"{rename('trim')}[aria-invalid=true]")

    def test_operator_variables_and_constants_are_fields(self):
        self.assemble(PLANT.read_text())
        self.fill(field("operator/bias"), "0.75 m/s")
        self.assertEqual(self.text(), PLANT.read_text().replace("bias: 0.5 m/s", "bias: 0.75 m/s"))
        self.page.choose("strong")
        self.fill(field("strong", "constants/k"), "5 N.s")
        self.assertIn("constants: {k: 5 N.s}", self.text())
        self.choose_nothing()
        with self.one_act():
            self.page.one("#add-constants-name").send_keys("mass")
            self.page.one("#add-constants-value").send_keys("3 kg", Keys.ENTER)
        self.assertIn("mass: 3 kg", self.text())
        self.page.await_text("li.warning", "constant 'mass' is used by no task")

    def test_configurations_are_made_filled_and_started(self):
        self.assemble(PLANT.read_text())
        with self.one_act():
            self.page.one("#add-configuration-name").send_keys("calm", Keys.ENTER)
        self.page.await_text("li.error", "has two producers in configuration 'calm'")
        self.page.choose("strong")
        with self.one_act():
            self.page.click("input[aria-label='strong in calm']")
        self.await_verdict("legal")
        self.choose_nothing()
        self.page.script("document.querySelectorAll('details').forEach((e) => { e.open = true; })")
        self.press("Start with calm")
        self.assertIn("start: calm", self.text())
        self.assertIn("calm: [source, trim, gentle, shown]", self.text())

    def test_a_removed_task_leaves_its_configurations(self):
        self.assemble(PLANT.read_text())
        self.page.choose("gentle")
        self.page.focus(self.page.box("gentle"))
        with self.one_act():
            self.page.press(Keys.DELETE)
        self.page.await_none(self.page.box("gentle"))
        self.assertNotIn("gentle", self.text())

    def test_instances_of_a_repeated_port_are_added_and_removed(self):
        self.assemble(CHAIN.replace("speed", "x"))
        self.add_task("join_mean", "mean")
        for variable in ("x", "y"):
            with self.one_act():
                self.page.one("#add-mean-in").send_keys(variable, Keys.ENTER)
        self.assertIn("in: [x, y]", self.text())
        self.press("Remove mean in[1]")
        self.assertIn("in: [x]", self.text())

    def test_keys_alone_add_rename_undo_save_and_remove(self):
        self.assemble(name="first.yaml")
        with self.one_act():
            self.page.press("n")
            self.await_focus("add-task-component")
            self.page.press("t_source", Keys.TAB, "source", Keys.ENTER)
        self.page.await_one(f"{self.page.box('source')}.chosen")
        with self.one_act():
            self.page.press(Keys.F2)
            self.page.press("wave", Keys.ENTER)
        self.page.await_one(self.page.box("wave"))
        self.page.press_with(Keys.CONTROL, "z")
        self.page.await_one(self.page.box("source"))
        self.page.press_with(Keys.CONTROL, "y")
        self.page.await_one(self.page.box("wave"))
        self.page.press_with(Keys.CONTROL, "s")
        self.page.await_root("touched", "no")
        self.assertIn("wave:", self.disk())
        self.page.press_with(Keys.CONTROL, "k")
        self.page.press("wave", Keys.ENTER)
        self.page.tab_to("g.box")
        with self.one_act():
            self.page.press(Keys.DELETE)
        self.page.await_none("g.box")

    def test_each_control_has_a_name_and_each_text_contrast(self):
        self.assemble(PLANT.read_text())
        self.page.choose("trim")
        self.assertEqual(unnamed(self.browser), [])
        self.assertEqual(faint(self.browser), [])


class Faults(AssembleTest):
    def test_each_fault_is_at_its_box_and_port_and_in_the_list(self):
        (self.place / "build").mkdir()
        (self.place / "build" / "components").symlink_to(VERIFY / "components")
        self.assemble((VERIFY / "faulty" / f"{FAULTY[0]}.yaml").read_text())
        ports = boxes = 0
        for name in FAULTY:
            with self.subTest(name):
                text = (VERIFY / "faulty" / f"{name}.yaml").read_text()
                self.file.write_text(text)
                self.await_text(text)
                faults = json.loads(self.check("--json"))["faults"]
                messages = [("warning: " if f["severity"] == "warning" else "") + f["message"] for f in faults]
                self.assertEqual(self.page.texts("li[data-fault] > .link"), messages)
                for box, is_faulty in self.page.script("return [...document.querySelectorAll('g.box')].map("
                                                       "(e) => [e.dataset.task, e.classList.contains('faulty')])"):
                    self.assertEqual(is_faulty, keys_of(faults, box) != [], box)
                    boxes += is_faulty
                for port, is_faulty in self.page.script("return [...document.querySelectorAll('[data-port]')].map("
                                                        "(e) => [e.dataset.port, e.classList.contains('faulty')])"):
                    self.assertEqual(is_faulty, keys_of(faults, *port.split(" ")) != [], port)
                    ports += is_faulty
        self.assertGreater(boxes, len(FAULTY))
        self.assertGreater(ports, 5)

    def test_a_fault_leads_to_its_box_and_line(self):
        self.assemble(CHAIN)
        self.page.click("li[data-fault='0'] .link")
        self.page.await_one(f"{self.page.box('twice')}.chosen")
        self.await_focus("draft-text")
        line = self.page.script("const e = document.getElementById('draft-text');"
                                "return e.value.slice(0, e.selectionStart).split('\\n').length")
        self.assertIn("twice:", CHAIN.splitlines()[line - 1])

    def test_figure_4_of_1994_becomes_legal_by_one_press_for_each_fault(self):
        self.assemble(FIGURE_4, "figure_4.yaml")
        self.await_verdict("faulty")
        faults, presses = len(self.page.all("li.error")), 0
        self.assertEqual(len(self.page.all("[data-port].faulty")), faults)
        while self.page.root("verdict") != "legal":
            self.assertLess(presses, faults)
            self.page.await_one("li.error .acts button")
            with self.one_act():
                self.page.click("li.error .acts button")
            presses += 1
        print(f"figure 4: {faults} faults, {presses} presses")
        self.assertEqual(faults, 7)
        for task, key, value in VALUES:
            self.page.click(self.page.box(task)) if task else self.choose_nothing()
            self.fill(field(*filter(None, (task, key))), value)
        self.page.click(self.page.button("Save FILE"))
        self.page.await_root("touched", "no")
        done = subprocess.run([BUILD / "bin" / "chimera", "run", self.file, "--virtual", "--for", "100 ms"],
                              capture_output=True, text=True, check=False, cwd=self.place)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_two_producers_offer_three_joins(self):
        text = CHAIN.replace("speed", "x") + "  more: {component: gain, rate: 20 Hz, constants: {k: 3}}\n"
        self.assemble(text)
        self.page.await_text("li.error", "has two producers")
        for label in ("join by mean", "join by priority", "join by selection"):
            self.page.await_one(self.page.button(label))
            self.press(label)
            self.page.await_none("li.error")
            self.undo()
            self.await_text(text)

    def test_a_cpu_without_room_offers_a_lower_rate(self):
        text = CHAIN.replace("speed", "x").replace("constants: {k", "budget: 49 ms, constants: {k")
        self.assemble(text)
        self.await_verdict("faulty")
        self.press("rate of 'twice': 10 Hz")
        self.await_verdict("legal")
        self.page.await_one("[data-cpu='0']")


class Text(AssembleTest):
    def test_the_drawer_and_the_picture_follow_each_other(self):
        self.assemble(CHAIN)
        with self.one_act():
            self.type_text(CHAIN.replace("twice", "thrice").replace("speed", "x"))
        self.page.await_one(self.page.box("thrice"))
        self.await_verdict("legal")
        self.page.choose("thrice")
        self.fill(field("thrice", "rate"), "10 Hz")
        self.await_text(CHAIN.replace("twice", "thrice").replace("speed", "x").replace(
            "rate: 20 Hz, constants: {k", "rate: 10 Hz, constants: {k"))

    def test_a_text_that_is_no_yaml_keeps_the_last_picture(self):
        self.assemble(CHAIN)
        boxes = self.page.script("return document.querySelectorAll('g.box').length")
        with self.one_act():
            self.type_text(CHAIN + "  [")
        self.await_verdict("unreadable")
        self.page.await_text(".banner.warning", "the last picture stands")
        self.page.await_one("main.last")
        self.assertEqual(self.page.script("return document.querySelectorAll('g.box').length"), boxes)
        self.undo()
        self.await_verdict("faulty")
        self.page.await_none("main.last")

    def test_a_chosen_task_is_found_in_the_text_and_back(self):
        self.assemble(PLANT.read_text())
        self.page.choose("gentle")
        self.page.await_one(f"{self.page.box('gentle')}.at-cursor")
        place = PLANT.read_text().index("trim:")
        self.page.script("const e = document.getElementById('draft-text'); e.focus();"
                         "e.setSelectionRange(arguments[0], arguments[0])", place)
        self.page.press(Keys.ARROW_RIGHT)
        self.page.await_one(f"{self.page.box('trim')}.at-cursor")

    def test_words_of_the_file_are_never_markup(self):
        self.assemble(CHAIN.replace("gain", quoted("<img src=x onerror=alert(1)>")))
        self.page.await_text("li.error", "<img")
        self.assertEqual(self.page.all("img"), [])


if __name__ == "__main__":
    sys.exit(main())
