# SPDX-License-Identifier: Apache-2.0
"""A person records a machine, tunes it, and looks who had the processor."""
import pathlib
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

from access import faint, unnamed  # noqa: E402
from case import PageTest, main  # noqa: E402
from door import Door  # noqa: E402
from machine import PLANT, Machine  # noqa: E402
from page import Keys  # noqa: E402
from system import CHIMERA, await_that  # noqa: E402

MS = 1_000_000


class ScopeTest(PageTest):
    def record(self, *channels, mode="single", **fields):
        self.page.press("s")
        self.page.click(f"#scope-mode option[value={mode}]")
        for name in channels:
            self.page.one("#scope-channels").send_keys(name, Keys.ENTER)
            self.page.await_one(self.page.button(f"Take {name} away"))
        for name, words in fields.items():
            field = self.page.one(f"#scope-{name}")
            field.send_keys(Keys.CONTROL + "a")
            field.send_keys(words)
        self.page.click(self.page.button("Record"))

    def answers(self, word):
        """Results of trials that ended so far, whose output has this word."""
        self.read_logs()
        return [line["result"] for socket in self.frames.of("/bench") for line in socket.received
                if word in ((line.get("result") or {}).get("output") or {})]

    def results(self):
        return self.answers("rows")

    def recordings(self, least):
        self.page.await_that(f"Number(document.querySelector('[data-recordings]').dataset.recordings) >= {least}",
                             f"{least} recordings")

    def test_a_triggered_recording_is_drawn_with_its_channels(self):
        machine = self.look_at(Machine(self.runtime))
        self.record("torque", "speed", trigger="bias > 1 m/s", pre="50 ms", **{"for": "200 ms"})
        self.page.await_one("[data-scope=on]")
        values = [2, 0.5]
        while self.page.all("[data-scope=on]"):
            machine.call("set", values={"bias": values[0]})
            values.reverse()
        self.recordings(1)
        [result] = self.results()
        self.assertEqual(result["csv"].splitlines()[0], "t(s),torque(N.m),speed(m/s),lost")
        drawn = "return [...document.querySelectorAll('[data-channel]')].map(e => e.dataset.channel)"
        self.assertEqual(self.page.script(drawn), ["torque", "speed"])
        self.page.await_one(self.page.button("Save plant.csv"))
        self.page.await_one(self.page.button("Save plant.svg"))
        self.assertEqual(unnamed(self.browser), [])
        self.assertEqual(faint(self.browser), [])

    def test_a_wrong_trigger_is_refused_in_words(self):
        self.look_at(Machine(self.runtime))
        self.record("speed", trigger="speed")
        self.page.await_text("[data-scope-message]", "expected VARIABLE, one of")
        self.page.await_one("[data-scope=off]")

    def test_auto_records_without_a_trigger_until_it_is_stopped(self):
        self.look_at(Machine(self.runtime))
        self.record("speed", mode="auto", trigger="speed < 0 m/s", wait="100 ms", **{"for": "100 ms"})
        self.recordings(2)
        self.page.click(self.page.button("Stop recording"))
        self.page.await_one("[data-scope=off]")

    def test_normal_records_after_each_trigger_and_only_then(self):
        machine = self.look_at(Machine(self.runtime))
        machine.call("set", values={"bias": 0.5})
        self.record("speed", mode="normal", trigger="bias > 1 m/s", wait="100 ms", **{"for": "100 ms"})
        await_that(lambda: self.answers("error"), "a wait without a trigger")
        self.assertEqual(self.page.attribute("[data-recordings]", "data-recordings"), "0")
        self.page.await_one("[data-scope=on]")
        values = [2, 0.5]
        while int(self.page.attribute("[data-recordings]", "data-recordings")) < 2:
            machine.call("set", values={"bias": values[0]})
            values.reverse()
        self.page.click(self.page.button("Stop recording"))
        self.page.await_one("[data-scope=off]")
        self.assertTrue(all(result["output"]["rows"] for result in self.results()))

    def saved(self, name):
        """The file that the button saves."""
        self.page.click(self.page.button(f"Save {name}"))
        file = self.place / "saved" / name
        return await_that(lambda: file.exists() and file.read_bytes(), name)  # it is empty at first

    def test_saved_files_are_those_of_the_command(self):
        """Both wait for the same instant of a ramp: 1 m/s more each second."""
        machine = self.look_at(Machine(self.runtime))
        self.browser.command("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(self.place / "saved"))
        for ahead in (4, 10, 30):  # s, until both are ready
            words = {"trigger": f"speed > {machine.value('speed') + ahead:.2f} m/s", "pre": "150 ms",
                     "for": "300 ms", "wait": f"{ahead + 2} s"}
            options = [word for name, value in words.items() for word in (f"--{name}", value)]
            with subprocess.Popen([CHIMERA, "scope", "torque", "speed", *options, "--subsystem", "plant",
                                   "--csv", "command.csv", "--svg", "command.svg"], cwd=self.place,
                                  env=machine.environment, stderr=subprocess.DEVNULL) as command:
                self.record(*(() if self.page.all("[data-scope-message]") else ("torque", "speed")), **words)
                self.page.await_one("[data-scope=on]")
                await_that(lambda: self.page.all("[data-scope=off]"), "the end of the recording")
            if command.returncode == 0 and not self.page.all("[data-scope-message]"):
                break
        self.assertEqual(self.saved("plant.csv"), (self.place / "command.csv").read_bytes())
        self.assertEqual(self.saved("plant.svg"), (self.place / "command.svg").read_bytes())

    def test_tuned_values_go_into_the_draft(self):
        machine = self.using(Machine(self.runtime))
        self.page.open(self.web(machine.file).link)
        self.page.await_open()
        self.page.type_over("#set-bias", "0.75", Keys.ENTER)
        self.page.await_that("document.getElementById('set-bias').value === '0.75 m/s'", "the new value")
        self.page.click(self.page.button("Put into the draft"))
        self.page.await_text("[data-message]", "the present values of bias")
        self.page.await_root("draft", "2")
        self.page.click(self.page.button("Put into the draft"))
        self.page.await_text("[data-message]", "has these values already")
        self.page.click("[data-mode-button=assemble]")
        self.assertEqual(self.page.attribute("#draft-text", "value"),
                         PLANT.read_text().replace("bias: 0.5 m/s", "bias: 0.75 m/s"))


class TimelineTest(PageTest):
    def open(self):
        self.door = self.look_at(Door(self.runtime))
        self.page.click("#tab-timeline")
        self.door.await_asked("subscribe", 4)
        return self.door

    def test_a_miss_names_its_culprit(self):
        door, now = self.open(), time.monotonic_ns()
        self.assertIn({"to": "tap", "since": 0}, door.asked("subscribe"))
        door.tap([now, "release", "task1", 7, 5 * MS], [now + MS, "run", "task0", 2, 6 * MS],
                 [now + 7 * MS, "run", "task1", 2, MS], [now + 8 * MS, "miss", "task1", 7, 3 * MS])
        self.page.await_text("table[aria-label^='Missed deadlines']", "task0 6ms, task1 itself 1ms")
        self.assertEqual(self.page.attribute("canvas", "aria-label"),
                         "Timeline of 2 tasks; the misses stand in the table below")

    def test_a_flood_shows_the_last_second_and_a_press_pauses(self):
        door, now = self.open(), time.monotonic_ns()
        for part in range(21):
            door.tap(*[[now + part * 1_000_000 + i * 1000, "run", "task0", 2, 500] for i in range(1000)], lost=part)
        self.page.await_one("[data-timeline='1 s']")
        self.page.await_text(".timeline", "the last second only")
        self.page.await_text(".timeline", "210 records are lost")
        self.page.click("canvas")
        self.page.await_one(self.page.button("Go on"))
        self.page.press("f")
        self.assertEqual(unnamed(self.browser), [])


if __name__ == "__main__":
    sys.exit(main())
