# SPDX-License-Identifier: Apache-2.0
"""The page and the services of the machine, which have their sockets in /run/chimera. The test runs with a /run of its
own: it starts itself again in a mount namespace, as root or as root of a user namespace. Exit 77: the system allows
neither."""
import os
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "harness"))

from case import PageTest, main  # noqa: E402
from door import Door  # noqa: E402
from machine import Machine  # noqa: E402
from page import Keys  # noqa: E402
from subject import Subject  # noqa: E402
from system import await_that  # noqa: E402

SERVICES = pathlib.Path("/run")
APART = ["unshare", "--mount", *(() if os.geteuid() == 0 else ("--user", "--map-root-user")), "sh", "-c",
         'mount -t tmpfs -o mode=755 none /run && mkdir -m 755 /run/chimera && exec "$@"', "sh"]
SHOWN = "return [...document.querySelectorAll(\"select[aria-label='Subsystem'] option\")].map(e => e.textContent)"


class ServiceTest(PageTest):
    def test_a_service_is_shown_and_obeys(self):
        machine = self.look_at(Machine(SERVICES))
        self.assertEqual(self.page.script(SHOWN), ["plant (service)"])
        self.page.await_state("strong", "ON")
        self.page.type_over("#set-bias", "0.75", Keys.ENTER)
        await_that(lambda: machine.value("bias") == 0.75, "the new value")

    def test_a_subsystem_of_the_user_hides_a_service_of_its_name(self):
        service = self.using(Door(SERVICES, Subject.chain("plant")))
        self.using(Door(SERVICES, Subject.chain("other")))
        own = self.look_at(Door(self.runtime, Subject.chain("plant")), "plant")
        self.assertEqual(self.page.script(SHOWN), ["plant", "other (service)"])
        self.page.type_over("#set-wish", "2.5", Keys.ENTER)
        own.await_asked("set", 1)
        self.assertEqual(service.asked("set"), [])


if __name__ == "__main__":
    if os.environ.get("CHIMERA_OWN_RUN") is None:
        if subprocess.run([*APART, "true"], capture_output=True, check=False).returncode != 0:
            print("the system allows no mount for this test alone")
            sys.exit(77)
        os.execvpe(APART[0], [*APART, sys.executable, *sys.argv], {**os.environ, "CHIMERA_OWN_RUN": "1"})
    sys.exit(main())
