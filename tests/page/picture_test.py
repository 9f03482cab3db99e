# SPDX-License-Identifier: Apache-2.0
"""Takes the picture of README.md: the page on examples/01_puma_pid, with a chosen task and the cause of its output.
It goes to BUILD/page_pictures; with CHIMERA_WRITE_PICTURES=1 to docs/pictures (from a release build, with real-time
rights, so that it shows no warning)."""
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
    def test_the_whole_application_is_in_the_picture_of_the_readme(self):
        text = (SOURCE / "examples" / "01_puma_pid" / "puma_pid.yaml").read_text()
        arguments = ("--priority", "50") if IS_WRITTEN else ()
        self.look_at(Machine(self.runtime, text, "puma_pid", arguments))
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
        folder = SOURCE / "docs" / "pictures" if IS_WRITTEN else BUILD / "page_pictures"
        folder.mkdir(exist_ok=True)
        self.assertTrue(self.browser.driver.save_screenshot(str(folder / "page.png")))


if __name__ == "__main__":
    sys.exit(main())
