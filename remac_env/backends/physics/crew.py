"""The robots of an episode: their surroundings, and the attempts they make in a round, side by side."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from remac_env.backends.physics import dispatch
from remac_env.backends.physics.collision import Fence, Scratch
from remac_env.backends.physics.litter import lying, pressed
from remac_env.backends.physics.motion import Mover, StuckError
from remac_env.backends.physics.navigate import parking
from remac_env.backends.physics.paths import Planner
from remac_env.backends.physics.separation import Separation
from remac_env.backends.physics.simulation import CONTROL_PERIOD, Simulation, View
from remac_env.backends.physics.skill import Hand, SkillFailure, Steps, Surroundings, go_home
from remac_env.backends.physics.traffic import Convoy, Errand
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.layout_checks import work_floor
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots.ik import Kinematics
from remac_env.rules.facts import ASIDE
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import Subtask
from remac_env.seeding import generator
from remac_env.start import Start
from remac_env.state import WorldState

SKILL_TIME = 60.0  # s, after which a skill is stopped
_RECOVERY_TIME = 20.0  # s for coming home after a failure
_NEIGHBOUR = 1.3  # m between stations whose robots could reach one another
_ARRIVAL = np.array([0.02, 0.02, 0.03])  # m, m, rad: how far off a drive ends at most; known to the robot afterwards
_DETOURS = 3  # times that a drive starts anew which things on the floor have stopped
_THOUGHT = 20  # control periods within which a skill has only planned and closed or opened its hand

Attempt = Generator[None, None, Outcome]


@dataclass(frozen=True)
class Round:
    """What a round asks for: the accepted subtasks, where every robot ends, the world before, and its number.

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


