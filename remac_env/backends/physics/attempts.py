"""What robots have begun, side by side: each attempt is a generator that returns its outcome.

Who begins while others are busy keeps clear of them: drives that are under way are moving obstacles for a new one, and
whoever would work or go next to a robot at work that has no fence towards it, or work where a drive comes by, waits.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass

from remac_env.backends.physics.controllers.scripted.skill import Surroundings
from remac_env.backends.physics.drives import Errand
from remac_env.backends.physics.litter import lying, pressed
from remac_env.backends.physics.pilot import SKILL_TIME, Attempt, Pilot
from remac_env.backends.physics.sensing import Briefed
from remac_env.backends.physics.separation import Separation
from remac_env.backends.physics.simulation import CONTROL_PERIOD, Simulation
from remac_env.backends.physics.traffic import Convoy
from remac_env.kitchen.blocks import Block
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.layout_checks import work_floor
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState

_DETOURS = 3  # times that a drive starts anew which things on the floor have stopped
_THOUGHT = 20  # control periods within which a skill has only planned and closed or opened its hand
Waiting = Generator[None, None, None]

NEIGHBOUR = 1.3  # m between stations whose robots could reach one another


@dataclass(frozen=True)
class Orders:
    """What begins together: the accepted subtasks, where every robot ends, the world before, and a running number.

    ``achieved``: whether a robot's subtask has, by now, done what it says.
    """

    number: int
    world: WorldState
    subtasks: Mapping[str, Subtask]
    stations: Mapping[str, str]
    achieved: Callable[[str, Subtask], bool]

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
    """Who was busy when others began: robots at work at their stations, and all convoys, later ones among them."""

    working: frozenset[str] = frozenset()
    convoys: Sequence[Convoy] = ()

    def __bool__(self) -> bool:
        return bool(self.working or self.convoys)


class Attempts:
    """Runs subtasks of ``robots``. ``aims``: robot -> where it will stand, of those that drive (None: nowhere)."""

    def __init__(
        self, simulation: Simulation, separation: Separation, pilots: Mapping[str, Pilot], layout: Layout
    ) -> None:
        self._simulation, self._separation, self._layout = simulation, separation, layout
        self._pilots = pilots
        self._robots: dict[str, Surroundings] = {name: pilot.here for name, pilot in pilots.items()}
        self.aims: dict[str, Station | None] = {}
        self._busy: set[str] = set()  # without those that have begun and still give way
        self._working: set[str] = set()
        self._convoys: list[Convoy] = []
        self._waiting: dict[str, tuple[float, float]] = {}

    def begin(self, now: Orders, goals: Mapping[str, Station]) -> dict[str, Attempt]:
        """A generator for every robot with an accepted subtask; each returns its outcome. ``goals``: of drives."""
        earlier = Earlier(frozenset(self._working), self._convoys) if self._working or self.aims else Earlier()
        if not earlier:
            self._busy, self._waiting, self._convoys = set(), {}, []
        self._busy |= now.active
        self._working |= now.active - now.driving
        self.aims |= {name: goals.get(name) for name in now.driving}
        own = {name: self._pilots[name].own.get(subtask.skill) for name, subtask in now.subtasks.items()}
        errands = {name: Errand(self._robots[name], goal) for name, goal in goals.items() if own[name] is None}
        convoy = self._convoy(errands, self._rooms())
        found: dict[str, Attempt] = {}
        for robot, subtask in now.subtasks.items():
            controller, pilot = own[robot], self._pilots[robot]
            if robot in now.driving and controller is not None:
                briefed = pilot.briefed(now.number, subtask, now.world, goals.get(robot))
                found[robot] = pilot.drive(controller, subtask, briefed)
            elif robot in now.driving:
                found[robot] = self._drive(convoy, robot, errands, earlier)
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

    def _convoy(
        self, errands: Mapping[str, Errand], rooms: Sequence[Block], jammed: frozenset[str] = frozenset()
    ) -> Convoy:
        convoy = Convoy(self._separation, errands, rooms, jammed, self._convoys)
        self._convoys.append(convoy)
        return convoy

    def _drive(self, convoy: Convoy, robot: str, errands: Mapping[str, Errand], earlier: Earlier) -> Attempt:
        """Go with the convoy; a robot that cannot pass those at work waits until they are done.

        So does one that was stopped by things on the floor, or whose convoy was; then it looks for another way.
        """
        errand = errands.get(robot)
        if errand is None:
            return failure("blocked", "no parking place is free")
        if earlier:
            # Drives that begin together are planned together, so they wait together too.
            ends = [end for each in errands.values() for end in (each.here.place, each.goal)]
            yield from self._give_way(robot, lambda: self._beside(ends, earlier))
            convoy.keep_off(self._rooms())
        outcome = yield from self._pilots[robot].steps(convoy.steps(robot), SKILL_TIME)
        if outcome.reason == "blocked" and convoy.held_up(robot):
            yield from self._turn(robot)
            convoy = self._convoy({robot: errand}, ())
            outcome = yield from self._pilots[robot].steps(convoy.steps(robot), SKILL_TIME)
        for _ in range(_DETOURS):
            if outcome.success or not convoy.jammed:
                break
            yield from self._turn(robot)
            convoy = self._convoy({robot: errand}, (), convoy.jammed)
            outcome = yield from self._pilots[robot].steps(convoy.steps(robot), SKILL_TIME)
        return outcome

    def _skill(self, robot: str, subtask: Subtask, now: Orders, earlier: Earlier) -> Attempt:
        """Run a skill within its time; after a failure come home if that can be done.

        A skill that finds no way within the fence towards a robot working next to it waits until that one is done; then
        it goes on, by way of its home pose if it has begun to move.
        """
        here, pilot = self._robots[robot], self._pilots[robot]
        if earlier:
            place = here.place
            yield from self._give_way(
                robot, lambda: self._beside((place,), earlier) or self._crossed(place, earlier)
            )
        began = self._simulation.ticks
        sensing, own = pilot.briefed(now.number, subtask, now.world), pilot.own.get(subtask.skill)
        if own is not None:
            return (yield from pilot.skill(own, subtask, sensing))
        outcome = yield from self._among_litter(robot, subtask, sensing, now)
        if here.scratch.fences and outcome.reason in ("blocked", "unreachable"):
            moved = self._simulation.ticks - began > _THOUGHT
            yield from self._turn(robot)
            here.scratch.fences = ()
            if moved:
                outcome = yield from pilot.home()
            if not moved or (outcome.success and not now.achieved(robot, subtask)):
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
                here.keep_off = litter if here.scratch.free(here.robot.q) else litter - pressed(here)
            outcome = yield from pilot.scripted(subtask, sensing)
            here.keep_off = frozenset()
            if last or not litter or outcome.reason not in ("blocked", "unreachable"):
                break
            home = yield from pilot.home()
            if not home.success or now.achieved(robot, subtask):
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
        """Whether a robot that began earlier is still at work next to one of these places."""
        working = [self._robots[name].place for name in earlier.working & self._working]
        return any(
            place.wall and other.wall and place.distance(other) <= NEIGHBOUR for place in places for other in working
        )

    def _crossed(self, place: Station, earlier: Earlier) -> bool:
        """Whether a drive that is under way still comes by where one works at this place."""
        if not place.wall:
            return False
        room = work_floor(self._layout.facing(place), place)
        drives = [drive for convoy in earlier.convoys for drive in convoy.under_way()]
        return any(drive.driver.outline.meets(drive.bases, room) for drive in drives)


def _nothing() -> Attempt:
    return Outcome("success")
    yield
