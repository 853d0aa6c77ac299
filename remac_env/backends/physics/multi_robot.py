"""Drives robots at the same time, along paths that keep them apart all the time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from remac_env.backends.physics.controllers.scripted.motion import StuckError
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure, Steps
from remac_env.backends.physics.drives import DriveGoal
from remac_env.backends.physics.litter import Bumper, lying, pressed, retreat, slowed
from remac_env.backends.physics.separation import Separation
from remac_env.backends.physics.timetable import Timetable
from remac_env.backends.physics.ways import Driver, Moving
from remac_env.kitchen.blocks import Block


class MultiRobotPlanner:
    """Drives that begin together. They are planned when the first of them begins; run every robot's ``steps``.

    ``rooms``: the floor that robots need which work meanwhile; drives keep off it. ``jammed``: objects on the floor
    that have stopped a drive; it grows when these drives are stopped. ``others``: planners of which some may be under
    way; their drives are moving obstacles, and where one of these or those fails, all of both stop.
    """

    def __init__(
        self, separation: Separation, drive_goals: Mapping[str, DriveGoal], rooms: Sequence[Block],
        jammed: frozenset[str] = frozenset(), others: Sequence[MultiRobotPlanner] = (),
    ) -> None:
        self._separation, self._drive_goals, self._rooms = separation, dict(drive_goals), tuple(rooms)
        self.jammed, self._others = jammed, others
        self._timed: dict[str, Path] | None = None
        self._drivers: Mapping[str, Driver] = {}
        self._gone: dict[str, int] = {}
        self._met: list[MultiRobotPlanner] = []
        self._pushing = self._failed = False

    def keep_off(self, rooms: Sequence[Block]) -> None:
        """Take note of the floor that robots need by now, where these drives have not been planned yet."""
        if self._timed is None:
            self._rooms = tuple(rooms)

    def held_up(self, robot: str) -> bool:
        """Whether a robot found no way while others work or drive."""
        others = self._rooms or self._met or (self._timed and len(self._drive_goals) > 2)
        return bool(others) and self._timed is not None and robot not in self._timed

    def under_way(self) -> Iterator[Moving]:
        """The drives that have been planned and have not ended, with what is left of them."""
        for robot, gone in self._gone.items():
            # The last of those gone is commanded in this very period.
            yield Moving.along(self._drivers[robot], (self._timed or {})[robot][max(gone - 1, 0) :])

    def steps(self, robot: str) -> Steps:
        """Drive one robot. Fails with ``blocked`` when there is no way, or when another's drive fails."""
        if self._timed is None:
            self._timed = self._plan()
            self._gone = dict.fromkeys(self._timed, 0)
        here = self._drive_goals[robot].here
        try:
            if robot not in self._timed:
                others = "the other robot" if len(self._separation.robots) < 3 else "the other robots"
                raise SkillFailure("blocked", f"no way that keeps clear of {others} and the furniture")
            yield from self._drive(robot, self._timed[robot])
        except BaseException:
            if robot in self._timed:
                self._fail()
            here.enter(here.place)
            raise
        finally:
            self._gone.pop(robot, None)
        here.enter(self._drive_goals[robot].goal)

    def _fail(self) -> None:
        """Stop all these drives, and those that count on them."""
        for planner in (self, *self._met):
            planner._failed = True

    def _drive(self, robot: str, path: Path) -> Steps:
        """Follow a path; where objects on the floor stop it, go back a little."""
        here = self._drive_goals[robot].here
        bumper, travelled = Bumper(here), Path()
        try:
            for q in path:
                if self._failed:
                    raise SkillFailure("blocked", "another robot's drive failed")
                travelled.append(q)
                self._gone[robot] += 1
                yield from here.mover.step(q)
                if self._pushing:
                    bumper.check()
            yield from here.mover.settle(0.004, 8)
        except (StuckError, SkillFailure):
            self._fail()
            self.jammed |= pressed(here)
            yield from retreat(here, travelled)
            raise

    def _plan(self) -> dict[str, Path]:
        """A timed path for every robot that can go: around objects on the floor, else through those not yet jammed."""
        for drive_goal in self._drive_goals.values():
            drive_goal.here.leave()
        for other in self._others:
            if other is not self and any(True for _ in other.under_way()):
                self._met.append(other)
                other._met.append(self)
        self._failed = any(other._failed for other in self._met)
        moving = [drive for other in self._met for drive in other.under_way()]
        litter = frozenset[str]().union(*(lying(drive_goal.here) for drive_goal in self._drive_goals.values()))
        timed: dict[str, Path] = {}
        avoided = litter
        # A drive that pushes objects is not where it should be when, so nobody pushes while others are under way.
        pushing = () if moving else (self.jammed & litter, frozenset[str]())
        for avoided in dict.fromkeys((litter, *pushing)):
            timetable = Timetable(self._separation, self._drive_goals, self._rooms, avoided, moving)
            timed, self._drivers = timetable.timed(), timetable.drivers
            if len(timed) == len(self._drive_goals):
                break
        self._pushing = avoided != litter
        return {name: slowed(path) for name, path in timed.items()} if self._pushing else timed
