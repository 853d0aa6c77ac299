"""A timetable of drives: for each robot several ways over the floor, with delays so that they never come near.

All combinations of ways and delays are ordered by when the last robot arrives and checked in space and time, first by
circles around the robots' parts and, where those come near, with the real shapes. No robot has priority by its name;
drives that are under way go on as they are.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import combinations, islice, permutations

from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.drives import Drives
from remac_env.backends.physics.routes import Course, Departure
from remac_env.backends.physics.ways import LATER, SAMPLE, Combination, Driver, Way, ordered, ways_to
from remac_env.kitchen.floor_plan import Station
from remac_env.robots.rotation import Array

_SOON, _TRIES = 150, 3850  # combinations checked in space and time: at first, and where all else has failed
_REFUGES = 6  # places to which a robot may withdraw that are tried, nearest first

Ride = tuple[str, Way, int]
"""A robot, its way, and by how many samples it starts late."""

NOWHERE: Mapping[str, Array] = {}


class Timetable(Drives):
    """Plans drives that begin together; ``timed`` does it, and ``drivers`` are then the robots with their ways."""

    def timed(self) -> dict[str, Path]:
        """A timed path for every robot; those without any way are left out, the others replanned."""
        self.drivers = drivers = {name: self._driver(drive_goal) for name, drive_goal in self._drive_goals.items()}
        self._separation.refresh()
        places = {name: (drive_goal.goal.x, drive_goal.goal.y) for name, drive_goal in self._drive_goals.items()}
        going = sorted(drivers, key=lambda name: places[name])
        if self._moving:
            return self._between({name: drivers[name] for name in going})
        together = {name: drivers[name] for name in going}
        if len(going) > 2:
            return self._of_many(together)
        if len(going) > 1:
            tries = self._combinations(list(together.values()))
            # What is not found soon is mostly found at once with the robots one after the other.
            timed = (
                self._together(together, islice(tries, _SOON))
                or self._by_turns(together)
                or self._together(together, islice(tries, 0 if self._avoided else _TRIES))
            )
            if timed:
                return timed
        self._separation.refresh()
        for name in going:
            standing = set(self._separation.robots) - {name}
            for way in drivers[name].ways:
                path = self._path(drivers[name], way)
                if path and self._keeps_off(drivers[name], path, standing):
                    return {name: path}
        return {}

    def _of_many(self, drivers: Mapping[str, Driver]) -> dict[str, Path]:
        """Paths for three robots or more; where there are none for all, for as many as have them while others stand."""
        timed = self._together(drivers, islice(self._combinations(list(drivers.values())), 1))
        timed = timed or self._in_order(drivers) or self._by_turns(drivers)
        if timed:
            return timed
        for count in range(len(drivers) - 1, 0, -1):
            for going in combinations(drivers, count):
                timed = self._in_order({name: drivers[name] for name in going}, drivers.keys() - set(going))
                if timed:
                    return timed
        return {}

    def _in_order(
        self, drivers: Mapping[str, Driver], staying: Collection[str] = (), parked: Mapping[str, Array] = NOWHERE
    ) -> dict[str, Path] | None:
        """Paths found for one robot after the other, each clear of those before it; of all orders the soonest done.

        ``staying``: robots that keep standing where they are; ``parked``: configurations in which others stand.
        """
        self._separation.refresh()
        ways = {
            name: [way for way in self._choice(driver) if self._keeps_off(driver, way.path or [], staying)]
            for name, driver in drivers.items()
        }
        still = [(name, _still(q), 0) for name, q in parked.items()]
        best: list[Ride] = []
        for order in permutations(drivers):
            rides = list(still)
            for name in order:
                ride = self._fitting(name, ways[name], rides)
                if ride is None:
                    break
                rides.append(ride)
            else:
                if not best or max(map(_end, rides)) < max(map(_end, best)):
                    best = rides
        return {name: self._late(name, way, delay) for name, way, delay in best[len(still) :]} or None

    def _fitting(self, name: str, ways: Sequence[Way], rides: Sequence[Ride]) -> Ride | None:
        """The way of a robot that ends first of those that keep clear of these rides and of drives under way."""
        ends = [*map(_end, rides), *(moving.way.periods for moving in self._moving.values())]
        last = -(-max(ends, default=0) // SAMPLE)
        tries = [(name, way, delay) for way in ways for delay in (*range(0, last, LATER), last)]
        for ride in sorted(tries, key=_end):
            passes = (
                self._encounter(self.drivers, (name, other), (0, ride[1]), (1, way), self._met).passes((ride[2], delay))
                for other, way, delay in rides
            )
            if all(passes) and self._passes(self.drivers[name], ride[1], ride[2]):
                return ride
        return None

    def _late(self, name: str, way: Way, delay: int) -> Path:
        return [self.drivers[name].here.robot.q] * (delay * SAMPLE) + (way.path or [])

    def _between(self, drivers: Mapping[str, Driver]) -> dict[str, Path]:
        """Paths that keep clear of drives under way, late where need be; else for the first that has one by itself."""
        if len(drivers) > 2:
            timed = self._in_order(drivers)
            if timed:
                return timed
        under_way = max(len(moving.way.moments) for moving in self._moving.values())
        for late in (*range(0, under_way, LATER), under_way) if len(drivers) < 3 else ():
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

    def _together(self, drivers: Mapping[str, Driver], tries: Iterable[Combination]) -> dict[str, Path] | None:
        """The first combination of ways and delays that keeps the robots apart all the time."""
        names = list(drivers)
        for ways, delays in tries:
            if all(
                self._encounter(drivers, names, (i, ways[i]), (j, ways[j]), self._met).passes((delays[i], delays[j]))
                for i, j in combinations(range(len(names)), 2)
            ) and all(self._passes(drivers[names[i]], ways[i], delays[i]) for i in range(len(names))):
                rides = zip(names, ways, delays, strict=True)
                return {name: self._late(name, way, delay) for name, way, delay in rides}
        return None

    def _combinations(self, drivers: Sequence[Driver]) -> Iterator[Combination]:
        """Ways with delays, in the order in which they end; everyone's quickest, at once, before others are checked."""
        quickest = [way for driver in drivers for way in islice((w for w in driver.ways if self._path(driver, w)), 1)]
        if len(quickest) == len(drivers):
            yield tuple(quickest), (0,) * len(drivers)
            yield from ordered([self._choice(driver) for driver in drivers])

    def _by_turns(self, drivers: Mapping[str, Driver]) -> dict[str, Path] | None:
        """One robot makes room, the others drive, then the first: the quickest such way."""
        found: list[tuple[int, dict[str, Path]]] = []
        for one, first in drivers.items():
            here, rest = first.here, {name: driver for name, driver in drivers.items() if name != one}
            waiting = {name: driver.here.robot.q for name, driver in rest.items()}
            for refuge in sorted(here.kitchen.layout.refuges(here.place), key=here.place.distance)[:_REFUGES]:
                out = self._alone(one, (here.place, here.robot.q), refuge, waiting)
                through = self._past(rest, {one: out[-1]}) if out else None
                if not out or not through:
                    continue
                arrived = {name: path[-1] for name, path in through.items()}
                back = self._alone(one, (refuge, out[-1]), first.goal, arrived)
                if back:
                    late = {name: [waiting[name]] * len(out) + path for name, path in through.items()}
                    meanwhile = max(len(path) for path in through.values())
                    first_path = [*out, *[out[-1]] * meanwhile, *back]
                    found.append((len(first_path), {one: first_path, **late}))
                    break
        return min(found, key=lambda entry: entry[0])[1] if found else None

    def _past(self, drivers: Mapping[str, Driver], parked: Mapping[str, Array]) -> dict[str, Path] | None:
        """Paths of robots to their goals while others stand in these configurations."""
        if len(drivers) > 1:
            return self._in_order(drivers, parked=parked)
        ((name, driver),) = drivers.items()
        path = self._alone(name, (driver.here.place, driver.here.robot.q), driver.goal, parked)
        return None if path is None else {name: path}

    def _alone(
        self, name: str, start: tuple[Station, Array], goal: Station, standing: Mapping[str, Array]
    ) -> Path | None:
        """The quickest way of one robot while others stand in these configurations."""
        driver, (place, q) = self.drivers[name], start
        around = (*standing.values(), *self._standing())
        leaves = Departure(
            driver.here.kitchen.layout, place, q, self._rooms, around, self._litter(driver.here),
            footprint=driver.here.robot.body.footprint,
        )  # fmt: skip
        still = [(other, _still(at)) for other, at in standing.items()]
        for way in ways_to(leaves, goal, driver.here.robot.body):
            if self._path(driver, way) and all(
                self._encounter(self.drivers, (name, other), (0, way), (1, there), {}).passes((0, 0))
                for other, there in still
            ):
                return way.path
        return None


def _still(q: Array) -> Way:
    """No way at all: to stand in a configuration."""
    return Way(Course([q], (0, "standing")), 0, [q], True)


def _end(ride: Ride) -> int:
    """When a ride ends, in control periods."""
    return ride[2] * SAMPLE + ride[1].periods
