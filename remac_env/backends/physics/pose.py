"""Poses that say in which frame they are expressed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from remac_env.errors import RemacError
from remac_env.kitchen.frame import WORLD, Frame
from remac_env.robots.rotation import Array


class FrameError(RemacError, ValueError):
    """A pose expressed in another frame than the one in which it is used."""


@dataclass(frozen=True, eq=False)
class Pose:
    """Where something is: ``position`` (3,), m, and ``rotation`` (3, 3), both expressed in ``frame``."""

    position: Array
    rotation: Array
    frame: Frame

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
        return Pose(np.array([x, y, self.position[2]]), self.frame.rotation @ self.rotation, WORLD)

    def shifted(self, shift: ArrayLike) -> Pose:
        """The same, moved by so much (3,) in its frame, m."""
        return Pose(self.position + np.asarray(shift), self.rotation, self.frame)

    def back(self, distance: float) -> Pose:
        """The same, drawn back by so much (m) along its third axis, which is the way a hand reaches."""
        return Pose(self.position - self.rotation[:, 2] * distance, self.rotation, self.frame)

    def of(self, other: Pose) -> tuple[Array, Array]:
        """Where (3,), and how turned (3, 3), another pose is as this one sees it.

        Raises:
            FrameError: where the two are expressed in different frames.
        """
        other.expressed_in(self.frame)
        inward = self.rotation.T
        return inward @ (other.position - self.position), inward @ other.rotation

    def expressed_in(self, frame: Frame) -> None:
        """Refuse a pose of another frame.

        Raises:
            FrameError: naming both frames.
        """
        if self.frame is not frame and self.frame != frame:
            raise FrameError(f"a pose expressed in {self.frame} is used in {frame}; valid: pose.seen_from(frame)")
