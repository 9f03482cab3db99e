# SPDX-License-Identifier: Apache-2.0
"""The library and its documents on the page: search, sheets, links, the way back, and that a document is data."""
import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

import wire  # noqa: E402
from access import faint, unnamed  # noqa: E402
from case import PageTest, main  # noqa: E402
from machine import Machine  # noqa: E402
from page import Keys  # noqa: E402

SEARCH = "#library-search"


class LibraryTest(PageTest):
    def open(self, place="", arguments=()):
        self.web_server = self.web(*arguments)
        self.page.open(self.web_server.link + place)
        self.page.await_root("bench", "open")

    def search(self, words):
        self.page.one(SEARCH).send_keys(words)
        self.page.await_that(f"document.querySelector('{SEARCH}').value === {json.dumps(words)}", "the words")
        return self.page.texts(".found li > a")

    def await_heading(self, words):
        self.page.await_that(f"document.querySelector('article h1')?.textContent === {json.dumps(words)}", words)

    def test_a_key_opens_the_search_and_a_press_the_sheet(self):
        self.open()
        self.page.press("/")
        self.page.await_root("place", "library")
        self.page.await_one(".found li")
        self.assertEqual(self.page.script("return document.activeElement.id"), SEARCH[1:])
        self.assertEqual(self.search("pid")[:2], ["pid", "pid_joint"])
        self.page.click("[data-found='component/pid'] a")
        self.await_heading("pid")
        self.assertIn("#" + self.web_server.key + "&doc=component/pid", self.page.script("return location.href"))
        self.page.await_one("article table")
        self.assertEqual(self.page.texts("article .equation math")[0].split(" = ")[0], "output")
        self.assertTrue(self.page.all("article .equation mfrac"))
        self.page.await_one("[data-fits='measured'] a")
        self.page.press(Keys.ESCAPE)
        self.page.await_root("place", "")

    def test_arrows_and_enter_reach_a_document_by_keyboard_alone(self):
        self.open()
        self.page.press("/")
        self.page.await_one(".found li")
        self.search("glossary")
        self.page.await_one("[data-found='docs/glossary.md']")
        self.page.press(Keys.ENTER)
        self.page.await_root("place", "docs/glossary.md")
        self.await_heading(self.page.text("[data-found='docs/glossary.md'] a"))

    def test_links_lead_on_and_back_and_forward_return(self):
        self.open("&doc=component/pid")
        self.await_heading("pid")
        self.page.script("[...document.querySelectorAll('article a')].find(e => e.textContent === 'pid_joint').click()")
        self.await_heading("pid_joint")
        self.page.script("[...document.querySelectorAll('article section[aria-label=Lessons] a')][0].click()")
        self.page.await_that("document.documentElement.dataset.place.startsWith('examples/')", "a lesson")
        for step, heading in (("back", "pid_joint"), ("back", "pid"), ("forward", "pid_joint")):
            self.page.script(f"history.{step}()")
            self.await_heading(heading)
        self.assertEqual(self.page.root("bench"), "open")  # the page was not loaded again

    def test_a_link_into_a_document_shows_its_heading(self):
        self.open("&doc=component/lowpass")
        self.await_heading("lowpass")
        self.page.script("[...document.querySelectorAll('article a')].find(e => e.textContent === 'input rule' ||"
                         " e.textContent === 'input\\nrule').click()")
        self.page.await_one("#at-input-rule")
        self.assertIn("&at=input-rule", self.page.script("return location.hash"))
        self.page.await_that("Math.abs(document.querySelector('#at-input-rule').getBoundingClientRect().top -"
                             " document.querySelector('article').getBoundingClientRect().top) < 60", "the heading")

    def test_pictures_and_code_are_shown(self):
        self.open("&doc=component/lowpass")
        self.await_heading("lowpass")
        self.page.await_that("document.querySelectorAll('article img').length === 2", "two pictures")
        widths = self.page.script("const all = [...document.querySelectorAll('article img')], read = (e) => e.decode();"
                                  "return Promise.all(all.map(read)).then(() => all.map((e) => e.naturalWidth));")
        self.assertGreater(min(widths), 100)
        self.assertTrue(self.page.attribute("article img", "src").startswith("blob:"))
        self.page.script("[...document.querySelectorAll('article section[aria-label=Code] a')][0].click()")
        self.await_heading("library/lowpass/lowpass.cc")
        self.page.await_text("article pre", "CHIMERA_COMPONENT")

    def test_a_link_without_key_is_kept_for_the_next_one(self):
        self.open()
        self.page.open(self.web_server.origin() + "/#&doc=component/gain")
        self.page.await_root("bench", "refused")
        self.page.open(self.web_server.link)
        self.await_heading("gain")
        self.page.open(self.web_server.link)
        self.page.await_root("bench", "open")
        self.assertEqual(self.page.root("place"), "")  # once

    def test_an_unknown_place_is_said(self):
        self.open("&doc=component/no_such")
        self.page.await_text("article .fault", "no component 'no_such'")
        self.page.open(self.web_server.link + "&doc=../../etc/passwd")
        self.page.await_text("article .fault", "no document '../../etc/passwd'")

    def test_enter_puts_a_component_on_the_canvas_and_a_drop_links_it(self):
        (self.place / "build/components").mkdir(parents=True)
        (self.place / "build/components/cut.component.json").write_text("{")
        self.open(arguments=(self.place / "arm.yaml",))
        self.page.await_root("mode", "assemble")
        self.page.click(self.page.button("Library"))
        self.page.await_one(".found li")
        self.page.await_text(".library nav details .fault", "cut.component.json: ")
        self.search("pid_joint")
        self.page.press(Keys.ENTER)
        self.page.await_one(self.page.box("pid_joint"))
        self.page.await_one("[data-port='pid_joint q_ref']")
        self.page.await_that("[...document.querySelectorAll('datalist[id=\"values-pid_joint-tau_max\"] option')]"
                             ".some(e => e.textContent === 'test of pid_joint')", "the values of the test")
        self.page.one(SEARCH).send_keys(Keys.CONTROL + "a")
        self.search("joint_trajectory")
        self.page.script("""
            const data = new DataTransfer(), port = document.querySelector("[data-port='pid_joint q_ref']");
            const send = (name, to) => to.dispatchEvent(
                new DragEvent(name, {dataTransfer: data, bubbles: true, cancelable: true}));
            send('dragstart', document.querySelector("[data-found='component/joint_trajectory']"));
            send('dragover', port);
            send('drop', port);""")
        self.page.await_one(self.page.box("joint_trajectory"))
        self.page.await_one("[data-port='joint_trajectory q_ref'][aria-label*='linked to q_ref']")
        self.assertEqual(self.page.root("undo"), "2")  # one act, one undo

    def test_everybody_can_read_and_reach_the_library(self):
        self.open("&doc=component/pid")
        self.await_heading("pid")
        self.page.await_one("[data-fits='measured'] a")
        self.assertEqual(faint(self.browser), [])
        self.assertEqual(unnamed(self.browser), [])

    def test_a_component_has_the_times_that_its_tasks_need_here(self):
        self.open("&doc=component/gain")
        self.page.await_text("[data-facts]", "(its sheet) · not measured here: nothing runs that uses it")
        machine = self.using(Machine(self.runtime))
        for task in ("strong", "shown"):
            machine.await_cycles(task)
        times = "/measured here: strong \\d\\S*s, longest \\d\\S*s; shown \\d\\S*s, longest \\d\\S*s$/"
        self.page.await_that(f"{times}.test(document.querySelector('[data-facts]').textContent)", "the times of both")

    def test_words_that_nothing_has_are_said(self):
        self.open()
        self.page.press("/")
        self.page.await_one(".found li")
        self.assertEqual(self.search("no such thing anywhere"), [])
        self.page.await_text(".library nav .hint", "Nothing has all these words.")


