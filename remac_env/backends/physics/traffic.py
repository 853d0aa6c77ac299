"""Drives robots at the same time: for each several ways over the floor, with delays so that they never come near.

All combinations of ways and delays are ordered by when the last robot arrives and checked in space and time, first by
circles around the robots' parts and, where those come near, with the real shapes. No robot has priority by its name.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import mujoco
import numpy as np

from remac_env.backends.physics.collision import IGNORED
from remac_env.backends.physics.paths import Path
from remac_env.backends.physics.routes import Outline, candidates, periods, sampled
from remac_env.backends.physics.separation import NEAR_MISS, Separation
from remac_env.backends.physics.skill import SkillFailure, Steps, Surroundings
from remac_env.kitchen.fixtures.base import Block
from remac_env.kitchen.layout import Station
from remac_env.robots.rotation import Array

_DELAYS = tuple(range(0, 321, 20))  # control periods
_TRIES = 600  # combinations checked in space and time
_SAMPLE = 3  # control periods between checks
_APART = NEAR_MISS + 0.005  # m


@dataclass(frozen=True)
class Errand:
    """One robot's drive: its surroundings and where it is to end, world frame."""

    here: Surroundings
    goal: Station


@dataclass
class _Way:
    """One way of one robot: corners, how long it takes, and, once asked for, its path or None where it is not free."""

    corners: Path
    periods: int
    path: Path | None = None
    checked: bool = False


@dataclass(frozen=True)
class _Driver:
    """A robot with its ways, quickest first, and its outline while it drives."""

    here: Surroundings
    ways: list[_Way]
    outline: Outline


