# SPDX-License-Identifier: Apache-2.0
"""A model of docs/formats/sequence.md, written from its text. One call of job() is one job of the task `sequence`."""
import dataclasses
import operator

PAUSED, SWITCHES, RUNS, WAITS, INTERRUPTED, FAILED, DONE, BEGINS = range(8)
RELATIONS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq,
             "!=": operator.ne}
AGAIN = 1_000_000_000  # ns: a refused or aborted switch is requested again each second
WITHIN = 10_000_000_000  # ns: for a switch whose step says nothing


@dataclasses.dataclass
class Step:
    """A step of the text. Times are in ns; `until` is (variable, relation, level); `otherwise` is an index."""
    configuration: str
    until: tuple = None
    wait: int = None
    within: int = WITHIN
    otherwise: int = None
    confirm: bool = False
    reentry: bool = False


@dataclasses.dataclass
class Seen:
    """What a job sees. `go`: newly set, or None; `read(variable)`: time and value of its last publication, or None."""
    now: int
    in_force: str
    flag: bool
    go: int
    read: callable

    @property
    def is_calm(self):
        return bool(self.in_force) and not self.flag


class Model:
    def __init__(self, steps, repeats):
        self.steps, self.repeats = steps, repeats
        self.state, self.at = BEGINS, None
        self.first = None      # the step to begin with
        self.calm = None       # the last configuration that was in force without the flag
        self.requested = set()  # configurations that were requested since a step began
        self.since = self.asked = None
        self.was_calm = self.is_disturbed = self.is_lost = False

    @property
    def step(self):
        return self.steps[self.at]

    def turned_on(self, now):
        """`chimera on sequence`: the step waits anew."""
        self.since, self.asked = now, None

    def shown(self, now):
        """The outputs: step, state, failed, and the time waited in s."""
        waited = now - self.since if self.state in (RUNS, SWITCHES) else 0
        return [0 if self.at is None else self.at + 1, self.state, self.state == FAILED, waited / 1e9]

    def job(self, seen):
        """Returns the configuration that the job requests, or None."""
        self.obey(seen)
        self.notice(seen)
        request = self.go_on(seen)
        if seen.is_calm:
            self.calm = seen.in_force
        return request

    def enter(self, at, seen, by_person=False):
        self.at, self.since, self.asked = at, seen.now, None
        self.was_calm, self.is_disturbed, self.is_lost = seen.is_calm, False, False
        self.calm = seen.in_force if seen.is_calm else self.calm
        self.state = WAITS if self.step.confirm and not by_person else SWITCHES

    def obey(self, seen):
        if seen.go == 0:
            self.state = PAUSED
        elif seen.go is not None and seen.go <= len(self.steps):
            if self.state == BEGINS:
                self.first = seen.go - 1
            else:
                self.enter(seen.go - 1, seen, by_person=True)
        if self.state == BEGINS and self.first is not None and seen.is_calm:
            self.enter(self.first, seen)

    def is_of_person(self, seen):
        return seen.in_force not in {self.step.configuration, self.calm} | self.requested

    def notice(self, seen):
        """Persons who switch otherwise, errors and emergency stops."""
        is_here = seen.in_force == self.step.configuration if self.at is not None else False
        if self.state == RUNS and not seen.is_calm:
            self.state, self.is_lost = INTERRUPTED, not seen.in_force
            return
        if self.state == RUNS and not is_here or self.state == WAITS and seen.is_calm and self.is_of_person(seen):
            self.state = PAUSED
        if self.state == SWITCHES:
            self.is_disturbed |= self.was_calm and not seen.is_calm
            self.is_lost |= self.was_calm and not seen.in_force
            self.was_calm |= seen.is_calm
            if seen.is_calm and not is_here and self.is_of_person(seen):
                self.state = PAUSED
            elif seen.is_calm and not is_here and self.is_disturbed:
                self.state = INTERRUPTED
        if self.state == INTERRUPTED:
            self.is_lost |= not seen.in_force
            if seen.is_calm:
                self.enter_again(seen)

    def enter_again(self, seen):
        here = [i for i, step in enumerate(self.steps) if step.reentry and step.configuration == seen.in_force]
        if self.at in here:
            here = [self.at]
        was_switched = not self.is_lost and seen.in_force != self.calm
        if len(here) == 1 and not was_switched:
            self.enter(here[0], seen)
        else:
            self.state = PAUSED

    def holds(self, seen):
        variable, relation, level = self.step.until
        published = seen.read(variable)
        return published is not None and published[0] >= self.since and RELATIONS[relation](published[1], level)

    def go_on(self, seen):
        if self.state == RUNS:
            waited = seen.now - self.since
            if self.holds(seen) if self.step.until else waited >= self.step.wait:
                self.follow(seen)
            elif self.step.until and waited >= self.step.within:
                self.fail(seen)
        if self.state != SWITCHES:
            return None
        if seen.is_calm and seen.in_force == self.step.configuration:
            self.since, self.requested, self.is_lost = seen.now, set(), False
            self.state = RUNS if self.step.until or self.step.wait else DONE
            return None
        if not self.is_disturbed and seen.now - self.since >= self.step.within:
            self.fail(seen)
        is_due = self.asked is None or seen.now - self.asked >= AGAIN
        if self.state != SWITCHES or self.is_disturbed or seen.in_force == self.step.configuration or not is_due:
            return None
        self.asked = seen.now
        self.requested.add(self.step.configuration)
        return self.step.configuration

    def follow(self, seen):
        if self.at + 1 < len(self.steps) or self.repeats:
            self.enter((self.at + 1) % len(self.steps), seen)
        else:
            self.state = DONE

    def fail(self, seen):
        if self.step.otherwise is None or not seen.is_calm:
            self.state = FAILED
        else:
            self.enter(self.step.otherwise, seen)
