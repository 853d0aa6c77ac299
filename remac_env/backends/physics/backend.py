"""The physics backend: every robot's skill is a generator, all of them run on one simulated clock."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import replace
from functools import lru_cache

import mujoco
import numpy as np

from remac_env.backends.base import Counters, RoundResult
from remac_env.backends.physics import dispatch
from remac_env.backends.physics.collision import Scratch
from remac_env.backends.physics.motion import Mover, StuckError
from remac_env.backends.physics.navigate import base_pose, parking
from remac_env.backends.physics.paths import Planner
from remac_env.backends.physics.separation import NEAR_MISS, Separation
from remac_env.backends.physics.simulation import CONTROL_PERIOD, SUBSTEPS, Simulation
from remac_env.backends.physics.skill import Hand, SkillFailure, Steps, Surroundings, go_home
from remac_env.backends.physics.snapshot import read_world
from remac_env.backends.physics.stage import pose_start
from remac_env.backends.physics.traffic import Convoy, Errand, Rooms
from remac_env.errors import LifecycleError
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.layout import Station
from remac_env.kitchen.objects import catalogue
from remac_env.robots.ik import Kinematics
from remac_env.rounds import NAVIGATION, settle_claims
from remac_env.seeding import generator
from remac_env.start import Start
from remac_env.state import ASIDE, WorldState
from remac_env.subtasks import Outcome, Subtask, failure

SKILL_TIME = 60.0  # s, after which a skill is stopped
_RECOVERY_TIME = 20.0  # s for coming home after a failure
_REST_SPEED = 0.02  # m/s or rad/s below which the kitchen is at rest
_REST_LEAST, _REST_MOST = 6, 60  # control periods
_NEIGHBOUR = 1.3  # m between stations whose robots could reach one another

_STILL = ("wait", "done")
_THOUGHT = 20  # control periods within which a skill has only planned and closed or opened its hand

Attempt = Generator[None, None, Outcome]


class PhysicsBackend:
    """A kitchen in MuJoCo. ``model`` and ``data`` are for rendering only."""

    def __init__(self) -> None:
        self._start: Start | None = None
        self._simulation: Simulation | None = None

    # -- the Backend protocol ---------------------------------------------------------------------------------------

    def reset(self, start: Start) -> WorldState:
        """Put the kitchen into this start; what follows depends on nothing that went before."""
        self._start = start
        self._layout = layouts.load(start.layout)
        self._things = {noun: catalogue.get(name) for noun, name in start.categories.items()}
        model = _model(start.layout, tuple(start.scene.robots), tuple(start.categories.items()))
        self._simulation = Simulation(model, start.scene.robots)
        self._marks = {name: state.marks for name, state in start.world.objects.items()}
        self._running = frozenset().union(*(state.on for state in start.world.fixtures.values()))
        self._running = frozenset(s for s in self._running if self._layout.switch_owner(s).kind == "microwave")
        self._round = 0
        pose_start(self._simulation, self._layout, self._things, start)
        self._separation = Separation(self._simulation)
        self._robots = self._surroundings()
        self._settle()
        self._world = self._read()
        return self._world

    def run_round(self, subtasks: Mapping[str, Subtask]) -> RoundResult:
        """Every robot runs its subtask at the same time, until each has ended and the kitchen is at rest."""
        simulation = self._need()
        world, scene, began = self._world, self._begun().scene, simulation.ticks
        refused, stations = settle_claims(scene, world, subtasks)
        active = {r for r, s in subtasks.items() if r not in refused and s.skill not in _STILL}
        driving = {r for r in active if subtasks[r].skill in NAVIGATION}
        self._prepare(stations, active, driving)
        self._waiting: dict[str, float] = {}
        self._busy = set(active)
        attempts = self._attempts(world, subtasks, refused, stations)
        outcomes = dict(refused)
        contacts = misses = 0
        while attempts:
            for robot in list(attempts):
                try:
                    next(attempts[robot])
                except StopIteration as ended:
                    seconds = (simulation.ticks - began) * CONTROL_PERIOD
                    outcomes[robot] = replace(ended.value, seconds=round(seconds, 2))
                    del attempts[robot]
                    self._busy.discard(robot)
            simulation.tick()
            distance = self._separation.of_world()
            contacts += distance <= 0.0
            misses += distance < NEAR_MISS
        self._settle()
        self._marked(subtasks, outcomes)
        self._world = self._read()
        for robot, subtask in subtasks.items():
            if outcomes[robot].success:
                outcomes[robot] = self._verified(robot, subtask, world, outcomes[robot])
        ticks = simulation.ticks - began
        self._round += 1
        seconds = max((outcome.seconds for outcome in outcomes.values()), default=0.0)
        counters = Counters(ticks, ticks * SUBSTEPS, contacts, misses)
        return RoundResult(self._world, {robot: outcomes[robot] for robot in subtasks}, seconds, counters)

    def close(self) -> None:
        """Forget the episode and its memory."""
        self._simulation = self._start = None

    # -- for rendering ----------------------------------------------------------------------------------------------

    @property
    def world(self) -> WorldState:
        """The world after the last round."""
        self._need()
        return self._world

    @property
    def model(self) -> mujoco.MjModel:
        """The compiled kitchen of colliders; its qpos fits the model with looks."""
        return self._need().model

    @property
    def data(self) -> mujoco.MjData:
        """The present state. Read only."""
        return self._need().data

    # -- inside -----------------------------------------------------------------------------------------------------

    def _need(self) -> Simulation:
        if self._simulation is None:
            raise LifecycleError("the physics backend needs reset(start) before anything else")
        return self._simulation

    def _begun(self) -> Start:
        if self._start is None:
            raise LifecycleError("the physics backend needs reset(start) before anything else")
        return self._start

    def _surroundings(self) -> dict[str, Surroundings]:
        simulation, kinematics = self._need(), Kinematics()
        found = {}
        for name, robot in simulation.robots.items():
            scratch = Scratch(simulation, robot, kinematics)
            planner = Planner(scratch, np.random.default_rng(0))
            x, y, yaw = robot.q[:3]
            found[name] = Surroundings(
                simulation, robot, self._layout, self._things, kinematics, scratch, planner,
                Mover(robot, kinematics), Hand(), Station(ASIDE, float(x), float(y), float(yaw)),
            )
        return found

    def _prepare(self, stations: Mapping[str, str], active: set[str], driving: set[str]) -> None:
        """Fences between robots that move at neighbouring stations, from where they are and where they go."""
        for name, here in self._robots.items():
            here.scratch.fence = None
            low, high = -np.inf, np.inf
            for other, there in self._robots.items():
                if name in driving or other == name or other not in active:
                    continue
                ends = [there.station, self._layout.stations.get(stations[other], there.station)]
                for end in ends:
                    gap = end.x - here.station.x
                    if end.y < here.station.y - 0.5 or abs(gap) > _NEIGHBOUR or gap == 0.0:
                        continue
                    middle = here.station.x + 0.5 * gap
                    low, high = (max(low, middle), high) if gap < 0 else (low, min(high, middle))
            here.scratch.fence = (low, high) if np.isfinite(low) or np.isfinite(high) else None
            if self._begun().perception_noise:
                chance = generator(self._begun().seed, "perception", self._round, *here.robot.q[:2].round(3))
                here.shifts = {
                    body: np.append(chance.normal(0.0, self._begun().perception_noise, 2), 0.0) for body in self._things
                }

    def _attempts(
        self, world: WorldState, subtasks: Mapping[str, Subtask], refused: Mapping[str, Outcome],
        stations: Mapping[str, str],
    ) -> dict[str, Attempt]:
        going = [r for r, s in subtasks.items() if r not in refused and s.skill in NAVIGATION]
        goals = self._goals(going, subtasks, stations)
        working = tuple(
            here.station.x for name, here in self._robots.items()
            if name not in going and here.station.name != ASIDE
        )
        errands = {name: Errand(self._robots[name], base_pose(goals[name])) for name in going if name in goals}
        convoy = Convoy(self._separation, errands, Rooms(working))
        attempts: dict[str, Attempt] = {}
        for robot, subtask in subtasks.items():
            if robot in refused:
                continue
            if subtask.skill in _STILL:
                attempts[robot] = _nothing()
                continue
            if robot in going:
                drive = self._drive(convoy, robot, goals.get(robot))
                attempts[robot] = self._bounded(self._robots[robot], drive, SKILL_TIME)
            else:
                here = self._robots[robot]
                here.planner.random = generator(self._begun().seed, "search", self._round, subtask.text)
                attempts[robot] = self._skill(robot, subtask, world)
        return attempts

    def _goals(
        self, going: list[str], subtasks: Mapping[str, Subtask], stations: Mapping[str, str]
    ) -> dict[str, Station]:
        goals = {r: self._layout.stations[stations[r]] for r in going if stations[r] != ASIDE}
        away = {r: self._robots[r].robot.q[:3] for r in going if stations[r] == ASIDE}
        taken = {name: here.robot.q[:3] for name, here in self._robots.items() if name not in going}
        return goals | parking(self._layout, away, taken)

    def _drive(self, convoy: Convoy, robot: str, goal: Station | None) -> Steps:
        if goal is None:
            raise SkillFailure("blocked", "no parking place is free")
        held = {name: here.hand.body for name, here in self._robots.items() if here.hand.body is not None}
        self._separation.holding(held)
        yield from convoy.steps(robot)
        self._robots[robot].station = goal

    def _skill(self, robot: str, subtask: Subtask, world: WorldState) -> Attempt:
        """Run a skill within its time; after a failure come home if that can be done.

        A skill that finds no way within the fence towards a robot working next to it waits until that one is done.
        """
        here, scene = self._robots[robot], self._begun().scene
        began = self._need().ticks
        outcome = yield from self._bounded(here, dispatch.motion(here, scene, world, robot, subtask), SKILL_TIME)
        fenced = here.scratch.fence is not None and outcome.reason in ("blocked", "unreachable")
        if fenced and self._need().ticks - began <= _THOUGHT:
            yield from self._turn(robot)
            here.scratch.fence = None
            outcome = yield from self._bounded(here, dispatch.motion(here, scene, world, robot, subtask), SKILL_TIME)
        if not outcome.success and outcome.reason != "door_closed":
            here.robot.q = here.robot.measured
            yield from self._bounded(here, go_home(here), _RECOVERY_TIME)
        return outcome

    def _turn(self, robot: str) -> Generator[None, None, None]:
        """Wait until every other robot is done; of robots that all wait the leftmost goes first."""
        self._waiting[robot] = self._robots[robot].station.x
        for _ in range(int(2 * SKILL_TIME / CONTROL_PERIOD)):
            others = self._busy - {robot}
            first = min(self._waiting, key=lambda name: self._waiting[name])
            if not others or (others <= self._waiting.keys() and first == robot):
                break
            yield
        del self._waiting[robot]

    def _bounded(self, here: Surroundings, steps: Steps, seconds: float) -> Attempt:
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

    def _settle(self) -> None:
        """Let the kitchen come to rest, within bounds."""
        simulation = self._need()
        for count in range(_REST_MOST):
            if count >= _REST_LEAST and simulation.moving() < _REST_SPEED:
                return
            simulation.tick()

    def _marked(self, subtasks: Mapping[str, Subtask], outcomes: Mapping[str, Outcome]) -> None:
        """Remember what geometry does not show: seasoning, and what a push button did."""
        simulation = self._need()
        for robot, subtask in subtasks.items():
            if not outcomes[robot].success:
                continue
            if subtask.skill == "season":
                self._marks[subtask.target] = self._marks[subtask.target] | {"seasoned"}
            fixture = self._layout.fixtures.get(subtask.target)
            if fixture is not None and fixture.kind == "microwave":
                if subtask.skill == "turn on":
                    self._running |= frozenset(fixture.switches)
                elif subtask.skill == "turn off":
                    self._running -= frozenset(fixture.switches)
        for fixture in self._layout.fixtures.values():
            angle = fixture.read(simulation.model, simulation.data).door_angle
            if angle is not None and angle > 0.05:
                self._running -= frozenset(fixture.switches)

    def _read(self) -> WorldState:
        """The world now; every robot's idea of its hand follows it."""
        world = read_world(
            self._need(), self._begun().scene, self._layout, self._things, marks=self._marks, running=self._running
        )
        for name, here in self._robots.items():
            if here.hand.body != world.robots[name].holding:
                here.hand.body = world.robots[name].holding
        return world

    def _verified(self, robot: str, subtask: Subtask, before: WorldState, outcome: Outcome) -> Outcome:
        """Success only when what the subtask achieves is true at rest."""
        for condition in subtask.achieves(robot, before.robots[robot].holding):
            if not condition.holds(self._begun().scene, self._world):
                return failure("slipped", f"not true at rest: {condition.sentence}", seconds=outcome.seconds)
        return outcome


def _nothing() -> Attempt:
    return Outcome("success")
    yield


@lru_cache(maxsize=8)
def _model(layout: str, robots: tuple[str, ...], categories: tuple[tuple[str, str], ...]) -> mujoco.MjModel:
    """Compiled colliders; a model is never written to, so episodes share it."""
    return build_model(layouts.load(layout), robots=robots, objects=dict(categories), looks=False)
