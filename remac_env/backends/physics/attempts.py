"""What robots have begun, side by side: each attempt is a generator that returns its outcome.

Who begins while others are busy keeps clear of them: drives that are under way are moving obstacles for a new one, and
whoever would work or go next to a robot at work that has no keep-out plane towards it, or work where a drive comes by,
waits.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass

from remac_env.backends.physics.controllers.scripted.collision import KeepOutPlane
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.drives import DriveGoal
from remac_env.backends.physics.litter import lying, pressed
from remac_env.backends.physics.multi_robot import MultiRobotPlanner
from remac_env.backends.physics.pilot import SKILL_TIME, Attempt, Pilot
from remac_env.backends.physics.sensing import Briefed
from remac_env.backends.physics.separation import Separation
from remac_env.backends.physics.simulation import CONTROL_PERIOD, Simulation
from remac_env.kitchen.blocks import Block
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.layout_checks import work_floor
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState

_DETOURS = 3  # times that a drive starts anew which objects on the floor have stopped
_THOUGHT = 20  # control periods within which a skill has only planned and closed or opened its hand
Waiting = Generator[None, None, None]

_SHARE = 0.4  # of the way between two robots that stays with one that stands there: half, but for how drives end
NEIGHBOUR = 1.3  # m between stations whose robots could reach one another


@dataclass(frozen=True)
class Orders:
    """What begins together: the accepted subtasks, where every robot ends, the world before, and a running number.

    ``achieved``: whether a robot's subtask has, by now, done what it says. ``hindered``: whether a quirk has kept it
    from that; then nothing is tried again within a subtask, as to try again is for who gives the next one.
    """

    number: int
    world: WorldState
    subtasks: Mapping[str, Subtask]
    stations: Mapping[str, str]
    achieved: Callable[[str], bool]
    hindered: Callable[[Subtask], bool]

    @property
    def active(self) -> set[str]:
        """Robots that move."""
        return {robot for robot, subtask in self.subtasks.items() if not subtask.row.still}

    @property
    def driving(self) -> set[str]:
        """Robots that go to another station."""
        return {robot for robot, subtask in self.subtasks.items() if subtask.moves}


@dataclass(frozen=True)
class Earlier:
    """Who was busy when others began: robots at work at their stations, and all planners, later ones among them."""

    working: frozenset[str] = frozenset()
    planners: Sequence[MultiRobotPlanner] = ()

    def __bool__(self) -> bool:
        return bool(self.working or self.planners)


class Attempts:
    """Runs subtasks of ``robots``. ``aims``: robot -> where it will stand, of those that drive (None: nowhere)."""

    def __init__(
        self, simulation: Simulation, separation: Separation, pilots: Mapping[str, Pilot], layout: Layout
    ) -> None:
        self._simulation, self._separation, self._layout = simulation, separation, layout
        self._pilots = pilots
        self._robots: dict[str, Workspace] = {name: pilot.here for name, pilot in pilots.items()}
        self.aims: dict[str, Station | None] = {}
        self._busy: set[str] = set()  # without those that have begun and still give way
        self._working: set[str] = set()
        self._planners: list[MultiRobotPlanner] = []
        self._waiting: dict[str, tuple[float, float]] = {}

    def begin(self, now: Orders, goals: Mapping[str, Station]) -> dict[str, Attempt]:
        """A generator for every robot with an accepted subtask; each returns its outcome. ``goals``: of drives."""
        earlier = Earlier(frozenset(self._working), self._planners) if self._working or self.aims else Earlier()
        if not earlier:
            self._busy, self._waiting, self._planners = set(), {}, []
        self._busy |= now.active
        self._working |= now.active - now.driving
        self.aims |= {name: goals.get(name) for name in now.driving}
        own = {
            name: self._pilots[name].own_for(now.number, subtask, now.world, goals.get(name))
            for name, subtask in now.subtasks.items()
        }
        drive_goals = {name: DriveGoal(self._robots[name], goal) for name, goal in goals.items() if own[name] is None}
        planner = self._planner(drive_goals, self._rooms())
        found: dict[str, Attempt] = {}
        for robot, subtask in now.subtasks.items():
            controller, pilot = own[robot], self._pilots[robot]
            if robot in now.driving and controller is not None:
                briefed = pilot.briefed(now.number, subtask, now.world, goals.get(robot))
                found[robot] = pilot.drive(controller, subtask, briefed)
            elif robot in now.driving:
                found[robot] = self._drive(planner, robot, drive_goals, earlier)
            elif robot in now.active:
                found[robot] = self._skill(robot, subtask, now, earlier)
            else:
                found[robot] = _nothing()
        return found

    def finished(self, robot: str) -> None:
        """Note that a robot's attempt has ended."""
        self._busy.discard(robot)
        self._working.discard(robot)
        self.aims.pop(robot, None)

    @property
    def under_way(self) -> set[str]:
        """Robots that are busy with more than waiting."""
        return self._working | self.aims.keys()

    def _rooms(self) -> list[Block]:
        """The floor that robots need which stand at their stations and may work there."""
        standing = (here.place for name, here in self._robots.items() if name not in self.aims)
        return [work_floor(self._layout.facing(place), place) for place in standing if place.wall]

    def _planner(
        self, drive_goals: Mapping[str, DriveGoal], rooms: Sequence[Block], jammed: frozenset[str] = frozenset()
    ) -> MultiRobotPlanner:
        planner = MultiRobotPlanner(self._separation, drive_goals, rooms, jammed, self._planners)
        self._planners.append(planner)
        return planner

    def _drive(
        self, planner: MultiRobotPlanner, robot: str, drive_goals: Mapping[str, DriveGoal], earlier: Earlier
    ) -> Attempt:
        """Go with the planner; a robot that cannot pass those at work waits until they are done.

        So does one that was stopped by objects on the floor, or whose planner was; then it looks for another way.
        """
        drive_goal = drive_goals.get(robot)
        if drive_goal is None:
            return failure("blocked", "no parking place is free")
        if earlier:
            # Drives that begin together are planned together, so they wait together too.
            ends = [end for each in drive_goals.values() for end in (each.here.place, each.goal)]
            yield from self._give_way(robot, lambda: self._beside(ends, earlier))
            planner.keep_off(self._rooms())
        outcome = yield from self._pilots[robot].steps(planner.steps(robot), SKILL_TIME)
        if outcome.reason == "blocked" and planner.held_up(robot):
            yield from self._turn(robot)
            planner = self._planner({robot: drive_goal}, ())
            outcome = yield from self._pilots[robot].steps(planner.steps(robot), SKILL_TIME)
        for _ in range(_DETOURS):
            if outcome.success or not planner.jammed:
                break
            yield from self._turn(robot)
            planner = self._planner({robot: drive_goal}, (), planner.jammed)
            outcome = yield from self._pilots[robot].steps(planner.steps(robot), SKILL_TIME)
        return outcome

    def _skill(self, robot: str, subtask: Subtask, now: Orders, earlier: Earlier) -> Attempt:
        """Run a skill within its time; after a failure come home if that can be done.

        A skill that finds no way behind the keep-out plane towards a robot working next to it waits until that one is
        done; then it goes on, by way of its home pose if it has begun to move.
        """
        here, pilot = self._robots[robot], self._pilots[robot]
        pilot.stopping = False
        if earlier:
            place = here.place
            yield from self._give_way(
                robot, lambda: self._beside((place,), earlier) or self._crossed(place, earlier)
            )
        began = self._simulation.ticks
        sensing, own = pilot.briefed(now.number, subtask, now.world), pilot.own_for(now.number, subtask, now.world)
        if own is not None:
            return (yield from pilot.skill(own, subtask, sensing, lambda: now.hindered(subtask)))
        outcome = yield from self._among_litter(robot, subtask, sensing, now)
        if here.clear.checker.keep_out and _no_way(outcome) and not now.hindered(subtask):
            moved = self._simulation.ticks - began > _THOUGHT
            yield from self._turn(robot)
            here.clear.checker.keep_out = ()
            if moved:
                outcome = yield from pilot.home()
            if not moved or (outcome.success and not now.achieved(robot)):
                outcome = yield from pilot.scripted(subtask, sensing)
        if not outcome.success and outcome.reason != "door_closed":
            yield from pilot.home()
        return outcome

    def _among_litter(self, robot: str, subtask: Subtask, sensing: Briefed, now: Orders) -> Attempt:
        """Run a skill clear of what lies on the floor; try again once that has been pushed away, in the end over it."""
        here, pilot = self._robots[robot], self._pilots[robot]
        for last in (False, False, True):
            litter = lying(here)
            if litter and not last:
                here.begin(avoid=litter)
                here.clear.litter = litter if here.clear.checker.free(here.robot.q) else litter - pressed(here)
            outcome = yield from pilot.scripted(subtask, sensing)
            here.clear.litter = frozenset()
            if last or not litter or not _no_way(outcome) or now.hindered(subtask):
                break
            home = yield from pilot.home()
            if not home.success or now.achieved(robot):
                break
        return outcome

    def _turn(self, robot: str) -> Waiting:
        """Wait until every other robot is done; of robots that all wait the leftmost goes first."""
        place = self._robots[robot].place
        self._waiting[robot] = (place.x, place.y)
        for _ in range(int(2 * SKILL_TIME / CONTROL_PERIOD)):
            others = self._busy - {robot}
            first = min(self._waiting, key=lambda name: self._waiting[name])
            if not others or (others <= self._waiting.keys() and first == robot):
                break
            yield
        del self._waiting[robot]

    def _give_way(self, robot: str, hindered: Callable[[], bool]) -> Waiting:
        """Wait for robots that began earlier; none of those waits for this one."""
        while hindered():
            self._busy.discard(robot)
            yield
        self._busy.add(robot)

    def _beside(self, places: Sequence[Station], earlier: Earlier) -> bool:
        """Whether a robot that began earlier is still at work next to one of these places, free to reach over there."""
        working = [self._robots[name] for name in earlier.working & self._working]
        return any(
            place.wall
            and other.place.wall
            and place.distance(other.place) <= NEIGHBOUR
            and not any(keeps_from(plane, other.place, place) for plane in other.clear.checker.keep_out)
            for place in places
            for other in working
        )

    def _crossed(self, place: Station, earlier: Earlier) -> bool:
        """Whether a drive that is under way still comes by where one works at this place."""
        if not place.wall:
            return False
        room = work_floor(self._layout.facing(place), place)
        drives = [drive for planner in earlier.planners for drive in planner.under_way()]
        return any(drive.driver.outline.meets(drive.bases, room) for drive in drives)


def keep_out_plane(here: Station, there: Station) -> KeepOutPlane:
    """The keep-out plane half way between two stations, seen from the first."""
    way = here.distance(there)
    x, y = (there.x - here.x) / way, (there.y - here.y) / way
    return KeepOutPlane(x, y, x * here.x + y * here.y + 0.5 * way)


def keeps_from(plane: KeepOutPlane, here: Station, there: Station) -> bool:
    """Whether a plane keeps a robot at the first place out of about half the way to the second one."""
    return plane.x * there.x + plane.y * there.y - plane.limit >= _SHARE * here.distance(there)


def _no_way(outcome: Outcome) -> bool:
    return outcome.reason in ("blocked", "unreachable")


def _nothing() -> Attempt:
    return Outcome("success")
    yield
