"""Drives robots at the same time: for each several ways over the floor, with delays so that they never come near.

All combinations of ways and delays are ordered by when the last robot arrives and checked in space and time, first by
circles around the robots' parts and, where those come near, with the real shapes. No robot has priority by its name.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, islice, pairwise, permutations, product

import numpy as np

from remac_env.backends.physics.collision import IGNORED
from remac_env.backends.physics.encounters import Encounter
from remac_env.backends.physics.paths import Path
from remac_env.backends.physics.routes import Course, Departure, Outline, candidates, periods, sampled
from remac_env.backends.physics.separation import NEAR_MISS, Separation
from remac_env.backends.physics.skill import SkillFailure, Steps, Surroundings
from remac_env.kitchen.blocks import Block
from remac_env.kitchen.floor_plan import Station
from remac_env.robots.rotation import Array, quaternion

_SAMPLE = 3  # control periods between checks
_DELAYS = tuple(range(0, 112, 7))  # of the same
_SOON, _TRIES = 150, 3850  # combinations checked in space and time: at first, and where all else has failed
_LANES = 3  # ways of one sort that are tried where several robots drive
_REFUGES = 6  # places to which a robot may withdraw that are tried, nearest first
_APART = NEAR_MISS + 0.005  # m


@dataclass(frozen=True)
class Errand:
    """One robot's drive: its surroundings and where it is to end, world frame."""

    here: Surroundings
    goal: Station


@dataclass(eq=False)
class _Way:
    """One way of one robot: its course, how long it takes, and, once asked for, its path or None if not free."""

    course: Course
    periods: int
    path: Path | None = None
    checked: bool = False

    @property
    def moments(self) -> Path:
        """Every so many configurations of the path, and its last."""
        path = self.path or []
        return [*path[::_SAMPLE], *path[-1:]]


@dataclass(frozen=True)
class _Driver:
    """A robot with its ways, quickest first, its outline while it drives, and its goal."""

    here: Surroundings
    ways: list[_Way]
    outline: Outline
    goal: Station


_Combination = tuple[tuple[_Way, ...], tuple[int, ...]]
"""A way for each robot, and by how many samples each starts late."""


