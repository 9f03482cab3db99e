# SPDX-License-Identifier: Apache-2.0
"""How far the switch that is under way has come, as the processes see it, for the campaigns that kill in a switch."""
import mmap
import os
import pathlib

from system import await_that


class PlanPage:
    """The words of the switch on the decision page, read while the rtpus write them. Requires: one switch was made, and
    committed."""

    def __init__(self, system):
        self.words = self.at = None
        keeper = pathlib.Path(f"/proc/{system.pids()['keeper']}/fd")
        for link in keeper.iterdir():
            if os.readlink(link).startswith("/memfd:chimera-decision"):
                held = os.open(link, os.O_RDONLY)
                self.words = mmap.mmap(held, os.fstat(held).st_size, prot=mmap.PROT_READ)
                os.close(held)
                break
        # That switch has a small number, not always 1: one before it may have been aborted.
        self.at = next(at for at in range(0, len(self.words) - 128, 64)
                       if self.word(at) >> 16 & 3 == 3 and 0 < self.word(at) & 0xffff < 16
                       and self.word(at + 64) & 0xffff == self.word(at) & 0xffff)

    def word(self, at):
        return int.from_bytes(self.words[at:at + 8], "little")

    def plan(self):
        """(number of the plan, its phase)"""
        word = self.word(self.at)
        return word & 0xffff, ("aborted", "prepared", "proposed", "committed")[word >> 16 & 3]

    def step(self):
        """Of a slow switch: the number of steps that are done, or "back, N left"."""
        turn = self.word(self.at + 64) >> 16 & 0xffff
        return f"back, {turn & 0x7fff} left" if turn & 0x8000 else turn

    def await_step(self, last, step):
        """Until a slow plan after `last` has done that many steps, or is over."""
        def is_there():
            number, phase = self.plan()
            return number != last and (phase in ("committed", "aborted") or self.step() == step)
        await_that(is_there, f"step {step}", pause=0)

    def await_phase(self, last, phase):
        """Until a plan after `last` has come that far, or further."""
        order = ("prepared", "proposed", "committed", "aborted")

        def is_there():
            number, now = self.plan()
            return number != last and order.index(now) >= order.index(phase)
        await_that(is_there, phase, pause=0)
