"""Carries out a subtask by a network: observe, take the next few commands, observe again."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from remac_env.backends.physics.controllers.base import Command, Sensing
from remac_env.backends.physics.controllers.learned.aims import aim_of
from remac_env.backends.physics.controllers.learned.seen import observe
from remac_env.backends.physics.controllers.learned.weights import Weights, bag
from remac_env.robots import bodies
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import Subtask

_STANDARD = bodies.get()
LONGEST = 700  # control periods, 35 s: three times as long as scripted skills take
_STILL = 0.02  # rad or m that commands change at most while the robot stands still
_RESTS = 3  # chunks on end in which it stands still and then has ended


class Learned:
    """A learned skill as a controller. It ends when it is seen to be over, when it comes to rest, or after LONGEST."""

    def __init__(self, weights: Weights) -> None:
        self._weights = weights

    def covers(self, subtask: Subtask) -> bool:
        """Whether its demonstrations were about this target; other subtasks stay scripted."""
        targets = self._weights.about.targets
        return not targets or subtask.target in targets

    def run(self, subtask: Subtask, sensing: Sensing) -> Generator[Command, None, Outcome]:
        """See :class:`remac_env.backends.physics.controllers.base.Controller`.

        Success here means that it has ended by itself; whether anything was achieved is read from the kitchen.
        """
        about, network = self._weights.about, self._weights.network
        if subtask.skill not in about.known:
            return failure("invalid", f"these weights are for {', '.join(about.known)!r}")
        aim, rests, words = aim_of(subtask, sensing), 0, bag(about.words, subtask.text)
        for _ in range(LONGEST // about.execute):
            shown = np.concatenate([observe(sensing, aim, subtask.row), words])
            chunk = network.commands(shown)[: about.execute].astype(float)
            if not np.isfinite(chunk).all():
                return failure("invalid", "the network says what is not finite")
            start, before = sensing.body.q, sensing.body.commanded
            for change in chunk:
                q = aim.stand.moved(start, change[:-1])
                q[3:] = np.clip(q[3:], _STANDARD.lower[3:], _STANDARD.upper[3:])
                yield Command(q, float(np.clip(change[-1], 0.0, _STANDARD.finger_travel)))
                aim.update()
            if aim.over():
                return Outcome("success")
            still = float(np.abs(sensing.body.commanded - before).max()) < _STILL
            rests = rests + 1 if still else 0
            if rests >= _RESTS:
                return Outcome("success")
        return failure("timeout", f"the policy did not come to rest within {LONGEST} control periods")
