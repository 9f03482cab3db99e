# SPDX-License-Identifier: Apache-2.0
"""The draft beside its FILE: saved, changed by another program, kept over reload and death, shared by windows, and
beside the machine that runs FILE."""
import os
import pathlib
import re
import signal
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

from assembling import AssembleTest, field  # noqa: E402
from case import main  # noqa: E402
from machine import PLANT, Machine, await_that  # noqa: E402
from page import Keys  # noqa: E402
from system import Client, kill  # noqa: E402
from web import Web  # noqa: E402

TEXT = PLANT.read_text()
STYLED = (b"# a comment before\r\nsubsystem:   plant\r\n\r\ntasks:\r\n"
          b"  source:   {component: t_source,  rate: 20 Hz, # odd   spaces\r\n"
          b"             constants: {start: 1 m/s, slope: 1 m/s^2}}\r\n"
          b"\r\n# a comment behind, without a line end")
HOLD = """window.held = [];
const plain = WebSocket.prototype.send;
WebSocket.prototype.send = function (line) { window.held.push(() => plain.call(this, line)); };
window.release = () => { WebSocket.prototype.send = plain; window.held.forEach((send) => send()); };"""


class DraftTest(AssembleTest):
    def set_bias(self, value):
        """Changes one value of the draft of plant.yaml."""
        self.fill(field("operator/bias"), value)

    def save(self):
        self.page.click(self.page.button("Save FILE"))
        self.page.await_root("touched", "no")

    def with_bias(self, value):
        return TEXT.replace("bias: 0.5 m/s", f"bias: {value}")

    def change_outside(self, text):
        """Another program replaces FILE."""
        other = self.place / "other"
        other.write_text(text)
        os.replace(other, self.file)


class File(DraftTest):
    def test_a_save_changes_the_bytes_of_the_act_alone(self):
        self.assemble(STYLED)
        self.page.choose("source")
        self.fill(field("source", "rate"), "25 Hz")
        self.page.await_root("lamp-file", "differs")
        self.assertEqual(self.file.read_bytes(), STYLED)
        self.save()
        self.assertEqual(self.file.read_bytes(), STYLED.replace(b"20 Hz", b"25 Hz"))
        self.page.await_root("lamp-file", "same")

    def test_a_save_by_key_takes_the_field_with_it(self):
        self.assemble(TEXT)
        self.page.one(field("operator/bias")).send_keys(Keys.CONTROL + "a")
        self.page.one(field("operator/bias")).send_keys("0.25 m/s")
        self.page.press_with(Keys.CONTROL, "s")
        self.page.await_text("[data-message]", "Saved")
        self.assertEqual(self.disk(), self.with_bias("0.25 m/s"))

    def test_an_untouched_draft_follows_its_file(self):
        self.assemble(TEXT)
        self.change_outside(self.with_bias("4 m/s"))
        self.await_text(self.with_bias("4 m/s"))
        self.assertEqual((self.page.root("touched"), self.page.root("outside")), ("no", "no"))

    def test_a_touched_draft_asks_and_the_draft_is_kept(self):
        self.ask_about()
        self.page.click(self.page.button("Keep the draft"))
        self.page.await_root("outside", "no")
        self.await_text(self.with_bias("3 m/s"))
        self.save()
        self.assertEqual(self.disk(), self.with_bias("3 m/s"))

    def test_a_touched_draft_asks_and_the_file_is_taken(self):
        self.ask_about()
        self.page.click(self.page.button("Take FILE"))
        self.page.await_root("outside", "no")
        self.await_text(self.with_bias("4 m/s"))
        self.undo()
        self.await_text(self.with_bias("3 m/s"))

    def ask_about(self):
        self.assemble(TEXT)
        self.set_bias("3 m/s")
        self.change_outside(self.with_bias("4 m/s"))
        self.page.await_root("outside", "yes")
        self.page.await_root("lamp-file", "outside")
        self.page.await_one("[data-outside-banner]")
        self.page.click(self.page.button("Save FILE"))
        self.assertEqual(self.disk(), self.with_bias("4 m/s"))
        self.await_text(self.with_bias("3 m/s"))

    def test_a_file_that_cannot_be_written_is_said_and_the_draft_stays(self):
        self.assemble(TEXT)
        self.set_bias("3 m/s")
        self.file.unlink()
        self.file.mkdir()
        self.page.click(self.page.button("Save FILE"))
        self.page.await_text(".message.error, .banner.error", self.file.name)
        self.assertEqual(self.text(), self.with_bias("3 m/s"))


