# SPDX-License-Identifier: Apache-2.0
"""A folder of descriptions, and `chimera` called in it."""
import os
import pathlib
import subprocess
import tempfile
import unittest

BUILD = pathlib.Path(os.environ["CHIMERA_BUILD"]).resolve()
CHIMERA = BUILD / "bin" / "chimera"

# y = k x, and a task that can be made to die.
TEXT = """subsystem: small
constants: {k: 2 N.m/rad}
tasks:
  gain: {rate: 100 Hz}
  crash: {component: t_crash, rate: 100 Hz, alias: {y: n}, constants: {how: nothing}, resources: {armed: /}}
operator: {x: 1 rad}
"""


class Place(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)
        self.write("small.yaml", TEXT)

    def write(self, name, text):
        path = self.path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def chimera(self, *words):
        done = subprocess.run([CHIMERA, *words], cwd=self.path, capture_output=True, text=True, timeout=300)
        return done.returncode, done.stdout, done.stderr
