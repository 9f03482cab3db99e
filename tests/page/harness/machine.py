# SPDX-License-Identifier: Apache-2.0
"""A real subsystem for a page: `chimera run` without real-time priority, in the XDG_RUNTIME_DIR of the test."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "processes"))

from system import System, await_that  # noqa: E402

PLANT = pathlib.Path(__file__).parent / "plant.yaml"


class Machine(System):
    """The subsystem of plant.yaml, or of `text`. Its acts and questions are those of System."""

    def __init__(self, runtime, text=None, name="plant", arguments=()):
        self.shared = runtime
        super().__init__(text or PLANT.read_text(), arguments, name=name)

    def start(self, arguments, popen):
        self.runtime = self.shared
        self.socket = self.runtime / "chimera" / self.socket.name
        self.environment["XDG_RUNTIME_DIR"] = str(self.runtime)
        super().start(arguments, popen)
