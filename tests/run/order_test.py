# SPDX-License-Identifier: Apache-2.0
"""Jobs of one instant run in the order of the data: every order of the tasks in the text gives the same bytes, under
every policy and in both executors. What the source writes reaches the last task in the same cycle."""
import itertools
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "processes"))
from system import CHIMERA, HANG  # noqa: E402

# Preemptive llf and muf-laxity compare running jobs again and promise no order.
RTPUS = [(policy, "executive") for policy in ("rm", "edf", "muf", "llf", "muf-laxity")]
RTPUS += [(policy, "preemptive") for policy in ("rm", "edf", "muf")]

# A chain, and a loop that is cut at `back`.
TASKS = {
    "src": "component: signal_generator, alias: {y: sN}, constants: {wave: sawtooth, amplitude: 1 rad, "
           "frequency: 5 Hz}",
    "add": "component: sum, alias: {in: [sN, backN], out: aN}, constants: {weight: [1, 0.5]}",
    "gain": "component: gain, alias: {x: aN, y: bN}, constants: {k: 1}",
    "last": "component: gain, alias: {x: bN, y: cN}, constants: {k: 1}",
    "fb": "component: gain, alias: {x: cN, y: backN}, constants: {k: 0.5}, initial: {y: 0 rad}",
    "log": "component: csv_log, alias: {in: [sN, aN, cN, backN], rows: rowsN, lost: lostN, disk_error: errorN}, "
           "resources: {file: N.csv}",
}


def description(names, rtpus=tuple(RTPUS)):
    text = "subsystem: chain\nrtpus:\n"
    for number, (policy, executor) in enumerate(rtpus):
        text += f"  u{number}: {{cpu: {number}, policy: {policy}, executor: {executor}}}\n"
    text += "tasks:\n"
    for name in names:
        for number in range(len(rtpus)):
            text += (f"  {name}{number}: {{rtpu: u{number}, rate: 1 kHz, budget: 10 us, "
                     f"{TASKS[name].replace('N', str(number))}}}\n")
    return text


class Order(unittest.TestCase):
    def rows(self, names, *words, rtpus=tuple(RTPUS)):
        """The rows of the log of each rtpu."""
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            (place / "chain.yaml").write_text(description(names, rtpus))
            done = subprocess.run([CHIMERA, "run", "chain.yaml", *words], cwd=folder, text=True, capture_output=True,
                                  env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0", "XDG_RUNTIME_DIR": folder},
                                  stdin=subprocess.DEVNULL, timeout=HANG)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            return [(place / f"{number}.csv").read_text().splitlines()[1:] for number in range(len(rtpus))]

    def test_every_order_of_the_text_gives_the_same_bytes(self):
        wanted = None
        for turn, names in enumerate(itertools.permutations(("src", "add", "gain", "last", "fb"))):
            at = turn % (len(names) + 1)
            names = (*names[:at], "log", *names[at:])
            found = self.rows(names, "--virtual", "--for", "30 ms")
            for (policy, executor), rows in zip(RTPUS, found):
                wanted = wanted or rows
                self.assertEqual(rows, wanted, f"{policy}, {executor}: {names}")
        for before, row in itertools.pairwise([[float(x) for x in line.split(",")] for line in wanted]):
            self.assertAlmostEqual(row[2], row[1] + 0.5 * before[4], msg="one period late at the cut")
            self.assertEqual(row[3], row[2], "in the same cycle")

    def test_a_chain_written_backwards_is_not_late_in_real_time(self):
        found = self.rows(("log", "fb", "last", "gain", "add", "src"), "--priority", "0", "--for", "300 ms",
                          rtpus=(("edf", "executive"),))
        rows = [line.split(",") for line in found[0]]
        self.assertGreater(len(rows), 10)
        for row in rows:
            self.assertEqual(row[3], row[2], "in the same cycle, also after a miss")


if __name__ == "__main__":
    unittest.main(verbosity=1)
