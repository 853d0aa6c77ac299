"""The geometry of one door panel, as a hand that swings it needs it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from remac_env.kitchen.frame import Frame
from remac_env.robots.rotation import Array, about_z

_OFF_PALM = 0.007  # m that stay between a bar and the palm, along the hand from the bar's middle


@dataclass(frozen=True)
class DoorPanel:
    """A panel's geometry: hinge line, handle in the panel's frame; sign: 1 where it is hinged on the left, else -1.

    half, radius: of the bar, an upright rod, m. edge, faces, ends: of the panel, how far its free edge is from the
    hinge, and y of front and back and z of bottom and top in its own frame, m.
    """

    joint: str
    frame: Frame
    hinge: Array
    bar: Array
    half: float
    radius: float
    edge: float
    faces: tuple[float, float]
    ends: tuple[float, float]
    sign: float
    address: int
    geoms: tuple[int, ...]
    seen: float  # rad by which the wall seems to be turned

    def at(self, angle: float, higher: float = 0.0) -> Array:
        """Position of the handle's middle, or of a place so much higher on it (m)."""
        return self.hinge + self.turn(angle) @ self.bar + [0.0, 0.0, higher]

    def outward(self, angle: float) -> Array:
        """Horizontal direction (3,), of length 1, from the hinge to the handle."""
        way = (self.turn(angle) @ self.bar) * [1.0, 1.0, 0.0]
        return np.asarray(way / np.linalg.norm(way))

    def clear_of_palm(self, pitch: float, palm: float) -> float:
        """How much higher (m) a hand pitched down by so much (rad) takes the bar, whose end would meet its palm.

        palm: how far that is from the grip site, m.
        """
        if pitch >= 0.0:
            return 0.0
        return max(0.0, self.half - max(0.0, palm - _OFF_PALM - self.radius) / math.sin(-pitch))

    def turn(self, angle: float) -> Array:
        """Rotation (3, 3) of the door when it has been opened by an angle, rad."""
        return about_z(self.seen - self.sign * angle)