class Convoy:
    """The drives of one round. ``plan`` once, then run every robot's ``steps``.

    ``rooms``: the floor that robots need which work meanwhile; drives keep off it.
    """

    def __init__(self, separation: Separation, errands: Mapping[str, Errand], rooms: Sequence[Block]) -> None:
        self._separation, self._errands, self._rooms = separation, dict(errands), tuple(rooms)
        self._timed: dict[str, Path] | None = None
        self._failed = False

    def steps(self, robot: str) -> Steps:
        """Drive one robot. Fails with ``blocked`` when there is no way, or when another's drive fails."""
        if self._timed is None:
            self._timed = self._plan()
        here = self._errands[robot].here
        try:
            if robot not in self._timed:
                raise SkillFailure("blocked", "no way that keeps clear of the other robot and the furniture")
            for q in self._timed[robot]:
                if self._failed:
                    raise SkillFailure("blocked", "another robot's drive failed")
                yield from here.mover.step(q)
            yield from here.mover.settle(0.004, 8)
        except BaseException:
            self._failed = self._failed or robot in self._timed
            here.enter(here.place)
            raise
        here.enter(self._errands[robot].goal)

    def _plan(self) -> dict[str, Path]:
        """A timed path for every robot that can go; robots without any way are left out, the others replanned."""
        for errand in self._errands.values():
            errand.here.leave()
        drivers = {name: self._driver(errand) for name, errand in self._errands.items()}
        self._separation.refresh()
        goals = {name: (errand.goal.x, errand.goal.y) for name, errand in self._errands.items()}
        able = [name for name, driver in drivers.items() if any(self._path(driver, way) for way in driver.ways)]
        going = sorted(able, key=lambda n: goals[n])
        for group in (going, *([name] for name in going)) if len(going) != 1 else (going,):
            timed = self._combine({name: drivers[name] for name in group}) if group else None
            if timed is not None:
                return timed
        return {}

    def _driver(self, errand: Errand) -> _Driver:
        """All ways of one robot, not yet checked."""
        here = errand.here
        here.begin()
        for robot, body in self._separation.held.items():
            if robot != here.robot.name:
                here.scratch.mark(here.simulation.geoms(body), IGNORED)  # it goes where that robot goes
        ways = [_Way(way, periods(here.robot.q, way)) for way in candidates(here, errand.goal, self._rooms)]
        return _Driver(here, sorted(ways, key=lambda way: way.periods), Outline.of(here))

    def _path(self, driver: _Driver, way: _Way) -> Path | None:
        """The way as a path, one configuration a period, where it meets no furniture and no working robot's room."""
        if not way.checked:
            way.checked = True
            here = driver.here
            path = sampled(here.robot.q, way.corners)
            bases = np.array(path[::4])[:, :3]
            ends = [here.robot.q, *way.corners]
            if not any(driver.outline.meets(bases, room) for room in self._rooms):
                with here.scratch.without_robots():
                    if all(here.planner.edge(ends[k], ends[k + 1], 0.1) for k in range(len(way.corners))):
                        way.path = path
        return way.path

    def _combine(self, drivers: Mapping[str, _Driver]) -> dict[str, Path] | None:
        """The combination of ways and delays that ends first and keeps the robots apart all the time."""
        names, tries = list(drivers), 0
        standing = self._separation.circles(set(self._separation.robots) - set(names))
        for ways, delays in _ordered([drivers[name].ways for name in names]):
            timed: dict[str, Path] = {}
            for name, way, delay in zip(names, ways, delays, strict=True):
                path = self._path(drivers[name], way)
                if path is not None:
                    timed[name] = [drivers[name].here.robot.q] * delay + path
            if len(timed) < len(names):
                continue
            if self._apart(drivers, timed, standing):
                return timed
            tries += 1
            if tries >= _TRIES:
                break
        return None

    def _apart(self, drivers: Mapping[str, _Driver], timed: Mapping[str, Path], standing: Array) -> bool:
        """Whether robots keep apart; only where circles around their parts come near are the real shapes looked at."""
        last = max(len(path) for path in timed.values())
        ticks = np.array([*range(0, last, _SAMPLE), last - 1])
        bound = np.full(len(ticks), np.inf)
        drawn = []
        for name, path in timed.items():
            bases = np.array([path[min(k, len(path) - 1)][:3] for k in ticks])
            drawn.append(drivers[name].outline.circles(bases))
        fixed = np.broadcast_to(standing[:, :2], (len(ticks), *standing[:, :2].shape)), standing[:, 2]
        for one, other in [(a, b) for i, a in enumerate(drawn) for b in [*drawn[i + 1 :], fixed]]:
            if len(other[1]):
                gaps = np.linalg.norm(one[0][:, :, None] - other[0][:, None], axis=-1)
                bound = np.minimum(bound, (gaps - one[1][:, None] - other[1]).min(axis=(1, 2)))
        near = [k for k in np.argsort(bound, kind="stable") if bound[k] < _APART]
        return all(self._clear(drivers, timed, int(ticks[k])) for k in near)

    def _clear(self, drivers: Mapping[str, _Driver], timed: Mapping[str, Path], tick: int) -> bool:
        now = {name: path[min(tick, len(path) - 1)] for name, path in timed.items()}
        held = {name: pose for name, q in now.items() if (pose := _held(drivers[name].here, q)) is not None}
        return self._separation.of_configurations(now, held) >= _APART


def _held(here: Surroundings, q: Array) -> tuple[int, Array] | None:
    """Address and pose (7,) of what a robot holds when it is in configuration ``q``."""
    attached = here.scratch.held
    if attached is None:
        return None
    position, rotation = here.kinematics.forward(q)
    quat = np.empty(4)
    mujoco.mju_mat2Quat(quat, (rotation @ attached.rotation).ravel())
    return attached.address, np.concatenate([position + rotation @ attached.position, quat])


def _ordered(ways: Sequence[Sequence[_Way]]) -> list[tuple[tuple[_Way, ...], tuple[int, ...]]]:
    """Ways with delays, of which at least one is zero, by the last arrival and then by all arrivals together."""
    found: list[tuple[int, int, int, tuple[_Way, ...], tuple[int, ...]]] = []
    for chosen in product(*ways):
        for delays in product(_DELAYS, repeat=len(chosen)):
            if min(delays) == 0:
                ends = [delay + way.periods for delay, way in zip(delays, chosen, strict=True)]
                found.append((max(ends), sum(ends), len(found), chosen, delays))
    return [(chosen, delays) for _, _, _, chosen, delays in sorted(found, key=lambda entry: entry[:3])]
