# SPDX-License-Identifier: Apache-2.0
"""A replay fails without inputs, and at an input that breaks the target. usage: replay_corpus.py TARGET"""
import pathlib
import subprocess
import sys
import tempfile
import unittest


class ReplayCorpus(unittest.TestCase):
    def replay(self, inputs):
        """(exit code, standard output, standard error) for a folder with these inputs, {name: bytes}."""
        with tempfile.TemporaryDirectory() as folder:
            for name, content in inputs.items():
                (pathlib.Path(folder) / name).write_bytes(content)
            return self.run_program(folder)

    def run_program(self, *arguments):
        done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True)
        return done.returncode, done.stdout, done.stderr

    def test_replays_every_file_in_order(self):
        code, said, names = self.replay({"b": b"y", "a": b""})
        self.assertEqual((code, said), (0, "2 inputs replayed\n"))
        self.assertEqual([name[-2:] for name in names.splitlines()], ["/a", "/b"])

    def test_refuses_an_empty_folder(self):
        code, _, said = self.replay({})
        self.assertEqual(code, 1)
        self.assertIn("no inputs in ", said)

    def test_refuses_a_missing_folder(self):
        self.assertEqual(self.run_program("no/such/folder"), (1, "", "no inputs in no/such/folder\n"))

    def test_refuses_a_missing_argument(self):
        self.assertEqual(self.run_program()[0], 2)

    def test_names_the_input_that_breaks_the_target(self):
        code, _, said = self.replay({"a": b"y", "b": b"x", "c": b"y"})
        self.assertNotIn(code, (0, 1, 2))
        self.assertRegex(said, r"/b\nproperty broken: no input begins with x\n")


if __name__ == "__main__":
    PROGRAM = sys.argv.pop()
    unittest.main()
