# SPDX-License-Identifier: Apache-2.0
"""Row 19: the n-th call for memory, a descriptor, a thread or a process fails. The start then says what failed and ends
with nothing left behind, or copes. CHIMERA_ROUNDS=0: every n that a program reaches, of every program, once and in each
of its processes; else that many, spread evenly."""
import collections
import itertools
import os
import re
import sys
import unittest

from system import BUILD, QUIET, TWO_RTPUS, System

ROUNDS = int(os.environ.get("CHIMERA_ROUNDS", "3"))
REASON = re.compile("Cannot allocate memory|Too many open files|Resource temporarily unavailable|"
                    "Device or resource busy|cannot be opened|cannot be read")
ABOUT = {"run": 48, "chimera-manager": 20, "chimera-rtpu": 24, "attend": 1}  # calls; spreads the bounded count only
MOST = 400  # calls of one program; more would be a leak of its own


class Exhaustion(unittest.TestCase):
    outcomes = collections.Counter()

    @classmethod
    def tearDownClass(cls):
        print(f"failed calls: {sum(cls.outcomes.values())} ({dict(cls.outcomes)})", file=sys.stderr)

    def attempt(self, program, n, once):
        """One start in which the n-th call fails. Returns the failed call, or None if there was no n-th."""
        shim = BUILD / "tests/processes/libfailing_calls.so"
        with System(TWO_RTPUS, ("--for", "0.1 s"), wait=False, environment={
                "LD_PRELOAD": str(shim), "CHIMERA_FAIL": f"{program} {n}{' once' if once else ''}",
                "CHIMERA_FAILED": "FAILED", "ASAN_OPTIONS": QUIET + ":verify_asan_link_order=0"}) as system:
            code, said = system.wait(), system.said()
            self.assertNotIn("did not end in time", said, f"{program} {n}")
            system.await_nothing_left()
            record = system.place / "FAILED"
            failed = sorted({line.split()[2] for line in record.read_text().splitlines()}) if record.exists() else None
            if failed:
                self.judge(failed, code, said, system)
            return failed

    def judge(self, failed, code, said, system):
        where = f"{failed}: exit {code}:\n{said}"
        self.assertFalse(system.socket.exists(), where)
        if code == 0:  # it does without the call, or repeats it
            for task in ("steady", "beside"):
                self.assertRegex(said, rf"(?m)^{task} +ON ", where)
            Exhaustion.outcomes["coped with"] += 1
            return
        self.assertEqual(code, 1, where)
        self.assertTrue(REASON.search(said) or any(f"{call} failed" in said for call in failed), "no reason: " + where)
        Exhaustion.outcomes["refused"] += 1

    def numbers(self, program, once):
        if ROUNDS == 0:
            return range(1, MOST)
        return sorted({(1 if once else 2) + i * ABOUT[program] // ROUNDS for i in range(ROUNDS)})

    def test_row_19_the_nth_failed_call_is_reported(self):
        for program, once in itertools.product(ABOUT, (False, True)):
            for n in self.numbers(program, once):
                with self.subTest(program=program, n=n, once=once):
                    if self.attempt(program, n, once) is None:
                        break


if __name__ == "__main__":
    unittest.main(verbosity=1)
