"""A timetable of drives: for each robot several ways over the floor, with delays so that they never come near.

All combinations of ways and delays are ordered by when the last robot arrives and checked in space and time, first by
circles around the robots' parts and, where those come near, with the real shapes. No robot has priority by its name;
drives that are under way go on as they are.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, islice, pairwise, permutations

import numpy as np

from remac_env.backends.physics.controllers.scripted.collision import IGNORED
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.skill import Surroundings
from remac_env.backends.physics.encounters import Encounter
from remac_env.backends.physics.litter import blocks
from remac_env.backends.physics.routes import Course, Departure, Outline, sampled
from remac_env.backends.physics.separation import NEAR_MISS, Separation
from remac_env.backends.physics.ways import SAMPLE, Combination, Driver, Moving, Way, held_pose, ordered, ways_to
from remac_env.kitchen.blocks import Block
from remac_env.kitchen.floor_plan import Station
from remac_env.robots.rotation import Array

_SOON, _TRIES = 150, 3850  # combinations checked in space and time: at first, and where all else has failed
_LANES = 3  # ways of one sort that are tried where several robots drive
_REFUGES = 6  # places to which a robot may withdraw that are tried, nearest first
_LATER = 7  # samples between the moments at which a drive may begin while others are under way
_APART = NEAR_MISS + 0.005  # m


@dataclass(frozen=True)
class Errand:
    """One robot's drive: its surroundings and where it is to end, world frame."""

    here: Surroundings
    goal: Station


