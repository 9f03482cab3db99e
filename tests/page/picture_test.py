# SPDX-License-Identifier: Apache-2.0
"""Takes pictures: for README.md the page on examples/01_puma_pid, with a chosen task and the cause of its output; for
docs/howto/operate.md the large view of examples/21_sequence, slower. They go to BUILD/page_pictures; with
CHIMERA_WRITE_PICTURES=1 to docs/pictures (from a release build, with real-time rights, so that no warning shows)."""
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

from case import PageTest, main  # noqa: E402
from machine import Machine  # noqa: E402
from web import BUILD  # noqa: E402

SOURCE = pathlib.Path(os.environ["CHIMERA_SOURCE"])
IS_WRITTEN = os.environ.get("CHIMERA_WRITE_PICTURES") == "1"


class Picture(PageTest):
    def run_lesson(self, folder, name, slower=lambda text: text):
        text = slower((SOURCE / "examples" / folder / f"{name}.yaml").read_text())
        return Machine(self.runtime, text, name, ("--priority", "50") if IS_WRITTEN else ())

    def take(self, name):
        folder = SOURCE / "docs" / "pictures" if IS_WRITTEN else BUILD / "page_pictures"
        folder.mkdir(exist_ok=True)
        self.assertTrue(self.browser.driver.save_screenshot(str(folder / name)))

    def test_the_large_view_of_a_sequence_is_in_the_picture_of_operating(self):
        self.using(self.run_lesson("21_sequence", "cell", lambda text: text.replace(
            "duration: 1.8 s", "duration: 18 s").replace("within: 3 s", "within: 20 s")))
        self.page.open(self.web().link + "&doc=steps")
        self.page.await_one("[data-present='1']")
        self.page.await_one(".large progress")
        self.page.await_one(".large [data-condition-value]:not(:empty)")
        self.take("steps.png")

    def test_the_whole_application_is_in_the_picture_of_the_readme(self):
        self.look_at(self.run_lesson("01_puma_pid", "puma_pid"))
        self.page.press("w")
        self.page.one("g.box[data-task=pid]").click()
        self.page.await_one("[data-why=tau]")
        self.page.await_one("text.value[data-value=q]:not(:empty)")
        self.assertEqual(set(self.page.states().values()), {"ON"})
        outside = self.page.script("""
          const place = document.querySelector('.canvas').getBoundingClientRect();
          return [...document.querySelectorAll('g.box')].filter((e) => {
            const box = e.getBoundingClientRect();
            return box.right > place.right || box.bottom > place.bottom; }).map((e) => e.dataset.task);""")
        self.assertEqual(outside, [], "tasks outside of the picture")
        self.take("page.png")


if __name__ == "__main__":
    sys.exit(main())
