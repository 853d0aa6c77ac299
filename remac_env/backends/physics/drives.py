"""What timetables of drives are made of: robots with their ways, and whether a way meets furniture or another robot."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise

import numpy as np
from numpy.typing import NDArray

from remac_env.backends.physics.controllers.scripted.collision import IGNORED
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.encounters import Encounter, distances
from remac_env.backends.physics.litter import blocks
from remac_env.backends.physics.routes import Departure, Outline, sampled
from remac_env.backends.physics.separation import NEAR_MISS, Separation
from remac_env.backends.physics.ways import SAMPLE, Driver, Moving, Way, held_pose, ways_to
from remac_env.kitchen.blocks import Block
from remac_env.kitchen.floor_plan import Station
from remac_env.robots.rotation import Array

_LANES = 3  # ways of one sort that are tried where several robots drive
_APART = NEAR_MISS + 0.005  # m


@dataclass(frozen=True)
class DriveGoal:
    """One robot's drive: its workspace and where it is to end, world frame."""

    here: Workspace
    goal: Station


class Drives:
    """Drives that begin together, with what they must keep clear of; ``drivers`` are the robots with their ways.

    ``rooms``: the floor that robots need which work meanwhile; drives keep off it. ``avoided``: objects on the floor to
    drive around. ``moving``: drives that are under way.
    """

    def __init__(
        self, separation: Separation, drive_goals: Mapping[str, DriveGoal], rooms: Sequence[Block],
        avoided: frozenset[str] = frozenset(), moving: Sequence[Moving] = (),
    ) -> None:
        self._separation, self._drive_goals, self._rooms, self._avoided = separation, drive_goals, tuple(rooms), avoided
        self._moving = {drive.name: drive for drive in moving}
        self._staying = set(separation.robots) - set(drive_goals) - set(self._moving)
        self._met: dict[tuple[Way, Way], Encounter] = {}
        self.drivers: Mapping[str, Driver] = {}

    def _driver(self, drive_goal: DriveGoal) -> Driver:
        """All ways of one robot, not yet checked."""
        here = drive_goal.here
        here.begin(avoid=self._avoided)
        for robot, body in self._separation.held.items():
            if robot != here.robot.name:
                here.clear.checker.mark(here.sensed.geoms(body), IGNORED)  # it goes where that robot goes
        layout, standing, litter = here.kitchen.layout, self._standing(), self._litter(here)
        footprint = here.robot.body.footprint
        start = Departure(layout, here.place, here.robot.q, self._rooms, standing, litter, footprint=footprint)
        outline, obstacles = Outline.of(here), here.clear.checker.obstacles()
        return Driver(here, ways_to(start, drive_goal.goal, here.robot.body), outline, obstacles, drive_goal.goal)

    def _standing(self) -> tuple[Array, ...]:
        """Base poses (3,) of robots that stay, and of those under way where they end."""
        staying = tuple(place for name, place in self._separation.places.items() if name in self._staying)
        return staying + tuple(moving.bases[-1] for moving in self._moving.values())

    def _litter(self, here: Workspace) -> tuple[Block, ...]:
        return blocks(here, self._avoided - {here.hand.body})

    def _path(self, driver: Driver, way: Way) -> Path | None:
        """The way as a path, one configuration a period, where it meets no furniture and nobody who stays."""
        if not way.checked:
            way.checked = True
            here, corners = driver.here, way.course.corners
            path = sampled(corners, here.robot.body)
            bases = np.array(path[::4])[:, :3]
            met = any(driver.outline.meets(bases, room) for room in self._rooms)
            if not met and self._free(driver, corners) and self._keeps_off(driver, path, self._staying):
                way.path = path
        return way.path

    @staticmethod
    def _free(driver: Driver, corners: Path) -> bool:
        """Whether a way meets no furniture; looked at closely only where boxes around it and the robot's parts meet."""
        clear = driver.here.clear

        def sure(configurations: Array) -> NDArray[np.bool_]:
            if clear.checker.keep_out:
                return np.zeros(len(configurations), bool)
            return driver.outline.clear(configurations[:, :3], driver.obstacles)

        with clear.checker.without_robots():
            return all(clear.planner.edge(one, other, 0.1, sure=sure) for one, other in pairwise(corners))

    def _keeps_off(self, driver: Driver, path: Path, standing: Collection[str]) -> bool:
        """Whether a path keeps clear of robots that stand where they are."""
        circles = self._separation.circles(standing)
        if not len(circles):
            return True
        moments = [*path[::SAMPLE], path[-1]]
        middles, radii = driver.outline.circles(np.array(moments)[:, :3])
        gaps = distances(middles[:, :, None], circles[:, :2]) - radii[:, None] - circles[:, 2]
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

    def _passes(self, driver: Driver, way: Way, delay: int) -> bool:
        """Whether a way, begun so many samples late, keeps clear of all drives that are under way."""
        for name, moving in self._moving.items():
            pair = {driver.here.robot.name: driver, name: moving.driver}
            if not self._encounter(pair, list(pair), (0, way), (1, moving.way), self._met).passes((delay, 0)):
                return False
        return True

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
        without = set(self._separation.robots) - now.keys() - set(standing)
        return self._separation.of_configurations(now, held, without) >= _APART
