"""Drives robots to stations at the same time: routes through lanes, with delays so that robots never come near.

Every mover leaves its station backwards into a lane, goes along it and drives in. All combinations of lanes and
delays are ordered by when the last robot arrives and checked in space and time with the robots' real shapes. No
robot has priority by its name.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import mujoco
import numpy as np

from remac_env.backends.physics.paths import Path
from remac_env.backends.physics.separation import NEAR_MISS, Separation
from remac_env.backends.physics.simulation import CONTROL_PERIOD
from remac_env.backends.physics.skill import SkillFailure, Steps, Surroundings
from remac_env.robots import panda
from remac_env.robots.rotation import Array

_LANES = (-1.5, -1.7, -1.9, -2.1, -2.3, -2.5, -2.7, -2.9)  # y of the arm axis, m
_DELAYS = tuple(range(0, 321, 20))  # control periods
_TRIES = 250  # combinations checked in space and time
_SAMPLE = 3  # control periods between checks
_ROOM_HALF, _ROOM_BACK = 0.42, -1.30  # m: what a robot that works at a station may use


@dataclass(frozen=True)
class Errand:
    """One robot's drive: its surroundings and the base pose (3,) to end at."""

    here: Surroundings
    goal: Array


@dataclass(frozen=True)
class Rooms:
    """Where robots that do not drive are: ``working`` stations' x (m), whose rooms must be kept free."""

    working: tuple[float, ...] = ()


class Convoy:
    """The drives of one round. ``plan`` once, then run every robot's ``steps``."""

    def __init__(self, separation: Separation, errands: Mapping[str, Errand], rooms: Rooms) -> None:
        self._separation, self._errands, self._rooms = separation, dict(errands), rooms
        self._timed: dict[str, Path] | None = None
        self._failed = False

    def steps(self, robot: str) -> Steps:
        """Drive one robot. Fails with ``blocked`` when there is no way, or when another's drive fails."""
        if self._timed is None:
            self._timed = self._plan()
        if robot not in self._timed:
            raise SkillFailure("blocked", "no way that keeps clear of the other robot and the furniture")
        mover = self._errands[robot].here.mover
        try:
            for q in self._timed[robot]:
                if self._failed:
                    raise SkillFailure("blocked", "another robot's drive failed")
                yield from mover.step(q)
            yield from mover.settle(0.004, 8)
        except BaseException:
            self._failed = True
            raise

    def _plan(self) -> dict[str, Path]:
        """A timed path for every robot that can go; robots without any way are left out, the others replanned."""
        options = {name: self._options(errand) for name, errand in self._errands.items()}
        going = sorted((name for name in options if options[name]), key=lambda n: tuple(self._errands[n].goal))
        self._separation.refresh()
        for group in (going, *([name] for name in going)):
            if not group:
                continue
            timed = self._combine({name: options[name] for name in group})
            if timed is not None:
                return timed
        return {}

    def _options(self, errand: Errand) -> list[Path]:
        """Sampled routes that meet no furniture and no working robot's room, quickest first."""
        here = errand.here
        here.begin()
        routes = []
        with here.scratch.without_robots():
            for lane in self._lanes(errand):
                corners = _corners(here.robot.q, errand.goal, lane)
                ends = [here.robot.q, *corners]
                if all(here.planner.edge(ends[k], ends[k + 1], 0.1) for k in range(len(corners))):
                    path = sampled(here.robot.q, corners)
                    if not any(self._intrudes(here, q) for q in path[::4]):
                        routes.append(path)
        return routes

    def _lanes(self, errand: Errand) -> Sequence[float]:
        """Lanes, the layout's one for this direction first."""
        lanes = errand.here.layout.lanes
        own = lanes.rightward if errand.goal[0] > errand.here.robot.q[0] else lanes.leftward
        return sorted(_LANES, key=lambda y: (abs(y - own), y))

    def _intrudes(self, here: Surroundings, q: Array) -> bool:
        if not self._rooms.working:
            return False
        here.scratch.free(q)
        low, high = here.scratch.extent()
        for x in self._rooms.working:
            if ((high[:, 0] > x - _ROOM_HALF) & (low[:, 0] < x + _ROOM_HALF) & (high[:, 1] > _ROOM_BACK)).any():
                return True
        return False

    def _combine(self, options: Mapping[str, list[Path]]) -> dict[str, Path] | None:
        """The combination of routes and delays that ends first and keeps the robots apart all the time."""
        names = list(options)
        for paths, delays in _ordered(_combinations([options[name] for name in names]))[:_TRIES]:
            timed = {
                name: [self._errands[name].here.robot.q] * delay + list(path)
                for name, path, delay in zip(names, paths, delays, strict=True)
            }
            if self._apart(timed):
                return timed
        return None

    def _apart(self, timed: Mapping[str, Path]) -> bool:
        last = max(len(path) for path in timed.values())
        for k in [*range(0, last, _SAMPLE), last - 1]:
            now = {name: path[min(k, len(path) - 1)] for name, path in timed.items()}
            attached = {name: pose for name, q in now.items() if (pose := self._held(name, q)) is not None}
            if self._separation.of_configurations(now, attached) < NEAR_MISS + 0.005:
                return False
        return True

    def _held(self, name: str, q: Array) -> tuple[int, Array] | None:
        here = self._errands[name].here
        attached = here.scratch.held
        if attached is None:
            return None
        position, rotation = here.kinematics.forward(q)
        quat = np.empty(4)
        mujoco.mju_mat2Quat(quat, (rotation @ attached.rotation).ravel())
        return attached.address, np.concatenate([position + rotation @ attached.position, quat])


Combination = tuple[tuple[Path, ...], tuple[int, ...]]


def _ordered(combinations: Iterator[Combination]) -> list[Combination]:
    """By the arrival of the last robot, then by all arrivals together."""

    def arrivals(combination: Combination) -> tuple[int, int]:
        ends = [delay + len(path) for path, delay in zip(*combination, strict=True)]
        return max(ends), sum(ends)

    return sorted(combinations, key=arrivals)


def _combinations(options: Sequence[Sequence[Path]]) -> Iterator[Combination]:
    """Routes with delays of which at least one is zero."""
    for paths in product(*options):
        for delays in product(_DELAYS, repeat=len(paths)):
            if min(delays) == 0:
                yield paths, delays


def _corners(q: Array, goal: Array, lane: float) -> Path:
    """Back into the lane, along it, and in to the goal."""
    out, along, end = q.copy(), q.copy(), q.copy()
    out[1] = lane
    along[0], along[1], along[2] = goal[0], lane, goal[2]
    end[:3] = goal
    return [out, along, end]


def sampled(q: Array, corners: Sequence[Array]) -> Path:
    """One configuration per control period through the corners, as :meth:`Mover.go` would move."""
    path: Path = []
    start = q
    for corner in corners:
        longest = float(np.max(np.abs(corner - start) / panda.SPEED))
        if longest < 1e-6:
            continue
        count = max(2, math.ceil(longest * 1.5 / CONTROL_PERIOD))
        for k in range(1, count + 1):
            u = k / count
            path.append(start + u * u * (3 - 2 * u) * (corner - start))
        start = corner
    return path or [q]
