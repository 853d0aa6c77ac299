"""The frame in which a policy sees everything: that of the place where the robot works."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.robots.rotation import Array


@dataclass(frozen=True, eq=False)
class Stand:
    """A frame: its origin on the floor where the robot works, x along the wall to the right, y towards the wall.

    origin: (3,), m. axes: (3, 3). yaw: the heading at the station, rad. All in the frame of the room.
    """

    origin: Array
    axes: Array
    yaw: float

    @staticmethod
    def at(layout: Layout, station: Station) -> Stand:
        """The stand at a station."""
        return Stand(np.array([station.x, station.y, 0.0]), layout.facing(station).rotation, station.yaw)

    def point(self, point: Array) -> Array:
        """A point (3,) of the room, in this frame."""
        return np.asarray(self.axes.T @ (point - self.origin))

    def turn(self, rotation: Array) -> Array:
        """A rotation (3, 3) of the room, in this frame."""
        return np.asarray(self.axes.T @ rotation)

    def joints(self, q: Array) -> Array:
        """A configuration (n,) of the room: base pose relative to the station, torso and arm as they are."""
        told = np.array(q, float)
        told[:2] = self.axes[:2, :2].T @ (told[:2] - self.origin[:2])
        told[2] = math.remainder(told[2] - self.yaw, math.tau)
        return told

    def moved(self, q: Array, change: Array) -> Array:
        """A configuration (n,) of the room after a change (n,) that is expressed in this frame."""
        told = q + change
        told[:2] = q[:2] + self.axes[:2, :2] @ change[:2]
        return told
