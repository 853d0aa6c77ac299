"""What a robot has started that takes its time by itself: it neither ends it nor waits any longer than for its end."""

from __future__ import annotations

from collections.abc import Mapping

from remac_env.rules.subtasks import Subtask

NEAR = 0.05
"""s by which two moments may be apart that are the same: a control period."""


class Started:
    """What one robot has turned on, and what has come of it.

    What began in the moment in which it had turned something on, or put something down since, goes on by its doing.
    Once the first of that is over the robot goes on: what follows, as burning does, is not waited for.

    Attributes:
        over: whether something that the robot started has come to its end since it turned something on last.
    """

    def __init__(self) -> None:
        self.over = False
        self._switch = ""
        self._moments: list[float] = []
        self._goes_on: set[str] = set()

    def ended(self, step: Subtask, now: float) -> None:
        """Note that the robot's step has succeeded."""
        if step.skill == "turn on":
            self.over, self._switch, self._moments, self._goes_on = False, step.target, [now], set()
        elif step.row.puts and self._switch:
            self._moments.append(now)

    def look(self, slow: Mapping[str, float], now: float) -> None:
        """Take in what goes on by itself, in words ending in what it is about -> for how long already, s."""
        self.over = self.over or not self._goes_on <= slow.keys()
        began = {what: now - gone for what, gone in slow.items()}
        self._goes_on = {what for what, at in began.items() if any(abs(at - own) < NEAR for own in self._moments)}

    def ends(self, step: Subtask) -> bool:
        """Whether a step would end what the robot has started: it turns it off, or takes away what it is about."""
        if self.over or not self._goes_on:
            return False
        taken = step.row.takes and any(what.endswith(f" {step.target}") for what in self._goes_on)
        return taken or (step.skill == "turn off" and step.target == self._switch)
