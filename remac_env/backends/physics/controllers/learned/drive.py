"""What there is to see of a drive: its way over the floor plan, as corners from where the robot is.

Which way it goes is found, not learnt: the quickest of those that scripted drives choose from that has room for the
base and the folded arm on the floor plan. Ranges around the base alone do not say on which side a peninsula is passed.
What a hand carries goes over worktops and needs no room of its own there.
"""

from __future__ import annotations

import math

import numpy as np

from remac_env.backends.physics.controllers.base import Sensing
from remac_env.backends.physics.controllers.learned.aim import Aim, Target
from remac_env.backends.physics.controllers.learned.stand import Stand
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.routes import Departure, candidates, periods, placed, sampled
from remac_env.kitchen.floor import TALL
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.layout_checks import world_blocks
from remac_env.robots.body import Body
from remac_env.robots.rotation import Array

CORNERS = 3
"""Corners that are seen: the last one that was passed, and the next two."""

_A_TURN = 0.3  # m that count as much as a turn of the base by 1 rad
_EVEN = np.array([1.0, 1.0, _A_TURN])
_PASSED = 0.05  # m before a corner from which on it counts as passed
FINE = 0.02
"""m or rad below which distances and turns are seen in proportion, and above which by their logarithms."""

_MISSED = 0.1  # m from the station, turns counted in, from which on a robot at rest has not come near it
_ARRIVED = 0.02  # m from the station, turns counted in, at which a drive is over: a tenth of what is judged as there
_ARM = 0.13  # m by which the folded arm reaches out before the base
_GRAIN = 0.08  # m between points of a base that are held against the floor plan; no block is as thin
_EVERY = 4  # control periods between the moments that are


class Drive(Aim):
    """The station at which the robot is to stand, and the corners on the way there."""

    by_hand = False
    patience = 25

    def __init__(self, sensing: Sensing, stand: Stand, body: Body) -> None:
        super().__init__(sensing, stand)
        self._first = max(1e-6, self._away())
        q, goal = sensing.body.q, sensing.goal
        corners = [q, q] if goal is None else way_to(sensing.layout, sensing.station, q, goal, body)
        self._corners, self._next = np.array([corner[:3] for corner in corners]), 1

    def update(self) -> None:
        """Go on to the next corner once one is passed."""
        while self._next < len(self._corners) - 1 and self._passed():
            self._next += 1

    def _passed(self) -> bool:
        """Whether the robot has come as far as the next corner, along what leads there."""
        last, following = self._corners[self._next - 1 : self._next + 1] * _EVEN
        length = float(np.linalg.norm(following - last))
        gone = self._sensing.body.q[:3] * _EVEN - last
        return length < _PASSED or float(gone @ (following - last)) / length > length - _PASSED

    def target(self) -> Target:
        """The station itself, on the floor."""
        return Target(np.zeros(3))

    def done(self) -> float:
        """The share of the way that is behind the robot."""
        return max(0.0, 1.0 - self._away() / self._first)

    def missed(self) -> bool:
        """Whether it is not even near."""
        return self._away() > _MISSED

    def over(self) -> bool:
        """Whether it is there."""
        return self._away() < _ARRIVED

    def ahead(self) -> Array:
        """Where the corners are from the base, (4 CORNERS,): see `seen_corners`."""
        numbers = [min(self._next + k, len(self._corners) - 1) for k in range(-1, CORNERS - 1)]
        way = self._corners[numbers] - self._sensing.body.q[:3]
        return seen_corners(way[:, :2] @ self.stand.axes[:2, :2], way[:, 2])

    def _away(self) -> float:
        x, y, turn = self.stand.joints(self._sensing.body.q)[:3]
        return math.hypot(x, y) + _A_TURN * abs(turn)


def seen_corners(ways: Array, turns: Array) -> Array:
    """How corners look (4 n,) that are off by ``ways`` (n, 2), m to the right and to the wall, and ``turns`` (n,), rad.

    Of each the direction as a unit vector, the distance and the turn; these two the finer, the nearer it is, as a drive
    begins and ends by millimetres.
    """
    far = np.linalg.norm(ways, axis=1)
    directions = ways / np.maximum(far, FINE)[:, None]
    return np.column_stack([directions, np.arcsinh(far / FINE), np.arcsinh(turns / FINE)]).ravel()


def way_to(layout: Layout, place: Station, q: Array, goal: Station, body: Body) -> Path:
    """Corners (n,) of the quickest way from a place, where a robot stands as ``q`` (n,) says, that is free on the plan.

    Where none is, the quickest of all.
    """
    start = Departure(layout, place, q, footprint=body.footprint)
    ways = sorted((course.corners for course in candidates(start, goal)), key=lambda way: periods(way, body))
    blocks = [block for fixture in layout.fixtures.values() for block in world_blocks(layout, fixture)]
    solid = [block for block in blocks if block.low[2] < TALL]
    low, high = np.array([block.low[:2] for block in solid]), np.array([block.high[:2] for block in solid])
    (left, right), points = layout.room.x, _points(body)

    def free(way: Path) -> bool:
        bases = np.array(sampled(way, body)[::_EVERY])[:, :3]
        taken = placed(points, bases).reshape(-1, 1, 2)
        within = bool(((left < taken[..., 0]) & (taken[..., 0] < right)).all())
        return within and not ((low < taken) & (taken < high)).all(axis=2).any()

    return next(filter(free, ways), ways[0])


def _points(body: Body) -> Array:
    """Points (n, 2) all over a base with its arm folded, in its own frame."""
    (back, right), (front, left) = body.footprint
    ends = (back, front + _ARM), (right, left)
    x, y = (np.linspace(low, high, math.ceil((high - low) / _GRAIN) + 1) for low, high in ends)
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
