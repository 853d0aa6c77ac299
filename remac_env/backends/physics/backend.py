"""The physics backend: every robot's skill is a generator, all of them run on one simulated clock."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from remac_env.backends.base import Counters, RoundResult
from remac_env.backends.physics.crew import Crew, Round
from remac_env.backends.physics.falls import fallen
from remac_env.backends.physics.separation import NEAR_MISS
from remac_env.backends.physics.simulation import CONTROL_PERIOD, SUBSTEPS, Simulation
from remac_env.backends.physics.stage import pose_start
from remac_env.backends.physics.truth import Truth
from remac_env.errors import LifecycleError
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.objects.catalogue import Category
from remac_env.kitchen.worlds import Worlds
from remac_env.rules.claims import settle_claims
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import Subtask
from remac_env.start import Start
from remac_env.state import WorldState

_REST_SPEED = 0.02  # m/s or rad/s below which the kitchen is at rest
_REST_LEAST, _REST_MOST = 6, 60  # control periods
_START_LEAST = 1  # of the same: things start where they rest


class PhysicsBackend:
    """A kitchen in MuJoCo. ``model`` and ``data`` are for rendering and measuring only.

    ``worlds``: where layouts and categories are found; those of the package where None. ``watch`` is called after
    every control step of a round, ``probe`` after every step of 5 ms.
    """

    def __init__(self, worlds: Worlds | None = None) -> None:
        self._worlds = worlds or Worlds()
        self.watch: Callable[[], None] | None = None
        self.probe: Callable[[], None] | None = None
        self._episode: _Episode | None = None
        self._played: list[dict[str, Subtask]] = []

    def __getstate__(self) -> dict[str, Any]:
        """What a copy is made from: the start and the rounds played. `watch` and `probe` stay behind."""
        start = None if self._episode is None else self._episode.start
        return {"worlds": self._worlds, "start": start, "played": list(self._played)}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        """Play the rounds again: copies of MjData are inexact while parts of the kitchen sleep, replays are exact."""
        self.__init__(state["worlds"])  # type: ignore[misc]
        if state["start"] is not None:
            self.reset(state["start"])
            for subtasks in state["played"]:
                self.run_round(subtasks)

    def reset(self, start: Start) -> WorldState:
        """Put the kitchen into this start; what follows depends on nothing that went before."""
        before = None if self._episode is None else self._episode.simulation
        self._episode, self._played = _Episode(start, self._worlds, before), []
        return self._episode.world

    def run_round(self, subtasks: Mapping[str, Subtask]) -> RoundResult:
        """Every robot runs its subtask at the same time, until each has ended and the kitchen is at rest."""
        episode = self._begun()
        episode.simulation.probe = self.probe
        result = episode.run_round(subtasks, self.watch)
        self._played.append(dict(subtasks))
        return result

    def positions(self) -> NDArray[np.float64]:
        """Joint positions now, qpos of `model` (rad, m)."""
        return self.data.qpos.copy()

    def close(self) -> None:
        """Forget the episode and free its memory."""
        self._episode, self._played = None, []

    @property
    def world(self) -> WorldState:
        """The world after the last round."""
        return self._begun().world

    @property
    def model(self) -> mujoco.MjModel:
        """The compiled kitchen of colliders; its qpos fits the model with looks."""
        return self._begun().simulation.model

    @property
    def data(self) -> mujoco.MjData:
        """The present state. Read only."""
        return self._begun().simulation.data

    def _begun(self) -> _Episode:
        if self._episode is None:
            raise LifecycleError("the physics backend needs reset(start) before anything else")
        return self._episode


class _Episode:
    """One start and what has become of it."""

    def __init__(self, start: Start, worlds: Worlds, before: Simulation | None) -> None:
        self.start = start
        self._layout: Layout = worlds.layout(start.layout, start.style)
        self._things: dict[str, Category] = {n: worlds.categories[name] for n, name in start.categories.items()}
        robots = tuple(start.scene.robots)
        self.simulation = Simulation(_model(self._layout, robots, tuple(self._things.items())), robots, before)
        self._truth = Truth(self.simulation, start, self._layout, self._things)
        self._rounds = 0
        pose_start(self.simulation, self._layout, self._things, start)
        self._settle(_START_LEAST)
        self.world = self._truth.read()

    @cached_property
    def _crew(self) -> Crew:
        """Made for the first round, as it takes longer and more memory than all the rest."""
        return Crew(self.simulation, self._layout, self._things, self.start)

    def run_round(self, subtasks: Mapping[str, Subtask], watch: Callable[[], None] | None) -> RoundResult:
        """One round; see the backend."""
        self._crew.hold({name: state.holding for name, state in self.world.robots.items()})
        began, before, scene = self.simulation.ticks, self.world, self.start.scene
        refused, stations = settle_claims(scene, before, subtasks)
        accepted = {robot: subtask for robot, subtask in subtasks.items() if robot not in refused}
        attempts = self._crew.attempts(Round(self._rounds, before, accepted, stations, self._achieved))
        outcomes = dict(refused)
        contacts = misses = 0
        while True:
            for robot in list(attempts):
                try:
                    next(attempts[robot])
                except StopIteration as ended:
                    seconds = (self.simulation.ticks - began) * CONTROL_PERIOD
                    outcomes[robot] = replace(ended.value, seconds=round(seconds, 2))
                    del attempts[robot]
                    self._crew.finished(robot)
            if not attempts:
                break
            self._tick()
            if watch is not None:
                watch()
            distance = self._crew.separation.of_world()
            contacts += distance <= 0.0
            misses += distance < NEAR_MISS
        self._settle()
        self._rounds += 1
        self.world = self._truth.read()
        judged = {robot: self._judged(robot, subtasks[robot], before, outcomes[robot]) for robot in subtasks}
        for name, robots in fallen(scene, before, self.world, subtasks):
            for robot in robots:
                if judged[robot].success:
                    judged[robot] = failure("dropped", f"the {name} fell", seconds=judged[robot].seconds)
        ticks = self.simulation.ticks - began
        seconds = max((outcome.seconds for outcome in judged.values()), default=0.0)
        return RoundResult(self.world, judged, seconds, Counters(ticks, ticks * SUBSTEPS, contacts, misses))

    def _settle(self, least: int = _REST_LEAST) -> None:
        """Let the kitchen come to rest, within bounds."""
        for count in range(_REST_MOST):
            if count >= least and self.simulation.moving() < _REST_SPEED:
                return
            self._tick()

    def _tick(self) -> None:
        """One control period."""
        self.simulation.tick()
        self._truth.update()

    def _achieved(self, robot: str, subtask: Subtask) -> bool:
        """Whether a subtask of this round has done by now what it says."""
        seen, held = self._truth.seen(), self.world.robots[robot].holding
        return all(condition.holds(self.start.scene, seen) for condition in subtask.achieves(robot, held))

    def _judged(self, robot: str, subtask: Subtask, before: WorldState, outcome: Outcome) -> Outcome:
        """Success only when what the subtask achieves is true at rest."""
        if not outcome.success:
            return outcome
        for condition in subtask.achieves(robot, before.robots[robot].holding):
            if not condition.holds(self.start.scene, self.world):
                return failure("slipped", f"not true at rest: {condition.sentence}", seconds=outcome.seconds)
        return outcome


@lru_cache(maxsize=8)
def _model(layout: Layout, robots: tuple[str, ...], things: tuple[tuple[str, Category], ...]) -> mujoco.MjModel:
    """Compiled colliders; a model is never written to, so episodes share it."""
    return build_model(layout, robots=robots, objects=dict(things), looks=False)
