"""Carries out a subtask by a network: observe, take the next few commands, observe again."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from remac_env.backends.physics.controllers.base import Command, Proprioception, Sensing
from remac_env.backends.physics.controllers.learned.aim import Aim, feels
from remac_env.backends.physics.controllers.learned.aims import aim_of
from remac_env.backends.physics.controllers.learned.cases import case_of
from remac_env.backends.physics.controllers.learned.hand import towards_hand
from remac_env.backends.physics.controllers.learned.network import commanded
from remac_env.backends.physics.controllers.learned.seen import observe
from remac_env.backends.physics.controllers.learned.weights import Weights, bag
from remac_env.kitchen.scene import build_scene
from remac_env.robots import bodies
from remac_env.robots.bodies import STANDARD
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import Subtask

LONGEST = 700  # control periods, 35 s: three times as long as scripted skills take
_DONE = 12  # chunks on end, 5 s, in which it is done with an empty hand, and then has ended however the hand moves
_ASTRAY = 0.2  # m from where it is to be put at which nothing is let go any more
_STILL = 0.02  # rad or m that commands change at most while the robot stands still


class Learned:
    """A learned skill as a controller. It ends when it is seen to be over, when it comes to rest, or after LONGEST.

    Args:
        weights: what was learnt. body: the name of the robot's body, which is the one that the weights are for.

    Attributes:
        tries: how often it may begin; again from the folded arm, where it has come to rest and sees that it missed.
    """

    tries = 2

    def __init__(self, weights: Weights, body: str = STANDARD) -> None:
        self._weights, self._name, self._body = weights, body, bodies.get(body)
        self._kinematics = self._body.kinematics()

    def covers(self, subtask: Subtask, sensing: Sensing) -> bool:
        """Whether its demonstrations were about this; other subtasks stay scripted."""
        layout, objects, robot = sensing.layout, sensing.objects, sensing.name
        rules = build_scene(layout, objects, (robot,))
        case = case_of(subtask, rules, layout, objects, sensing.told, robot)
        return self._weights.about.plays(subtask.skill, subtask.target, case)

    def run(self, subtask: Subtask, sensing: Sensing) -> Generator[Command, None, Outcome]:
        """See :class:`remac_env.backends.physics.controllers.base.Controller`.

        Success here means that it has ended by itself; whether anything was achieved is read from the kitchen.
        """
        about, network = self._weights.about, self._weights.network
        if subtask.skill not in about.known:
            return failure("invalid", f"these weights are for {', '.join(about.known)!r}")
        aim, words = aim_of(subtask, sensing, self._name), bag(about.words, subtask.text)
        body, fingers = self._body, commanded(self._body) - 1  # where their travel stands in a command
        arm, grip = sensing.body.commanded[3:], _Grip(sensing.body, body.finger_travel)
        rests = done = 0
        for _ in range(LONGEST // about.execute):
            shown = np.concatenate([observe(sensing, aim, subtask.row, self._name), words])
            chunk = network.commands(shown)[: about.execute].astype(float)
            if not np.isfinite(chunk).all():
                return failure("invalid", "the network says what is not finite")
            start, hand, before = sensing.body.q, sensing.body.grip.position, sensing.body.commanded
            for change in chunk:
                q = aim.stand.moved(start, change[:fingers])
                q[3:] = np.clip(q[3:], body.lower[3:], body.upper[3:])
                if not aim.by_hand:  # as it was told to be held when the drive began, whatever it carries
                    q[3:] = arm
                elif len(change) > commanded(body):
                    q = towards_hand(self._kinematics, aim.stand, q, hand, change)
                opening = grip.told(float(change[fingers])) if aim.by_hand else grip.began
                if grip.opened and subtask.row.puts and _astray(sensing, aim):
                    return failure("slipped", "it was about to let go far from where it was to put it")
                yield Command(q, opening)
                aim.update()
            done = done + 1 if aim.achieved() and not feels(sensing.body) else 0
            if aim.over() or done >= _DONE:
                return Outcome("success")
            still = float(np.abs(sensing.body.commanded - before).max()) < _STILL
            rests = rests + 1 if still else 0
            if rests >= aim.patience:
                return failure("slipped", "it came to rest with nothing done") if aim.missed() else Outcome("success")
        return failure("timeout", f"the policy did not come to rest within {LONGEST} control periods")


class _Grip:
    """What fingers are told. What they hold gently when a subtask begins they hold as they do until it is let go.

    A network says by how much they are open within a few millimetres, which is more than food is squeezed by; and where
    it opens them a little, it sees them open, and opens them further. So half of the way is for certain. What is held
    as hard as can be, as vessels are, bears that.

    Attributes:
        began: what they were told when the subtask began, m.
        opened: whether they are about to let go of it.
    """

    def __init__(self, body: Proprioception, travel: float) -> None:
        """Args: travel: m that each finger goes at most."""
        self.began, self._travel = body.commanded_opening, travel
        self._loose = 0.5 * (self.began + travel)
        self._holds, self.opened = feels(body) and self.began > 0.0, False

    def told(self, wanted: float) -> float:
        """What they are told where a network wants this, m."""
        self.opened = self._holds and wanted > self._loose
        self._holds &= not self.opened
        return self.began if self._holds else float(np.clip(wanted, 0.0, self._travel))


def _astray(sensing: Sensing, aim: Aim) -> bool:
    """Whether what the hand holds is far from where it is to be put."""
    held = sensing.told.robots[sensing.name].holding
    away = 0.0 if held is None else aim.target().at - aim.stand.point(sensing.pose(held).position)
    return float(np.linalg.norm(away)) > _ASTRAY
