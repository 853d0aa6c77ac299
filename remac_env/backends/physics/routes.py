"""Ways of one base over the floor: out of a station, along and around, and in to the next one; and what they sweep."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from remac_env.backends.physics.controllers.scripted.motion import periods_between
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.kitchen.blocks import Block
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.frame import Frame
from remac_env.kitchen.layout_checks import floor
from remac_env.robots.body import Body
from remac_env.robots.footprints import Footprint, radius
from remac_env.robots.rotation import Array

LANES = (-1.15, -1.3, -1.5, -1.7, -1.9, -2.1, -2.3, -2.5, -2.7, -2.9)  # y of the arm axis before a wall, m
_CROSSINGS = (-1.15, -1.4, -1.8, -2.3)  # the same for the two walls of a drive from one to another
_SLIDES = (0.5, -0.5, 1.0, -1.0)  # m along a wall before a robot leaves it, or after it has come to it
_ROOMY = 0.10  # m beyond the base that must be free around the axis on ways that turn corners
_HALF_TURN = 2.0  # rad from which on a turn may as well go the other way round
_STANDING = (0.20, 0.32, 0.14)  # m: half the side of the square that a standing robot takes, as tried in turn


@dataclass(frozen=True)
class Course:
    """A way as its corners (n,), world frame, its start the first, and its sort: one sort differs in lanes only."""

    corners: Path
    sort: tuple[int, str]


@dataclass(frozen=True)
class Departure:
    """From where a robot drives: the layout, its place there and its configuration (n,).

    obstacles: floor to keep off; litter: the same, of objects on it. standing: where other robots stand, poses (3,) or
    configurations (n,). footprint: of its base.
    """

    layout: Layout
    place: Station
    q: Array
    footprint: Footprint = field(kw_only=True)
    obstacles: tuple[Block, ...] = ()
    standing: tuple[Array, ...] = ()
    litter: tuple[Block, ...] = ()


def candidates(start: Departure, goal: Station) -> Iterator[Course]:
    """Ways from where the robot is to ``goal``, in no particular order."""
    q, end = start.q, start.q.copy()
    turn = math.remainder(goal.yaw - q[2], 2.0 * math.pi)
    end[:3] = goal.x, goal.y, q[2] + turn
    around = [_around(start, goal, end, half) for half in (_STANDING if start.standing else _STANDING[:1])]
    yield from _ways_to(start, goal, end, around)
    if abs(turn) > _HALF_TURN:
        end = end.copy()
        end[2] -= math.copysign(2.0 * math.pi, turn)
        yield from _ways_to(start, goal, end, around)


def _ways_to(start: Departure, goal: Station, end: Array, around: Sequence[Path]) -> Iterator[Course]:
    """Ways that end in configuration ``end``, turning towards it on the side that its heading says.

    ``around``: the corners of ways around whatever stands there, all with the heading of their start.
    """
    layout, q, place = start.layout, start.q, start.place
    side = int(math.copysign(1.0, end[2] - q[2]))
    if place.wall and goal.wall and place.wall != goal.wall:
        frames = layout.facing(place), layout.facing(goal)
        for first, second in product(_CROSSINGS, _CROSSINGS):
            out, before = _moved(q, frames[0], q, first), _moved(end, frames[1], end, second)
            yield Course([q, out, before, end], (side, "turning on the way"))
            yield Course([q, out, _turned(out, end), before, end], (side, "turning first"))
            yield Course([q, out, _turned(before, q), before, end], (side, "turning last"))
    else:
        frame = layout.facing(goal if goal.wall else place) if goal.wall or place.wall else _any_frame(layout)
        for lane in LANES:
            yield Course([q, _moved(q, frame, q, lane), _moved(end, frame, end, lane), end], (side, f"lane {lane}"))
        if not place.wall:
            yield Course([q, end], (side, "straight"))
    if start.standing or start.litter:
        yield from _along_walls(start, goal, end, side)
    for corners in around:
        if corners:
            yield Course(_turning(q, corners, end), (side, "around"))


def _along_walls(start: Departure, goal: Station, end: Array, side: int) -> Iterator[Course]:
    """Ways that begin or end along the wall: beside a corner, someone may stand right behind the robot."""
    q, sort = start.q, (side, "along the wall")
    leaves, comes = (start.layout.facing(at) if at.wall else None for at in (start.place, goal))
    if leaves and start.place.wall == goal.wall:
        _, y = leaves.local(float(q[0]), float(q[1]))
        yield Course([q, _moved(q, leaves, end, y), end], sort)
    for slide in _SLIDES:
        if leaves:
            aside = _slid(q, leaves, slide)
            for first, second in product(_CROSSINGS[:2], _CROSSINGS if comes else _CROSSINGS[:1]):
                before = _moved(end, comes, end, second) if comes else end
                yield Course([q, aside, _moved(q, leaves, aside, first), before, end], sort)
        if comes:
            ahead = _slid(end, comes, slide)
            for first, second in product(_CROSSINGS if leaves else _CROSSINGS[:1], _CROSSINGS[:2]):
                out = _moved(q, leaves, q, first) if leaves else q
                yield Course([q, out, _moved(end, comes, ahead, second), ahead, end], sort)


def _slid(q: Array, frame: Frame, slide: float) -> Array:
    """``q`` with its base moved along the wall of ``frame``."""
    x, y = frame.local(float(q[0]), float(q[1]))
    slid = q.copy()
    slid[:2] = frame.point(x + slide, y)
    return slid


def _any_frame(layout: Layout) -> Frame:
    return next(iter(layout.walls.values())).frame


def _moved(q: Array, frame: Frame, place: Array, lane: float) -> Array:
    """``q`` with its base where ``place`` has it along the wall of ``frame``, but in a lane."""
    x, _ = frame.local(float(place[0]), float(place[1]))
    moved = q.copy()
    moved[:2] = frame.point(x, lane)
    return moved


def _turned(q: Array, like: Array) -> Array:
    """``q`` with the heading of another configuration."""
    turned = q.copy()
    turned[2] = like[2]
    return turned


def _around(start: Departure, goal: Station, end: Array, half: float) -> Path:
    """Base positions (2,) of a way around corners, out of the station, over free floor, and in; none if it is shut."""
    growth = radius(start.footprint)
    space = floor(start.layout, growth + _ROOMY)
    taken = (Block((x - half, y - half, 0.0), (x + half, y + half, 1.0)) for x, y, *_ in start.standing)
    for block in (*start.obstacles, *start.litter, *taken):
        low, high = block.low, block.high
        space = space.without((low[0] - growth, low[1] - growth), (high[0] + growth, high[1] + growth))
    q, layout = start.q, start.layout
    out = _moved(q, layout.facing(start.place), q, _CROSSINGS[0]) if start.place.wall else q
    before = _moved(end, layout.facing(goal), end, _CROSSINGS[0]) if goal.wall else end
    places = space.way((out[0], out[1]), (before[0], before[1]))
    return [] if places is None else [np.array(place) for place in places]


def _turning(q: Array, places: Path, end: Array) -> Path:
    """Corners from ``q`` through base positions (2,) to ``end``, turning by as much of the turn as of the way."""
    lengths = np.hypot(*np.diff(np.array(places), axis=0).T)
    shares = np.cumsum(lengths) / max(float(lengths.sum()), 1e-9)
    out = q.copy()
    out[:2] = places[0]
    corners = [q, out]
    for place, share in zip(places[1:], shares, strict=True):
        corner = q.copy()
        corner[:2], corner[2] = place, q[2] + share * (end[2] - q[2])
        corners.append(corner)
    return [*corners, end]


def periods(corners: Path, body: Body) -> int:
    """How long a way through these corners takes, in control periods."""
    return max(1, sum(_count(one, other, body) for one, other in pairwise(corners)))


def sampled(corners: Path, body: Body) -> Path:
    """One configuration per control period through the corners, as :meth:`Mover.go` would move; the first left out."""
    path: Path = []
    for start, corner in pairwise(corners):
        count = _count(start, corner, body)
        u = np.arange(1, count + 1) / max(count, 1)
        path += list(start + (u * u * (3 - 2 * u))[:, None] * (corner - start))
    return path or [corners[0]]


def _count(start: Array, corner: Array, body: Body) -> int:
    """Control periods from corner to corner, none where they are the same."""
    same = float(np.max(np.abs(corner - start) / body.speed)) < 1e-6
    return 0 if same else max(2, periods_between(start, corner, body))


@dataclass(frozen=True)
class Outline:
    """A robot with its arm held still: boxes (n, 3) around its parts, in the frame of its base.

    footprint: of the base alone.
    """

    low: Array
    high: Array
    footprint: Footprint

    @staticmethod
    def of(here: Workspace) -> Outline:
        """The outline of a robot as it is, with what it holds."""
        q = here.robot.q.copy()
        q[:3] = 0.0
        here.clear.checker.pose(q)
        low, high = here.clear.checker.extent()
        return Outline(low, high, here.robot.body.footprint)

    def corners(self, bases: Array) -> Array:
        """Corners (t, 4 n, 2) of the boxes, in the world, for base poses (t, 3)."""
        both = np.stack([self.low, self.high])[:, :, :2]
        points = np.concatenate([np.column_stack([both[i, :, 0], both[j, :, 1]]) for i in (0, 1) for j in (0, 1)])
        return placed(points, bases)

    def circles(self, bases: Array) -> tuple[Array, Array]:
        """Middles (t, n, 2), in the world, and radii (n,) of circles around the boxes, for base poses (t, 3)."""
        low, high = self.low[:, :2], self.high[:, :2]
        return placed(0.5 * (low + high), bases), 0.5 * np.linalg.norm(high - low, axis=1)

    def meets(self, bases: Array, block: Block) -> bool:
        """Whether a part reaches over a block, seen from above, at any of these base poses (t, 3)."""
        low, high = self._spans(bases)
        over = (high > np.array(block.low[:2])) & (low < np.array(block.high[:2]))
        return bool(over.all(axis=2).any())

    def clear(self, bases: Array, boxes: tuple[Array, Array]) -> NDArray[np.bool_]:
        """Base poses (t, 3) -> (t,): at which no part comes into one of the ``boxes``, their corners (m, 3)."""
        low, high = self._spans(bases)
        least, most = low.min(axis=1), high.max(axis=1)
        start, end = (*least.min(axis=0), self.low[:, 2].min()), (*most.max(axis=0), self.high[:, 2].max())
        passed = ((boxes[0] < end) & (boxes[1] > start)).all(axis=1)
        first, last = boxes[0][passed], boxes[1][passed]
        # Most moments are clear of a box for the robot as a whole; its parts are looked at in the others.
        i, j = np.nonzero(((least[:, None] < last[:, :2]) & (most[:, None] > first[:, :2])).all(axis=2))
        over = (low[i] < last[j, None, :2]).all(axis=2) & (high[i] > first[j, None, :2]).all(axis=2)
        over &= (self.low[:, 2] < last[j, None, 2]) & (self.high[:, 2] > first[j, None, 2])
        clear = np.ones(len(bases), bool)
        clear[i[over.any(axis=1)]] = False
        return clear

    def _spans(self, bases: Array) -> tuple[Array, Array]:
        """Low and high corners (t, n, 2), in the world, around the boxes for base poses (t, 3)."""
        corners = self.corners(bases).reshape(len(bases), 4, -1, 2)
        return corners.min(axis=1), corners.max(axis=1)


def placed(points: Array, bases: Array) -> Array:
    """Points (n, 2) of a base, in the world, for base poses (t, 3): (t, n, 2)."""
    c, s = np.cos(bases[:, 2])[:, None], np.sin(bases[:, 2])[:, None]
    x, y = points.T
    return np.stack([c * x - s * y + bases[:, :1], s * x + c * y + bases[:, 1:2]], axis=2)
