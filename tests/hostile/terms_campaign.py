# SPDX-License-Identifier: Apache-2.0
"""SIGTERM of an rtpu at random instants around a switch, fast, slow and between two tasks with one device: one of the
two sets is ON afterwards, with the flag down, every rtpu lives, and the last receipt says which set it is.

usage: terms_campaign.py --build TREE --seconds N
"""
import collections
import random
import signal
import sys
import time

import campaigns

EARLIEST, LATEST = -1e-3, 45e-3  # of the signal, from the request on; s: the tasks run at 50 to 200 Hz


def in_one_rtpu(text):
    return text.replace("rtpu: second", "rtpu: first")


class Terms:
    def __init__(self, _):
        import descriptions as d
        import system
        self.system, self.ends = system, collections.Counter()
        self.variants = [(form(text), sets) for form in (str, d.preemptive, in_one_rtpu)
                         for text, sets in ((d.SWITCH, d.SETS), (d.SLOW_SWITCH, d.SLOW_SETS),
                                            (d.DEVICE_SWITCH, d.DEVICE_SETS))]

    def once(self, _):
        text, sets = random.choice(self.variants)
        try:
            with self.system.System(text) as subject:
                return self.terminate(subject, list(sets.items()))
        except Exception as fault:  # noqa: BLE001 - the campaign goes on
            return [repr(fault)]

    def terminate(self, subject, sets):
        (_, before), (after_name, after) = sets
        victim = random.choice(("first", "second"))
        pid, at, asked = subject.pids()[victim], random.uniform(EARLIEST, LATEST), None
        if at > 0:
            asked = subject.ask("switch", configuration=after_name)
        time.sleep(abs(at))
        assert subject.kill(pid, signal.SIGTERM)
        asked = asked or subject.ask("switch", configuration=after_name)
        asked.answer()

        def is_settled():
            status = subject.call("status")
            is_legal = subject.on() in (before, after) and not status["flag"]["up"]
            return is_legal and all(rtpu["alive"] and rtpu["pid"] != pid for rtpu in status["rtpus"])
        self.system.await_that(is_settled, subject.told)
        ends = [receipt["end"] for receipt in subject.call("receipts")["receipts"]]
        end = ends[-1] if ends else "none"
        self.ends[end] += 1
        if (subject.on() == after) == (end == "done"):
            return []
        return [f"{victim} at {at * 1e3:.2f} ms: receipts {ends}, ON {sorted(subject.on())}: {subject.told()}"]

    def figures(self):
        return {"ends": dict(self.ends)}


if __name__ == "__main__":
    sys.exit(campaigns.run("hostile_terms", __doc__, Terms))