class Crew:
    """All robots. ``robots`` holds each one's surroundings by name."""

    def __init__(
        self, simulation: Simulation, layout: Layout, things: Mapping[str, Category], start: Start
    ) -> None:
        self._simulation, self._layout, self._start = simulation, layout, start
        self.separation = Separation(simulation)
        self._busy: set[str] = set()
        self._waiting: dict[str, tuple[float, float]] = {}
        kinematics = Kinematics()
        self.robots: dict[str, Surroundings] = {}
        for name, robot in simulation.robots.items():
            view = View(simulation, robot)
            scratch = Scratch(view, robot, kinematics)
            planner = Planner(scratch, np.random.default_rng(0))
            x, y, yaw = (float(value) for value in robot.q[:3])
            self.robots[name] = Surroundings(
                view, robot, layout, things, kinematics, scratch, planner, Mover(robot, kinematics), Hand(),
                Station(ASIDE, x, y, yaw),
            )

    def hold(self, things: Mapping[str, str | None]) -> None:
        """Tell every robot what its hand holds now."""
        for name, here in self.robots.items():
            here.hand.body = things[name]

    def attempts(self, now: Round) -> dict[str, Attempt]:
        """A generator for every robot with an accepted subtask; each returns its outcome."""
        self._busy, self._waiting = now.active, {}
        self.separation.holding({n: here.hand.body for n, here in self.robots.items() if here.hand.body is not None})
        self._set_fences(now)
        self._disturb(now)
        goals = {name: self._arrival(now.number, place) for name, place in self._goals(now).items()}
        errands = {name: Errand(self.robots[name], goal) for name, goal in goals.items()}
        working = [
            work_floor(self._layout.facing(here.place), here.place)
            for name, here in self.robots.items()
            if name not in now.driving and here.place.wall
        ]
        convoy = Convoy(self.separation, errands, working)
        found: dict[str, Attempt] = {}
        for robot, subtask in now.subtasks.items():
            if robot in now.driving:
                found[robot] = self._drive(convoy, robot, errands.get(robot))
            elif robot in now.active:
                found[robot] = self._skill(robot, subtask, now)
            else:
                found[robot] = _nothing()
        return found

    def finished(self, robot: str) -> None:
        """Note that a robot's attempt has ended."""
        self._busy.discard(robot)

    # -- before a round ---------------------------------------------------------------------------------------------

    def _set_fences(self, now: Round) -> None:
        """Fences between robots that work at neighbouring stations, or next to where another drives."""
        for name, here in self.robots.items():
            here.scratch.fences = ()
            if name in now.driving:
                continue
            for other in sorted(now.active - {name}):
                there = self.robots[other].place
                for end in (there, self._layout.stations.get(now.stations[other], there)):
                    if end.wall and 0.0 < here.place.distance(end) <= _NEIGHBOUR:
                        here.scratch.fences += (_between(here.place, end),)

    def _disturb(self, now: Round) -> None:
        """Draw the errors in the poses that controllers see."""
        noise = self._start.perception_noise
        if not noise:
            return
        for here in self.robots.values():
            place = [round(float(value), 3) for value in here.robot.standing[:2]]
            chance = generator(self._start.seed, "perception", now.number, *place)
            here.simulation.perception.draw(chance, noise, self._layout, here.things, here.hand.body)
            if here.hand.body is not None:
                here.simulation.hold(here.hand.body)
            here.scratch.look()

    def _goals(self, now: Round) -> dict[str, Station]:
        """Where driving robots go; those that step aside and find no free parking place are left out."""
        going = sorted(now.driving)
        to_stations = {r: self._layout.stations[now.stations[r]] for r in going if now.stations[r] != ASIDE}
        away = {r: self.robots[r].robot.standing for r in going if now.stations[r] == ASIDE}
        taken = {name: here.robot.standing for name, here in self.robots.items() if name not in now.driving}
        return to_stations | parking(self._layout, away, taken)

    def _arrival(self, number: int, place: Station) -> Station:
        """Where a drive to a place really ends: a little off, so that skills start from stances never seen before."""
        chance = generator(self._start.seed, "arrival", number, place.name)
        dx, dy, turn = (float(value) for value in chance.uniform(-1.0, 1.0, 3) * _ARRIVAL)
        return replace(place, x=place.x + dx, y=place.y + dy, yaw=place.yaw + turn)

    # -- attempts ---------------------------------------------------------------------------------------------------

    def _drive(self, convoy: Convoy, robot: str, errand: Errand | None) -> Attempt:
        """Go with the convoy; a robot that cannot pass those at work waits until they are done.

        So does one that was stopped by things on the floor, or whose convoy was; then it looks for another way.
        """
        if errand is None:
            return failure("blocked", "no parking place is free")
        outcome = yield from self._bounded(robot, convoy.steps(robot), SKILL_TIME)
        if outcome.reason == "blocked" and convoy.held_up(robot):
            yield from self._turn(robot)
            convoy = Convoy(self.separation, {robot: errand}, ())
            outcome = yield from self._bounded(robot, convoy.steps(robot), SKILL_TIME)
        for _ in range(_DETOURS):
            if outcome.success or not convoy.jammed:
                break
            yield from self._turn(robot)
            convoy = Convoy(self.separation, {robot: errand}, (), convoy.jammed)
            outcome = yield from self._bounded(robot, convoy.steps(robot), SKILL_TIME)
        return outcome

    def _skill(self, robot: str, subtask: Subtask, now: Round) -> Attempt:
        """Run a skill within its time; after a failure come home if that can be done.

        A skill that finds no way within the fence towards a robot working next to it waits until that one is done; then
        it goes on, by way of its home pose if it has begun to move.
        """
        here, began = self.robots[robot], self._simulation.ticks
        here.planner.random = generator(self._start.seed, "search", now.number, subtask.text)
        outcome = yield from self._among_litter(robot, subtask, now)
        if here.scratch.fences and outcome.reason in ("blocked", "unreachable"):
            moved = self._simulation.ticks - began > _THOUGHT
            yield from self._turn(robot)
            here.scratch.fences = ()
            if moved:
                here.robot.q = here.robot.measured
                outcome = yield from self._bounded(robot, go_home(here), _RECOVERY_TIME)
            if not moved or (outcome.success and not now.achieved(robot, subtask)):
                outcome = yield from self._bounded(robot, self._motion(robot, subtask, now), SKILL_TIME)
        if not outcome.success and outcome.reason != "door_closed":
            here.robot.q = here.robot.measured
            yield from self._bounded(robot, go_home(here), _RECOVERY_TIME)
        return outcome

    def _among_litter(self, robot: str, subtask: Subtask, now: Round) -> Attempt:
        """Run a skill clear of what lies on the floor; try again once that has been pushed away, in the end over it."""
        here = self.robots[robot]
        for last in (False, False, True):
            litter = lying(here)
            if litter and not last:
                here.begin(avoid=litter)
                here.keep_off = litter if here.scratch.free(here.robot.q) else litter - pressed(here)
            outcome = yield from self._bounded(robot, self._motion(robot, subtask, now), SKILL_TIME)
            here.keep_off = frozenset()
            if last or not litter or outcome.reason not in ("blocked", "unreachable"):
                break
            here.robot.q = here.robot.measured
            home = yield from self._bounded(robot, go_home(here), _RECOVERY_TIME)
            if not home.success or now.achieved(robot, subtask):
                break
        return outcome

    def _motion(self, robot: str, subtask: Subtask, now: Round) -> Steps:
        return dispatch.motion(self.robots[robot], self._start.scene, now.world, robot, subtask)

    def _turn(self, robot: str) -> Steps:
        """Wait until every other robot is done; of robots that all wait the leftmost goes first."""
        place = self.robots[robot].place
        self._waiting[robot] = (place.x, place.y)
        for _ in range(int(2 * SKILL_TIME / CONTROL_PERIOD)):
            others = self._busy - {robot}
            first = min(self._waiting, key=lambda name: self._waiting[name])
            if not others or (others <= self._waiting.keys() and first == robot):
                break
            yield
        del self._waiting[robot]

    def _bounded(self, robot: str, steps: Steps, seconds: float) -> Attempt:
        """Run steps for at most so long; failures become outcomes."""
        here = self.robots[robot]
        for _ in range(int(seconds / CONTROL_PERIOD)):
            try:
                next(steps)
            except StopIteration:
                return Outcome("success")
            except SkillFailure as failed:
                return failure(failed.reason, failed.detail)
            except StuckError as stuck:
                here.robot.q = here.robot.measured
                return failure("blocked", str(stuck))
            yield
        steps.close()
        return failure("timeout", f"not done after {seconds:.0f} s")


def _between(here: Station, there: Station) -> Fence:
    """The fence half way between two stations, seen from the first."""
    way = here.distance(there)
    x, y = (there.x - here.x) / way, (there.y - here.y) / way
    return Fence(x, y, x * here.x + y * here.y + 0.5 * way)


def _nothing() -> Attempt:
    return Outcome("success")
    yield