class Convoy:
    """The drives of one round. ``plan`` once, then run every robot's ``steps``.

    ``rooms``: the floor that robots need which work meanwhile; drives keep off it.
    """

    def __init__(self, separation: Separation, errands: Mapping[str, Errand], rooms: Sequence[Block]) -> None:
        self._separation, self._errands, self._rooms = separation, dict(errands), tuple(rooms)
        self._timed: dict[str, Path] | None = None
        self._met: dict[tuple[_Way, _Way], Encounter] = {}
        self._failed = False

    def held_up(self, robot: str) -> bool:
        """Whether a robot found no way while others work."""
        return bool(self._rooms) and self._timed is not None and robot not in self._timed

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
        places = {name: (errand.goal.x, errand.goal.y) for name, errand in self._errands.items()}
        going = sorted(drivers, key=lambda name: places[name])
        if len(going) > 1:
            together = {name: drivers[name] for name in going}
            tries = self._combinations(list(together.values()))
            # What is not found soon is mostly found at once with the robots one after the other.
            timed = (
                self._together(together, islice(tries, _SOON))
                or self._by_turns(together)
                or self._together(together, islice(tries, _TRIES))
            )
            if timed:
                return timed
        for name in going:
            standing = set(self._separation.robots) - {name}
            for way in drivers[name].ways:
                path = self._path(drivers[name], way)
                if path and self._keeps_off(drivers[name], path, standing):
                    return {name: path}
        return {}

    def _driver(self, errand: Errand) -> _Driver:
        """All ways of one robot, not yet checked."""
        here = errand.here
        here.begin()
        for robot, body in self._separation.held.items():
            if robot != here.robot.name:
                here.scratch.mark(here.simulation.geoms(body), IGNORED)  # it goes where that robot goes
        staying = tuple(place for name, place in self._separation.places.items() if name not in self._errands)
        start = Departure(here.layout, here.place, here.robot.q, self._rooms, staying)
        return _Driver(here, _ways(start, errand.goal), Outline.of(here), errand.goal)

    def _path(self, driver: _Driver, way: _Way) -> Path | None:
        """The way as a path, one configuration a period, where it meets no furniture and nobody who stays."""
        if not way.checked:
            way.checked = True
            here, corners = driver.here, way.course.corners
            path = sampled(corners)
            bases = np.array(path[::4])[:, :3]
            if not any(driver.outline.meets(bases, room) for room in self._rooms):
                with here.scratch.without_robots():
                    free = all(here.planner.edge(one, other, 0.1) for one, other in pairwise(corners))
                staying = set(self._separation.robots) - set(self._errands)
                if free and self._keeps_off(driver, path, staying):
                    way.path = path
        return way.path

    def _keeps_off(self, driver: _Driver, path: Path, standing: Collection[str]) -> bool:
        """Whether a path keeps clear of robots that stand where they are."""
        circles = self._separation.circles(standing)
        if not len(circles):
            return True
        moments = [*path[::_SAMPLE], path[-1]]
        middles, radii = driver.outline.circles(np.array(moments)[:, :3])
        gaps = np.linalg.norm(middles[:, :, None] - circles[:, :2], axis=3) - radii[:, None] - circles[:, 2]
        near = np.flatnonzero(gaps.min(axis=(1, 2)) < _APART)
        return all(self._clear({driver.here.robot.name: driver}, {driver.here.robot.name: moments[k]}) for k in near)

    def _choice(self, driver: _Driver) -> list[_Way]:
        """Free ways of every sort: the quickest, the slowest and one between."""
        sorts: dict[tuple[int, str], list[_Way]] = defaultdict(list)
        for way in driver.ways:
            sorts[way.course.sort].append(way)
        found: list[_Way] = []
        for ways in sorts.values():
            order = [ways[0], ways[-1], *ways[len(ways) // 2 :], *ways[1:]]
            free = (way for way in dict.fromkeys(order) if self._path(driver, way))
            found += islice(free, _LANES)
        return found

    def _together(self, drivers: Mapping[str, _Driver], tries: Iterable[_Combination]) -> dict[str, Path] | None:
        """The first combination of ways and delays that keeps the robots apart all the time."""
        names = list(drivers)
        for ways, delays in tries:
            if all(
                self._encounter(drivers, names, (i, ways[i]), (j, ways[j]), self._met).passes((delays[i], delays[j]))
                for i, j in combinations(range(len(names)), 2)
            ):
                return {
                    name: [drivers[name].here.robot.q] * (delay * _SAMPLE) + (way.path or [])
                    for name, way, delay in zip(names, ways, delays, strict=True)
                }
        return None

    def _combinations(self, drivers: Sequence[_Driver]) -> Iterator[_Combination]:
        """Ways with delays, in the order in which they end; everyone's quickest, at once, before others are checked."""
        quickest = [way for driver in drivers for way in islice((w for w in driver.ways if self._path(driver, w)), 1)]
        if len(quickest) == len(drivers):
            yield tuple(quickest), (0,) * len(drivers)
            yield from _ordered([self._choice(driver) for driver in drivers])

    def _by_turns(self, drivers: Mapping[str, _Driver]) -> dict[str, Path] | None:
        """One robot makes room, the other drives, then the first: the quickest such way of two robots."""
        found: list[tuple[int, dict[str, Path]]] = []
        for one, other in permutations(drivers, 2):
            first, second = drivers[one], drivers[other]
            for refuge in sorted(first.here.layout.refuges(first.here.place), key=first.here.place.distance)[:_REFUGES]:
                out = self._alone(drivers, one, (first.here.place, first.here.robot.q), refuge, second.here.robot.q)
                through = out and self._alone(
                    drivers, other, (second.here.place, second.here.robot.q), second.goal, out[-1]
                )
                back = out and through and self._alone(drivers, one, (refuge, out[-1]), first.goal, through[-1])
                if out and through and back:
                    late = [second.here.robot.q] * len(out) + through
                    found.append((len(late) + len(back), {one: [*out, *[out[-1]] * len(through), *back], other: late}))
                    break
        return min(found, key=lambda entry: entry[0])[1] if found else None

    def _alone(
        self, drivers: Mapping[str, _Driver], name: str, start: tuple[Station, Array], goal: Station, standing: Array
    ) -> Path | None:
        """The quickest way of one robot while the other stands in a configuration."""
        driver, (other,) = drivers[name], (driver for key, driver in drivers.items() if key != name)
        place, q = start
        for way in _ways(Departure(driver.here.layout, place, q, self._rooms, (standing,)), goal):
            if self._path(driver, way):
                still = _Way(Course([standing], (0, "standing")), 0, [standing], True)
                names = (name, other.here.robot.name)
                if self._encounter(drivers, names, (0, way), (1, still), {}).passes((0, 0)):
                    return way.path
        return None

    def _encounter(
        self, drivers: Mapping[str, _Driver], names: Sequence[str], one: tuple[int, _Way], other: tuple[int, _Way],
        known: dict[tuple[_Way, _Way], Encounter],
    ) -> Encounter:
        key = one[1], other[1]
        if key not in known:
            pair, moments = (names[one[0]], names[other[0]]), (one[1].moments, other[1].moments)
            known[key] = Encounter(
                (np.array(moments[0])[:, :3], np.array(moments[1])[:, :3]),
                (drivers[pair[0]].outline, drivers[pair[1]].outline),
                _APART,
                lambda i, j: self._clear(drivers, {pair[0]: moments[0][i], pair[1]: moments[1][j]}),
            )
        return known[key]

    def _clear(self, drivers: Mapping[str, _Driver], now: Mapping[str, Array]) -> bool:
        """Whether robots in these configurations are apart, with their real shapes."""
        held = {name: pose for name, q in now.items() if (pose := _held(drivers[name].here, q)) is not None}
        return self._separation.of_configurations(now, held) >= _APART


def _ways(start: Departure, goal: Station) -> list[_Way]:
    """All ways to a place, quickest first, not yet checked."""
    ways = [_Way(course, periods(course.corners)) for course in candidates(start, goal)]
    return sorted(ways, key=lambda way: way.periods)


def _held(here: Surroundings, q: Array) -> tuple[int, Array] | None:
    """Address and pose (7,) of what a robot holds when it is in configuration ``q``."""
    attached = here.scratch.held
    if attached is None:
        return None
    position, rotation = here.kinematics.forward(q)
    turned = quaternion(rotation @ attached.rotation)
    return attached.address, np.concatenate([position + rotation @ attached.position, turned])


def _ordered(ways: Sequence[Sequence[_Way]]) -> list[_Combination]:
    """Ways with delays, of which at least one is zero, by the last arrival and then by all arrivals together."""
    found: list[tuple[int, int, int, tuple[_Way, ...], tuple[int, ...]]] = []
    for chosen in product(*ways):
        for delays in product(_DELAYS, repeat=len(chosen)):
            if min(delays) == 0:
                ends = [delay * _SAMPLE + way.periods for delay, way in zip(delays, chosen, strict=True)]
                found.append((max(ends), sum(ends), len(found), chosen, delays))
    return [(chosen, delays) for _, _, _, chosen, delays in sorted(found, key=lambda entry: entry[:3])]
