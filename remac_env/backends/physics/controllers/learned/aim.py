"""What a subtask is about, in numbers: where the hand is wanted, how the target is turned, and how far it has come.

An aim is made when a subtask begins, `update` is called once a control period, and all is told as the robot senses it,
in the frame of its stand: what is right at one wall is right at every wall.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from remac_env.backends.physics.controllers.base import Proprioception, Sensing
from remac_env.backends.physics.controllers.learned.stand import Stand
from remac_env.robots.rotation import Array

_EMPTY = 0.002  # m between fingers that hold nothing; the thinnest wall that they hold is 5 mm
_SQUEEZED = 0.001  # m by which fingers are commanded closer than they come, where something is between them
CLEAR = 0.12
"""m between the hand and what it has let go of, from which on there is room to fold the arm."""


@dataclass(frozen=True)
class Target:
    """What is known of a target. Lengths m, angles rad.

    at: where the hand is wanted (3,). yaw: about the vertical. size: half extents (3,) of an object, or the
    handle's place on a panel. grasp: how an object is grasped: height, width, lean, and 1 where from any side. joint,
    goal: where a joint stands and is to stand. side: 1 for a panel hinged on the left, -1 on the right. worked: 1 once
    a button has been pressed by this subtask.
    """

    at: Array
    yaw: float = 0.0
    size: tuple[float, float, float] = (0.0, 0.0, 0.0)
    grasp: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    joint: float = 0.0
    goal: float = 0.0
    side: float = 0.0
    worked: float = 0.0


class Aim(ABC):
    """Of one subtask of one robot. ``stand``: the frame in which everything is expressed."""

    by_hand = True
    """Whether the hand has to come to `target().at`."""

    patience = 3
    """Chunks of commands on end in which a robot stands still before it counts as at rest."""

    def __init__(self, sensing: Sensing, stand: Stand) -> None:
        self._sensing, self.stand = sensing, stand

    @abstractmethod
    def target(self) -> Target:
        """What is seen of it now."""

    @abstractmethod
    def done(self) -> float:
        """How much of the subtask is done, 0..1, apart from bringing the hand there."""

    def update(self) -> None:
        """Take the last control period into account."""
        return

    def achieved(self) -> bool:
        """Whether it is seen that what was to be done is done."""
        return self.done() >= 1.0

    def ahead(self) -> Array:
        """What is seen of a drive's way; nothing of other skills, which go nowhere."""
        return np.zeros(0)

    def missed(self) -> bool:
        """Whether a robot at rest sees that it is not done, and that it can be tried once more."""
        return False

    def over(self) -> bool:
        """Whether nothing is left to do but to go home: it is done, and the hand has let go and is clear of it."""
        if not self.achieved() or feels(self._sensing.body):
            return False
        hand = self.stand.point(self._sensing.body.grip.position)
        return float(np.linalg.norm(self.target().at - hand)) > CLEAR


def feels(body: Proprioception) -> bool:
    """Whether a hand feels something between its fingers."""
    return body.opening > _EMPTY and body.commanded_opening < 0.5 * body.opening - _SQUEEZED