class Timetable:
    """Plans drives that begin together; ``timed`` does it, and ``drivers`` are then the robots with their ways.

    ``rooms``: the floor that robots need which work meanwhile; drives keep off it. ``avoided``: things on the floor to
    drive around. ``moving``: drives that are under way.
    """

    def __init__(
        self, separation: Separation, errands: Mapping[str, Errand], rooms: Sequence[Block],
        avoided: frozenset[str] = frozenset(), moving: Sequence[Moving] = (),
    ) -> None:
        self._separation, self._errands, self._rooms, self._avoided = separation, errands, tuple(rooms), avoided
        self._moving = {drive.name: drive for drive in moving}
        self._staying = set(separation.robots) - set(errands) - set(self._moving)
        self._met: dict[tuple[Way, Way], Encounter] = {}
        self.drivers: Mapping[str, Driver] = {}

    def timed(self) -> dict[str, Path]:
        """A timed path for every robot; those without any way are left out, the others replanned."""
        self.drivers = drivers = {name: self._driver(errand) for name, errand in self._errands.items()}
        self._separation.refresh()
        places = {name: (errand.goal.x, errand.goal.y) for name, errand in self._errands.items()}
        going = sorted(drivers, key=lambda name: places[name])
        if self._moving:
            return self._between({name: drivers[name] for name in going})
        if len(going) > 1:
            together = {name: drivers[name] for name in going}
            tries = self._combinations(list(together.values()))
            # What is not found soon is mostly found at once with the robots one after the other.
            timed = (
                self._together(together, islice(tries, _SOON))
                or self._by_turns(together)
                or self._together(together, islice(tries, 0 if self._avoided else _TRIES))
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

    def _between(self, drivers: Mapping[str, Driver]) -> dict[str, Path]:
        """Paths that keep clear of drives under way, late where need be; else for the first that has one by itself."""
        under_way = max(len(moving.way.moments) for moving in self._moving.values())
        for late in (*range(0, under_way, _LATER), under_way):
            combinations = islice(self._combinations(list(drivers.values())), _SOON)
            timed = self._together(drivers, ((ways, tuple(d + late for d in delays)) for ways, delays in combinations))
            if timed:
                return timed
        for name, driver in drivers.items() if len(drivers) > 1 else ():
            timed = self._between({name: driver})
            self._separation.refresh()
            if timed and self._keeps_off(driver, timed[name], drivers.keys() - {name}):
                return timed
        return {}

    def _driver(self, errand: Errand) -> Driver:
        """All ways of one robot, not yet checked."""
        here = errand.here
        here.begin(avoid=self._avoided)
        for robot, body in self._separation.held.items():
            if robot != here.robot.name:
                here.scratch.mark(here.simulation.geoms(body), IGNORED)  # it goes where that robot goes
        staying = tuple(place for name, place in self._separation.places.items() if name in self._staying)
        staying += tuple(moving.bases[-1] for moving in self._moving.values())
        start = Departure(here.layout, here.place, here.robot.q, self._rooms, staying, self._litter(here))
        return Driver(here, ways_to(start, errand.goal), Outline.of(here), errand.goal)

    def _litter(self, here: Surroundings) -> tuple[Block, ...]:
        return blocks(here, self._avoided - {here.hand.body})

    def _path(self, driver: Driver, way: Way) -> Path | None:
        """The way as a path, one configuration a period, where it meets no furniture and nobody who stays."""
        if not way.checked:
            way.checked = True
            here, corners = driver.here, way.course.corners
            path = sampled(corners)
            bases = np.array(path[::4])[:, :3]
            if not any(driver.outline.meets(bases, room) for room in self._rooms):
                with here.scratch.without_robots():
                    free = all(here.planner.edge(one, other, 0.1) for one, other in pairwise(corners))
                if free and self._keeps_off(driver, path, self._staying):
                    way.path = path
        return way.path

    def _keeps_off(self, driver: Driver, path: Path, standing: Collection[str]) -> bool:
        """Whether a path keeps clear of robots that stand where they are."""
        circles = self._separation.circles(standing)
        if not len(circles):
            return True
        moments = [*path[::SAMPLE], path[-1]]
        middles, radii = driver.outline.circles(np.array(moments)[:, :3])
        gaps = np.linalg.norm(middles[:, :, None] - circles[:, :2], axis=3) - radii[:, None] - circles[:, 2]
        near = np.flatnonzero(gaps.min(axis=(1, 2)) < _APART)
        name = driver.here.robot.name
        return all(self._clear({name: driver}, {name: moments[k]}, standing) for k in near)

    def _choice(self, driver: Driver) -> list[Way]:
        """Free ways of every sort: the quickest, the slowest and one between."""
        sorts: dict[tuple[int, str], list[Way]] = defaultdict(list)
        for way in driver.ways:
            sorts[way.course.sort].append(way)
        found: list[Way] = []
        for ways in sorts.values():
            order = [ways[0], ways[-1], *ways[len(ways) // 2 :], *ways[1:]]
            free = (way for way in dict.fromkeys(order) if self._path(driver, way))
            found += islice(free, _LANES)
        return found

    def _together(self, drivers: Mapping[str, Driver], tries: Iterable[Combination]) -> dict[str, Path] | None:
        """The first combination of ways and delays that keeps the robots apart all the time."""
        names = list(drivers)
        for ways, delays in tries:
            if all(
                self._encounter(drivers, names, (i, ways[i]), (j, ways[j]), self._met).passes((delays[i], delays[j]))
                for i, j in combinations(range(len(names)), 2)
            ) and all(self._passes(drivers[names[i]], ways[i], delays[i]) for i in range(len(names))):
                return {
                    name: [drivers[name].here.robot.q] * (delay * SAMPLE) + (way.path or [])
                    for name, way, delay in zip(names, ways, delays, strict=True)
                }
        return None

    def _passes(self, driver: Driver, way: Way, delay: int) -> bool:
        """Whether a way, begun so many samples late, keeps clear of all drives that are under way."""
        for name, moving in self._moving.items():
            pair = {driver.here.robot.name: driver, name: moving.driver}
            if not self._encounter(pair, list(pair), (0, way), (1, moving.way), self._met).passes((delay, 0)):
                return False
        return True

    def _combinations(self, drivers: Sequence[Driver]) -> Iterator[Combination]:
        """Ways with delays, in the order in which they end; everyone's quickest, at once, before others are checked."""
        quickest = [way for driver in drivers for way in islice((w for w in driver.ways if self._path(driver, w)), 1)]
        if len(quickest) == len(drivers):
            yield tuple(quickest), (0,) * len(drivers)
            yield from ordered([self._choice(driver) for driver in drivers])

    def _by_turns(self, drivers: Mapping[str, Driver]) -> dict[str, Path] | None:
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
        self, drivers: Mapping[str, Driver], name: str, start: tuple[Station, Array], goal: Station, standing: Array
    ) -> Path | None:
        """The quickest way of one robot while the other stands in a configuration."""
        driver, (other,) = drivers[name], (driver for key, driver in drivers.items() if key != name)
        place, q = start
        leaves = Departure(driver.here.layout, place, q, self._rooms, (standing,), self._litter(driver.here))
        for way in ways_to(leaves, goal):
            if self._path(driver, way):
                still = Way(Course([standing], (0, "standing")), 0, [standing], True)
                names = (name, other.here.robot.name)
                if self._encounter(drivers, names, (0, way), (1, still), {}).passes((0, 0)):
                    return way.path
        return None

    def _encounter(
        self, drivers: Mapping[str, Driver], names: Sequence[str], one: tuple[int, Way], other: tuple[int, Way],
        known: dict[tuple[Way, Way], Encounter],
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

    def _clear(
        self, drivers: Mapping[str, Driver], now: Mapping[str, Array], standing: Collection[str] = ()
    ) -> bool:
        """Whether robots in these configurations, and those that stand, are apart, with their real shapes."""
        held = {name: pose for name, q in now.items() if (pose := held_pose(drivers[name].here, q)) is not None}
        without = set(self._separation.robots) - now.keys() - set(standing) if self._moving else ()
        return self._separation.of_configurations(now, held, without) >= _APART
