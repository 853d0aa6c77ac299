"""Frames of walls: where a wall stands in the room and which way it is turned, in quarter turns."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import pi

import numpy as np
from numpy.typing import NDArray

from remac_env.kitchen.blocks import Block, Point

_COSINES, _SINES = (1.0, 0.0, -1.0, 0.0), (0.0, 1.0, 0.0, -1.0)


@dataclass(frozen=True)
class Frame:
    """A level frame: its origin, m, and its heading in quarter turns about the vertical, world frame.

    Quarter turns are exact: numbers in a frame without any are those of the world to the last bit. More than three of
    them mean the same directions, but other values of the joint that turns a robot. `name`: whose it is.
    """

    x: float = 0.0
    y: float = 0.0
    quarters: int = 0
    name: str = field(default="room", compare=False)

    @property
    def heading(self) -> float:
        """Angle about the vertical, rad."""
        return 0.5 * pi * self.quarters

    @property
    def rotation(self) -> NDArray[np.float64]:
        """The frame's axes as columns (3, 3)."""
        c, s = _COSINES[self.quarters % 4], _SINES[self.quarters % 4]
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

    def point(self, x: float, y: float) -> tuple[float, float]:
        """A point of this frame, in the world, m."""
        c, s = _COSINES[self.quarters % 4], _SINES[self.quarters % 4]
        return self.x + c * x - s * y, self.y + s * x + c * y

    def local(self, x: float, y: float) -> tuple[float, float]:
        """A point of the world, in this frame, m."""
        c, s = _COSINES[self.quarters % 4], _SINES[self.quarters % 4]
        x, y = x - self.x, y - self.y
        return c * x + s * y, c * y - s * x

    def space(self, point: Point) -> Point:
        """A point of this frame with its height, in the world, m."""
        x, y, z = point
        return (*self.point(x, y), z)

    def block(self, block: Block) -> Block:
        """A block of this frame, in the world."""
        (x0, y0), (x1, y1) = self.point(*block.low[:2]), self.point(*block.high[:2])
        return Block((min(x0, x1), min(y0, y1), block.low[2]), (max(x0, x1), max(y0, y1), block.high[2]))


WORLD = Frame()
"""The frame of the room itself."""