class WireTest(unittest.TestCase):
    """The methods, without the page."""

    def test_sheets_documents_and_values_are_answered_and_other_names_refused(self):
        with wire.Server() as server, server.open() as bench:
            library = bench.call("library")
            pid = next(one for one in library["components"] if one["name"] == "pid_joint")
            self.assertIn("astrom-2006", pid["papers"])
            self.assertIn({"name": "docs/papers.md", "title": "Papers"}, library["documents"])
            sheet = bench.call("sheet", component="pid_joint")
            self.assertTrue(sheet["text"].startswith("# pid_joint\n"))
            self.assertIn("library/pid_joint/pid_joint.cc", sheet["sources"])
            self.assertIn("examples/01_puma_pid/README.md", [one["document"] for one in sheet["lessons"]])
            self.assertEqual(bench.call("document", name="docs/papers.md")["text"].split("\n")[1], "# Papers")
            origins = [one["origin"] for one in bench.call("values", component="pid_joint", port="kp")["values"]]
            self.assertEqual(origins[-1], "pid_joint.test.yaml")
            self.assertTrue(origins[0].startswith("examples/01_puma_pid/"))
            for name in ("../../../etc/passwd", "/etc/passwd", "docs/../.git/config", "docs", "", "docs/papers.md\0"):
                bench.send(json.dumps({"jsonrpc": "2.0", "id": 99, "method": "document", "params": {"name": name}}))
                self.assertEqual(json.loads(bench.message())["error"]["code"], -32005, name)


if __name__ == "__main__":
    sys.exit(main())