class Deaths(DraftTest):
    def kept(self, words):
        """True if a draft in the state folder has the words. A file that is still written has another end."""
        return any(words in path.read_text() for path in (self.place / "state" / "chimera" / "drafts").glob("*")
                   if re.fullmatch(r".*-\w+", path.name))

    def test_a_reload_keeps_the_draft_and_the_saved_draft_is_removed(self):
        self.assemble(TEXT)
        self.set_bias("3 m/s")
        self.open_draft()
        self.await_text(self.with_bias("3 m/s"))
        self.page.await_root("touched", "yes")
        await_that(lambda: self.kept("3 m/s"), "the kept draft")
        self.save()
        await_that(lambda: not self.kept("3 m/s"), "the end of the kept draft")

    def test_a_killed_chimera_web_keeps_the_draft(self):
        self.assemble(TEXT)
        self.expected = ["WebSocket", "ERR_CONNECTION_REFUSED"]
        self.set_bias("3 m/s")
        await_that(lambda: self.kept("3 m/s"), "the kept draft")
        self.web_server.die()
        self.page.await_root("bench", "lost")
        self.page.await_text("aside", "no connection to chimera-web")
        self.begin_again()
        self.await_text(self.with_bias("3 m/s"))
        self.page.await_root("touched", "yes")
        self.assertEqual(self.disk(), TEXT)

    def test_a_kept_draft_asks_about_a_file_that_changed_in_between(self):
        self.assemble(TEXT)
        self.expected = ["WebSocket", "ERR_CONNECTION_REFUSED"]
        self.set_bias("3 m/s")
        await_that(lambda: self.kept("3 m/s"), "the kept draft")
        self.web_server.die()
        self.change_outside(self.with_bias("4 m/s"))
        self.begin_again()
        self.page.await_root("outside", "yes")
        self.await_text(self.with_bias("3 m/s"))

    def analyst(self):
        """The process of the analyst of this chimera-web."""
        pid = self.web_server.process.pid
        for child in pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split():
            if b"--analyst" in pathlib.Path(f"/proc/{child}/cmdline").read_bytes():
                return int(child)
        return None

    def test_a_killed_analyst_costs_one_edit_at_most(self):
        self.assemble(TEXT)
        self.set_bias("3 m/s")
        before = await_that(self.analyst, "the analyst")
        kill(before, str(self.runtime), signal.SIGSTOP)
        self.type_into(field("operator/bias"), "2 m/s")
        await_that(lambda: self.sent_edits() == 2, "the edit on its way")
        kill(before, str(self.runtime))
        self.page.await_that("document.querySelector('[aria-invalid=true]') || "
                             "document.getElementById('draft-text').value.includes('bias: 2 m/s')", "its end")
        self.page.press(Keys.ESCAPE)
        self.set_bias("1 m/s")
        self.assertEqual(self.text(), self.with_bias("1 m/s"))
        self.await_verdict("legal")
        self.assertNotEqual(self.analyst(), before)

    def sent_edits(self):
        self.read_logs()
        return len(self.frames.sent("/bench", "edit"))


class Windows(DraftTest):
    def test_a_second_window_follows_the_first_and_the_first_the_second(self):
        self.assemble(TEXT)
        first, second = self.another_tab()
        self.set_bias("3 m/s")
        self.go_to(first)
        self.await_text(self.with_bias("3 m/s"))
        self.set_bias("2 m/s")
        self.go_to(second)
        self.await_text(self.with_bias("2 m/s"))
        self.undo()
        self.await_text(self.with_bias("3 m/s"))

    def test_text_typed_over_an_older_draft_is_refused_and_stays(self):
        self.overtaken(lambda: self.type_text(self.with_bias("7 m/s")), ".text .fault")
        self.assertEqual(self.text(), self.with_bias("7 m/s"))
        self.page.click(self.page.button("Take the text of the draft"))
        self.await_text(self.with_bias("3 m/s"))

    def test_an_act_on_an_older_draft_is_refused_and_its_words_stay(self):
        self.overtaken(lambda: self.type_into(field("operator/bias"), "7 m/s"), "aside .fault")
        self.assertEqual(self.page.attribute(field("operator/bias"), "value"), "7 m/s")
        self.await_text(self.with_bias("3 m/s"))
        self.assertEqual(self.page.root("draft"), "2")

    def overtaken(self, act, place):
        """The act leaves the browser after another window has changed the draft."""
        self.assemble(TEXT)
        self.page.script(HOLD)
        act()
        await_that(lambda: self.page.script("return window.held.length"), "the act")
        first, _ = self.another_tab()
        self.set_bias("3 m/s")
        self.go_to(first)
        self.page.script("window.release()")
        self.page.await_text(place, "changed in another window")


class Beside(DraftTest):
    """The machine that runs FILE."""

    def test_the_lamp_names_what_differs_and_a_restart_takes_it(self):
        machine = self.using(Machine(self.runtime))
        self.file = machine.file
        self.web_server = self.web(self.file)
        self.open_draft()
        self.page.await_root("lamp-machine", "same")
        self.set_bias("3 m/s")
        self.page.await_root("lamp-machine", "differs")
        self.page.await_text("[data-lamps]", "bias")
        self.page.await_none(self.page.button("Restart"))
        self.save()
        self.page.await_text(".banner.warning", "The machine runs an earlier FILE")
        self.page.click(self.page.button("Restart"))
        self.page.await_text(".question", "Every task goes OFF")
        self.page.click(".question .danger")
        self.addCleanup(self.end_started, machine.socket)
        self.page.await_root("lamp-machine", "same")
        self.assertEqual(Client(machine.socket).call("get", variables=["bias"])["values"]["bias"]["value"], 3)

    def test_what_is_started_goes_on_without_the_page(self):
        self.assemble(TEXT)
        socket = self.runtime / "chimera" / "plant.sock"
        self.addCleanup(self.end_started, socket)
        self.page.click(self.page.button("Start"))
        self.page.await_root("lamp-machine", "same")
        self.page.click('[data-mode-button="look"]')
        self.page.await_state("source", "ON")
        self.page.driver.get("about:blank")
        self.web_server.__exit__()
        self.assertEqual(Client(socket).call("hello")["subsystem"], "plant")

    def end_started(self, socket):
        """Ends what the page started, if it runs."""
        try:
            Client(socket).call("end", code=0)
        except OSError:
            return
        await_that(lambda: not socket.exists(), "the end of what was started")

    def test_a_start_that_fails_shows_its_words(self):
        self.assemble(re.sub(r"component: t_source", "component: t_no_source", TEXT))
        self.page.click(self.page.button("Start"))
        self.page.await_text("[data-output]", "t_no_source")

    def test_a_page_without_file_has_no_draft(self):
        self.page.open(self.using(Web(self.runtime)).link)
        self.page.await_root("bench", "open")
        self.assertEqual(self.page.all("[data-mode-button]"), [])


if __name__ == "__main__":
    sys.exit(main())
