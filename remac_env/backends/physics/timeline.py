"""One start and all that has happened since: subtasks begin and end on one simulated clock."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping
from dataclasses import replace
from functools import cached_property, lru_cache

import mujoco

from remac_env.backends.base import Counters, RoundResult
from remac_env.backends.physics.attempts import Orders
from remac_env.backends.physics.closers import Closers
from remac_env.backends.physics.controllers.base import Command, MakeController, check_controllers
from remac_env.backends.physics.falls import fallen
from remac_env.backends.physics.judging import Begun, judged
from remac_env.backends.physics.pilot import Attempt, Pilot
from remac_env.backends.physics.quirks import Oddities
from remac_env.backends.physics.quirks.mechanisms import Surroundings
from remac_env.backends.physics.separation import NEAR_MISS
from remac_env.backends.physics.simulation import CONTROL_PERIOD, SUBSTEPS, Simulation
from remac_env.backends.physics.stage import pose_start
from remac_env.backends.physics.team import Team
from remac_env.backends.physics.truth import Truth
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.fixtures.certificates import warn_uncertified
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.objects.catalogue import Category
from remac_env.kitchen.worlds import Worlds
from remac_env.robots import bodies
from remac_env.rules.claims import Claim, settle_claims
from remac_env.rules.facts import Process, Quirk
from remac_env.rules.outcomes import Outcome
from remac_env.rules.processes import outcome_of
from remac_env.rules.quirks import HINDERED, QUIRKS
from remac_env.rules.rounds import attempt, carried
from remac_env.rules.subtasks import Subtask
from remac_env.start import Start
from remac_env.state import WorldState

_REST_SPEED = 0.02  # m/s or rad/s below which the kitchen is at rest
_REST_LEAST, _REST_MOST = 6, 60  # control periods
_START_LEAST = 1  # of the same: objects start where they rest

Watch = Callable[[], None] | None


class Timeline:
    """A start in physics. ``begin`` subtasks and ``advance`` to the next end, or ``run_round``."""

    def __init__(
        self, start: Start, worlds: Worlds, before: Simulation | None, controllers: Mapping[str, MakeController]
    ) -> None:
        check_controllers(controllers, len(start.scene.robots))
        self.start, self._controllers = start, controllers
        self._layout: Layout = worlds.layout_of(start)
        warn_uncertified(self._layout, start.body)
        self._objects: dict[str, Category] = {n: worlds.categories[name] for n, name in start.categories.items()}
        robots = tuple(start.scene.robots)
        built_in = tuple(quirk for quirk in start.scene.quirks if QUIRKS[quirk.kind].fills)
        model = _model(self._layout, robots, tuple(self._objects.items()), start.body, built_in)
        self.simulation = Simulation(model, robots, before, bodies.get(start.body))
        self._truth = Truth(self.simulation, start, self._layout, self._objects)
        self.closers = Closers(self.simulation, self._layout)
        self._batches = self._contacts = self._misses = 0
        self._tasks: dict[str, Begun] = {}
        self._attempts: dict[str, Attempt] = {}
        self._stepped: set[str] = set()
        self._fell: dict[str, str] = {}
        pose_start(self.simulation, self._layout, self._objects, start)
        self._oddities = self._made_odd() if Oddities.wanted(start.scene, self._layout) else None
        self._settle(_START_LEAST)
        self._zero = self.simulation.ticks
        self.world = self._truth.read()

    def _made_odd(self) -> Oddities:
        """What the kitchen's quirks and interlocks are in physics."""
        scene, happened = self.start.scene, self._truth.happened
        around = Surroundings(self.simulation, scene, self._layout, self._objects, happened)
        return Oddities(around, self._truth)

    @cached_property
    def _team(self) -> Team:
        """Made for the first subtask, as it takes longer and more memory than all the rest."""
        return Team(self.simulation, self._layout, self._objects, self.start, self._controllers)

    @property
    def busy(self) -> frozenset[str]:
        """The robots whose subtasks have begun and not ended."""
        return frozenset(self._attempts)

    @property
    def counters(self) -> Counters:
        """What has been counted since the start."""
        ticks = self.simulation.ticks - self._zero
        return Counters(ticks, ticks * SUBSTEPS, self._contacts, self._misses)

    def begin(self, subtasks: Mapping[str, Subtask]) -> dict[str, Outcome]:
        """Start subtasks of idle robots; see the backend."""
        world, now = self.world, self.simulation.ticks
        idle = {name: state for name, state in world.robots.items() if name not in self._attempts}
        self._team.hold({name: state.holding for name, state in idle.items()})
        claims = {robot: task.claim for robot, task in self._tasks.items()}
        refused, stations = settle_claims(self.start.scene, world, subtasks, claims)
        accepted = {robot: subtask for robot, subtask in subtasks.items() if robot not in refused}
        for robot, subtask in accepted.items():
            claim = Claim.of(self.start.scene, world, robot, subtask, stations[robot])
            after = self._foretold(robot, subtask, stations[robot])
            self._tasks[robot] = Begun(subtask, robot, now, world, claim, after)
        if self._oddities is not None:
            self._oddities.began(accepted.values())
        orders = Orders(self._batches, world, accepted, stations, self._achieved, self._hindered)
        self._attempts |= self._team.attempts(orders)
        self._batches += 1
        return {robot: self._timed(outcome, now) for robot, outcome in refused.items()}

    @property
    def clock(self) -> float:
        """Simulated seconds since the start, to the control period."""
        return round((self.simulation.ticks - self._zero) * CONTROL_PERIOD, 2)

    def advance(self, watch: Watch, until: float = math.inf) -> dict[str, Outcome]:
        """Run to the next end of a subtask; see the backend."""
        before, tasks = self.world, dict(self._tasks)
        ended = self._run(watch, until)
        if not ended and math.isinf(until):
            return {}
        if ended and not self._attempts:
            self._settle()
        self.world = self._truth.read()
        return self._judge(ended, tasks, before, {robot: task.subtask for robot, task in tasks.items()})

    def stop(self, robot: str) -> None:
        """Tell a busy robot to stop; see the backend."""
        if not self._tasks[robot].subtask.moves:
            self._team.pilots[robot].stopping = True

    def happen(self, process: Process, name: str) -> None:
        """Let what comes of a process come true; see the backend."""
        self._truth.happen(process, name)
        self.world = self._truth.read()
        if process.does != "shut":
            for robot, task in self._tasks.items():
                worlds = (outcome_of(task.world, process, name), outcome_of(task.after, process, name))
                self._tasks[robot] = replace(task, world=worlds[0], after=worlds[1])

    @property
    def settled(self) -> WorldState:
        """The world but for what is under way; see the backend."""
        world = self.world
        for task in self._tasks.values():
            world = carried(task.after, task.world, world)
        return world

    def _foretold(self, robot: str, subtask: Subtask, station: str) -> WorldState:
        """What the skill table makes of the world, where it matters."""
        if not self.start.scene.processes:
            return self.world
        return attempt(self.start.scene, self.world, robot, subtask, station=station)[1]

    def run_round(self, subtasks: Mapping[str, Subtask], watch: Watch) -> RoundResult:
        """One round; see the backend."""
        began, before, met = self.simulation.ticks, self.world, (self._contacts, self._misses)
        outcomes, tasks = self.begin(subtasks), dict(self._tasks)
        while self._attempts:
            outcomes |= self._run(watch)
        self._settle()
        self.world = self._truth.read()
        judged, ticks = self._judge(outcomes, tasks, before, subtasks), self.simulation.ticks - began
        seconds = max((outcome.seconds for outcome in judged.values()), default=0.0)
        counters = Counters(ticks, ticks * SUBSTEPS, self._contacts - met[0], self._misses - met[1])
        return RoundResult(self.world, judged, seconds, counters)

    def pilot(self, robot: str) -> Pilot:
        """Who passes a robot's commands on, for who moves it from outside; see `manual`."""
        self._team.hold({name: state.holding for name, state in self.world.robots.items()})
        return self._team.pilots[robot]

    def driven(self, robot: str, goal: Station) -> Generator[Command, None, Outcome]:
        """What the scripted controller wants of a robot that drives, for who plays it himself."""
        return self._team.driven(robot, goal)

    def seen(self) -> WorldState:
        """The world as geometry shows it now, in the midst of motion."""
        return self._truth.seen()

    def abandon(self) -> None:
        """Forget what is under way."""
        for robot in self._attempts:
            self._team.finished(robot)
        self._attempts, self._tasks, self._stepped, self._fell = {}, {}, set(), {}

    def _run(self, watch: Watch, until: float = math.inf) -> dict[str, Outcome]:
        """Run until a subtask ends; how each that ends then has ended, by its controller's own word."""
        ended: dict[str, Outcome] = {}
        while self._attempts or not math.isinf(until):
            for robot in [robot for robot in self._attempts if robot not in self._stepped]:
                try:
                    next(self._attempts[robot])
                    self._stepped.add(robot)
                except StopIteration as end:
                    ended[robot] = self._timed(end.value, self._tasks[robot].began)
                    del self._attempts[robot], self._tasks[robot]
                    self._team.finished(robot)
            if ended or self.clock >= until:
                break
            self.tick()
            self._stepped.clear()
            if watch is not None:
                watch()
            distance = self._team.separation.of_world()
            self._contacts += distance <= 0.0
            self._misses += distance < NEAR_MISS
        return ended

    def _timed(self, outcome: Outcome, began: int) -> Outcome:
        """An outcome that ends now, with its times."""
        ticks = (self.simulation.ticks - began, began - self._zero, self.simulation.ticks - self._zero)
        seconds, start, end = (round(count * CONTROL_PERIOD, 2) for count in ticks)
        return replace(outcome, seconds=seconds, began=start, ended=end)

    def _settle(self, least: int = _REST_LEAST) -> None:
        """Let the kitchen come to rest, within bounds."""
        while self._oddities is not None and self._oddities.pending:
            self.tick()
        for count in range(_REST_MOST):
            if count >= least and (self.closers.at_work or self.simulation.moving() < _REST_SPEED):
                return
            self.tick()

    def tick(self) -> None:
        """One control period under the robots' present commands."""
        if self.closers.armed:
            self.closers.pull(self.clock)
        self.simulation.tick()
        self._truth.update()
        if self._oddities is not None:
            self._oddities.watch()

    def _achieved(self, robot: str) -> bool:
        """Whether a robot's subtask has done by now what it says."""
        return not self._tasks[robot].missing(self.start.scene, self._truth.seen(lately=True))

    def _hindered(self, subtask: Subtask) -> bool:
        """Whether a quirk has kept a subtask from succeeding, so far."""
        return self._oddities is not None and self._oddities.hindered(subtask)

    def _judge(
        self, ended: Mapping[str, Outcome], tasks: Mapping[str, Begun], before: WorldState,
        running: Mapping[str, Subtask],
    ) -> dict[str, Outcome]:
        """Outcomes by the world as it is now. ``running``: what ran since the world ``before``."""
        for name, robots in fallen(self.start.scene, before, self.world, running):
            for robot in robots:
                self._fell.setdefault(robot, name)
        judged = {robot: self._judged(tasks.get(robot), outcome) for robot, outcome in ended.items()}
        for robot, name in self._fell.items():
            if robot in judged and judged[robot].success:
                judged[robot] = replace(judged[robot], status="failure", reason="dropped", detail=f"the {name} fell")
        self._fell = {robot: name for robot, name in self._fell.items() if robot in self._attempts}
        return judged

    def _judged(self, task: Begun | None, outcome: Outcome) -> Outcome:
        """By what is true; what a quirk has kept from succeeding is blocked."""
        if task is None:
            return outcome
        told = judged(task, outcome, self.start.scene, self.world)
        hindered = not told.success and self._hindered(task.subtask)
        return replace(told, reason=HINDERED.reason, detail=HINDERED.detail) if hindered else told


@lru_cache(maxsize=8)
def _model(
    layout: Layout, robots: tuple[str, ...], objects: tuple[tuple[str, Category], ...], body: str,
    quirks: tuple[Quirk, ...],
) -> mujoco.MjModel:
    """Compiled colliders; a model is never written to, so episodes share it."""
    return build_model(
        layout, robots=robots, objects=dict(objects), visual=False, body=bodies.get(body), quirks=quirks
    )
