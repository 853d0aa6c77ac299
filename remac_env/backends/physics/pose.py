"""Poses that say in which frame they are expressed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from remac_env.kitchen.frame import WORLD, Frame
from remac_env.robots.rotation import Array


@dataclass(frozen=True, eq=False)
class Pose:
    """Where something is: ``position`` (3,), m, and ``rotation`` (3, 3), both expressed in ``frame``."""

    position: Array
    rotation: Array
    frame: Frame = WORLD

    def seen_from(self, frame: Frame) -> Pose:
        """The same pose expressed in another frame; from the frame of the room to the last bit."""
        room = self.in_room()
        x, y = frame.local(float(room.position[0]), float(room.position[1]))
        return Pose(np.array([x, y, room.position[2]]), frame.rotation.T @ room.rotation, frame)

    def in_room(self) -> Pose:
        """The same pose expressed in the frame of the room."""
        if self.frame is WORLD:
            return self
        x, y = self.frame.point(float(self.position[0]), float(self.position[1]))
        return Pose(np.array([x, y, self.position[2]]), self.frame.rotation @ self.rotation)
