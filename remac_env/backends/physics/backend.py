"""The physics backend: every robot's skill is a generator, all of them run on one simulated clock."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from remac_env.backends.base import Counters, RoundResult, check_all_idle, check_busy, check_idle
from remac_env.backends.physics.controllers.base import MakeController, check_controllers
from remac_env.backends.physics.manual import Manual
from remac_env.backends.physics.sensing import Draw
from remac_env.backends.physics.timeline import Timeline
from remac_env.errors import LifecycleError
from remac_env.kitchen.worlds import Worlds
from remac_env.rules.facts import Process
from remac_env.rules.outcomes import Outcome
from remac_env.rules.subtasks import Subtask
from remac_env.start import Start
from remac_env.state import WorldState

Event = tuple[Process, str]
Call = tuple[str, dict[str, Any]]
"""A method that was called, and with what."""


class PhysicsBackend:
    """A kitchen in MuJoCo. ``model`` and ``data`` are for rendering and measuring only.

    ``worlds``: where layouts and categories are found; those of the package where None. ``controllers``: skill -> what
    makes a controller for it, for each robot and episode; all others are scripted. ``watch`` is called after every
    control step while a subtask runs, ``probe`` after every step of 5 ms; ``pictures`` draws what
    a robot's cameras show.
    """

    def __init__(
        self, worlds: Worlds | None = None, *, controllers: Mapping[str, MakeController] | None = None
    ) -> None:
        self._worlds, self._controllers = worlds or Worlds(), dict(controllers or {})
        check_controllers(self._controllers, 1)
        self.watch: Callable[[], None] | None = None
        self.probe: Callable[[], None] | None = None
        self.pictures: Draw | None = None
        self._timeline: Timeline | None = None
        self._played: list[Call] = []

    def __getstate__(self) -> dict[str, Any]:
        """What a copy is made from: the start and what was played. `watch`, `probe` and `pictures` stay behind."""
        start = None if self._timeline is None else self._timeline.start
        return {
            "worlds": self._worlds, "controllers": self._controllers, "start": start, "played": list(self._played)
        }

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        """Play it again: copies of MjData are inexact while parts of the kitchen sleep, replays are exact."""
        self.__init__(state["worlds"], controllers=state["controllers"])  # type: ignore[misc]
        if state["start"] is not None:
            self.reset(state["start"])
            for call, values in state["played"]:
                getattr(self, call)(**values)

    def reset(self, start: Start) -> WorldState:
        """Put the kitchen into this start; what follows depends on nothing that went before."""
        before = None if self._timeline is None else self._timeline.simulation
        self._timeline, self._played = Timeline(start, self._worlds, before, self._controllers), []
        return self._timeline.world

    def begin(self, subtasks: Mapping[str, Subtask]) -> dict[str, Outcome]:
        """Start subtasks of idle robots; the outcomes of those that are refused."""
        timeline = self._begun()
        check_idle(subtasks, timeline.start.scene.robots, timeline.busy)
        with self._playing("begin", subtasks=dict(subtasks)):
            return timeline.begin(subtasks)

    def advance(self, *, until: float = math.inf) -> dict[str, Outcome]:
        """Run until the next subtask ends; the outcomes of all that end then."""
        timeline = self._begun()
        with self._playing("advance", until=until):
            return timeline.advance(self.watch, until)

    def happen(self, process: Process, name: str) -> None:
        """Let what comes of a process come true: a mark, or switches that go off. A door has fallen by itself."""
        timeline = self._begun()
        with self._playing("happen", process=process, name=name):
            timeline.happen(process, name)

    def stop(self, robot: str) -> None:
        """Tell a busy robot to stop: a drive goes through; another skill ends now, and the robot comes home."""
        timeline = self._begun()
        check_busy(robot, timeline.busy)
        with self._playing("stop", robot=robot):
            timeline.stop(robot)

    def go_on(self, processes: Mapping[Event, float]) -> None:
        """Let springs pull at the doors that are falling shut, and at no others."""
        timeline = self._begun()
        with self._playing("go_on", processes=dict(processes)):
            timeline.closers.go_on(processes)

    def run_round(self, subtasks: Mapping[str, Subtask]) -> RoundResult:
        """Every robot runs its subtask at the same time, until each has ended and the kitchen is at rest."""
        timeline = self._begun()
        check_all_idle(timeline.busy)
        with self._playing("run_round", subtasks=dict(subtasks)):
            return timeline.run_round(subtasks, self.watch)

    def positions(self) -> NDArray[np.float64]:
        """Joint positions now, qpos of `model` (rad, m)."""
        return self.data.qpos.copy()

    def close(self) -> None:
        """Forget the episode and free its memory."""
        self._timeline, self._played = None, []

    @property
    def world(self) -> WorldState:
        """The world after the last round, `begin` or `advance`."""
        return self._begun().world

    @property
    def settled(self) -> WorldState:
        """The world but for what is under way, by what the skill table says that it changes."""
        return self._begun().settled

    @property
    def model(self) -> mujoco.MjModel:
        """The compiled kitchen of colliders; its qpos fits the model with visual geometry."""
        return self._begun().simulation.model

    @property
    def data(self) -> mujoco.MjData:
        """The present state. Read only."""
        return self._begun().simulation.data

    def by_hand(self, robot: str, subtask: Subtask) -> Manual:
        """Move an idle robot from outside from now on, a control period at a time, to do what a subtask says.

        What is done so is not played again by a copy of this backend.

        Raises:
            LifecycleError: before reset, or while a robot is busy.
        """
        timeline = self._begun()
        check_all_idle(timeline.busy)
        return Manual(timeline, robot, subtask)

    @property
    def busy(self) -> frozenset[str]:
        """The robots whose subtasks have begun and not ended."""
        return self._begun().busy

    @property
    def clock(self) -> float:
        """Simulated seconds since the start."""
        return self._begun().clock

    @property
    def counters(self) -> Counters:
        """What has been counted since the start."""
        return self._begun().counters

    @contextmanager
    def _playing(self, call: str, **values: Any) -> Iterator[None]:
        """Remember a call that comes to its end; one that is broken off leaves no robot busy."""
        timeline = self._begun()
        timeline.simulation.probe, timeline.simulation.pictures = self.probe, self.pictures
        try:
            yield
        except BaseException:
            timeline.abandon()
            raise
        self._played.append((call, values))

    def _begun(self) -> Timeline:
        if self._timeline is None:
            raise LifecycleError("the physics backend needs reset(start) before anything else")
        return self._timeline
