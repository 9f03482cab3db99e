# SPDX-License-Identifier: Apache-2.0
"""Fault row 15: operators in conflict. Four of them ask for switches at random, at the same time. What was done, in the
order of its instants, is one history from configuration to configuration, and explains each answer, also the refusals.
The campaign `process_operators`."""
import random
import threading
import time
import unittest

from campaign import ROUNDS, SEED, begin, counted
from descriptions import SETS, SWITCH
from system import TOO_FAST, Client, Refused, System, await_that

OPERATORS = 4


class Operator(threading.Thread):
    """Asks ROUNDS times; `told` has (when it asked, when it was answered, for what, the answer or the refusal)."""

    def __init__(self, system, seed):
        super().__init__()
        self.system, self.random, self.told = system, random.Random(seed), []
        self.start()

    def run(self):
        client = Client(self.system.socket)
        for _ in range(ROUNDS):
            target = self.random.choice(("gentle", "quick", "wild"))
            time.sleep(self.random.random() * 0.02)
            answer = None
            while answer is None:
                asked = time.monotonic_ns()
                try:
                    answer = client.call("switch", configuration=target)
                except Refused as refused:
                    if refused.code == TOO_FAST:
                        time.sleep(refused.data["retry_ms"] / 1e3)
                    else:
                        answer = refused
            self.told.append((asked, time.monotonic_ns(), target, answer))
        client.close()


class Operators(unittest.TestCase):
    def test_row_15_what_was_done_explains_each_answer(self):
        begin()
        with System(SWITCH) as system:
            operators = [Operator(system, SEED + n) for n in range(OPERATORS)]
            for operator in operators:
                operator.join()
                self.assertEqual(len(operator.told), ROUNDS)
            await_that(lambda: system.call("receipts")["unfiled"] == 0, "the file")
            filed = {receipt["number"]: receipt for receipt in system.filed()}
            now = system.on()
        told = [one for operator in operators for one in operator.told]
        history = self.history(filed, now)
        for one in told:
            self.judge(filed, history, *one)
        numbers = sorted(filed)
        self.assertEqual(numbers, list(range(1, len(numbers) + 1)))
        counted("answers", len(told))

    def history(self, filed, now):
        """[(since when, configuration)], each from the one before."""
        history = [(0, "gentle")]
        done = [receipt for receipt in filed.values() if receipt["end"] == "done"]
        for receipt in sorted(done, key=lambda receipt: receipt["at_ns"]):
            self.assertEqual(receipt["from"], history[-1][1], receipt)
            history.append((receipt["at_ns"] + receipt["origin_ns"], receipt["to"]))
        self.assertEqual(now, SETS[history[-1][1]])
        return history

    def judge(self, filed, history, asked, answered, target, answer):
        if isinstance(answer, Refused):  # that of another operator was under way then
            self.assertEqual(answer.data["kind"], "under-way", answer)
            first = int(str(answer).split("switch ")[2].split()[0])
            self.assertTrue(self.overlaps(filed[first], asked, answered), (answer, filed[first]))
        elif answer["end"] == "nothing-to-do":
            until = [at for at, _ in history[1:]] + [answered + 10 ** 12]
            found = [name for (at, name), end in zip(history, until) if at <= answered and asked <= end]
            self.assertIn(target, found)
        else:
            self.assertEqual(answer, filed[answer["number"]])
            self.assertEqual(answer["to"], target)
            self.assertTrue(self.overlaps(answer, asked, answered), answer)
            if answer["end"] != "done" and answer["reason"] != "late":  # late: a machine that stalls
                self.assertEqual((answer["end"], answer["reason"], target), ("aborted", "step-too-large", "wild"))

    def overlaps(self, receipt, asked, answered):
        began = receipt["asked_ns"] + receipt["origin_ns"]
        ended = receipt["ended_ns"] + receipt["origin_ns"] if receipt["ended_ns"] is not None else answered
        return began <= answered and asked <= ended + 10 ** 9  # it is under way until its receipt is made


if __name__ == "__main__":
    unittest.main()
