"""Records what the scripted controllers do, with disturbed servos and clean labels: what they wanted in each state.

Servos are told a little else than the controller says, by an error that wanders (DART: Laskey et al., CoRL 2017), so
that demonstrations show how to come back to the way.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from remac_bench.errors import UsageError
from remac_bench.learning.demos import Demo
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.base import in_room
from remac_env.backends.physics.controllers.learned.aim import feels
from remac_env.backends.physics.controllers.learned.controller import Learned
from remac_env.backends.physics.controllers.learned.library import weights_of
from remac_env.backends.physics.manual import LASTING, Manual
from remac_env.errors import PhysicsError
from remac_env.lowlevel.control import Joints
from remac_env.lowlevel.drawing import Drawing
from remac_env.lowlevel.starts import ROBOT, Ready, get_ready
from remac_env.robots import bodies
from remac_env.robots.bodies import STANDARD
from remac_env.rules.skills import SKILLS
from remac_env.seeding import generator

_WANDER = (0.010, 0.010, 0.010, 0.004)  # m, rad, m: of the error of base and lift, at strength 1
_WANDER_ARM = 0.02  # rad: of each joint of the arm
_KEEP = 0.9  # of the error that stays from one control period to the next
_STRONGEST = 1.5  # strength is drawn between 0 and this for each demonstration
_NEAR, _FAR = 0.04, 0.24  # m from the target between which an open hand is disturbed less and less
_LEAST, _CLOSED = 0.1, 0.15  # share of the error that stays at the target, and of a hand that holds something
_LONGEST = 1200  # control periods
_LED = 120  # control periods for which weights lead at most: about as long as it takes to reach an object
_NEAR_ENOUGH = 0.15  # m from the target at which they stop leading


@dataclass
class Recorder:
    """Records one skill. ``disturb``: how strongly servos are disturbed, 0 not at all. ``image_size``: of pictures, px.

    Without an ``image_size`` no pictures are recorded. ``case``: only what is handled so, see `case_of`.
    ``led_by``: a folder of weights that begin, and what is recorded is how to go on from where they have come (DAgger:
    Ross et al., AISTATS 2011). ``body``: the name of the robot's.
    """

    skill: str
    target: str | None = None
    disturb: float = 1.0
    image_size: int | None = None
    case: str | None = None
    led_by: Path | None = None
    body: str = STANDARD
    _drawing: Drawing = field(default_factory=Drawing)
    _backends: dict[str, PhysicsBackend] = field(default_factory=dict)

    def record(self, seed: int, *, style: str | None = None, layout: str | None = None) -> Demo | None:
        """The demonstration of this seed, or None where the scripted controller failed.

        Raises:
            SamplingError: if no start is found in which the skill can begin.
        """
        ready, backend = get_ready(
            self._backends, SKILLS[self.skill], self.target, seed, style=style, layout=layout,
            body=self.body, cases=() if self.case is None else (self.case,),
        )
        manual = backend.by_hand(ROBOT, ready.subtask)
        rows = _Rows(self._camera(ready, manual, backend))
        chance = generator(seed, "disturbed", self.skill)
        wander = np.array([*_WANDER, *[_WANDER_ARM] * (len(manual.q) - len(_WANDER))])
        strength, error = self.disturb * float(chance.uniform(0.0, _STRONGEST)), np.zeros(len(wander))
        try:
            self._lead(manual, seed)
            run = manual.scripted(midway=self.led_by is not None)
            rows.see(manual)
            while len(rows.actions) < _LONGEST:
                wanted = next(run)
                q = in_room(wanted.q, wanted.frame)
                rows.note(manual, backend, q, wanted.opening)
                error = _KEEP * error + np.sqrt(1.0 - _KEEP**2) * chance.normal(size=len(error)) * wander * strength
                manual.command(q + error * _share(manual), wanted.opening)
                rows.see(manual)
        except StopIteration as end:
            failed = not end.value.success
        except PhysicsError:
            failed = True
        else:
            failed = True
        for _ in range(0 if failed else 2 * LASTING):
            manual.command(manual.q, manual.grip)
        if failed or not manual.success or len(rows.actions) < LASTING:
            return None
        start = ready.start
        return rows.demo(
            skill=self.skill, target=ready.subtask.target, task=ready.worlds.spec.name, seed=seed, style=start.style,
            layout=start.layout, before=tuple(step.text for step in ready.before), case=ready.case, body=self.body,
        )  # fmt: skip

    def _lead(self, manual: Manual, seed: int) -> None:
        """Let the weights begin: for as long as the seed says, but not to where the hand begins to grasp."""
        if self.led_by is None:
            return
        weights = weights_of(self.led_by, self.skill, self.body)
        if weights is None:
            raise UsageError(f"{self.led_by} has no weights for {self.skill!r}")
        periods = int(generator(seed, "led", self.skill).integers(1, _LED))
        for command in islice(Learned(weights, self.body).run(manual.subtask, manual.sensing), periods):
            if _away(manual) < _NEAR_ENOUGH:
                return
            manual.command(in_room(command.q, command.frame), command.opening)

    def _camera(self, ready: Ready, manual: Manual, backend: PhysicsBackend) -> Callable[[], dict[str, Any]]:
        """What takes pictures of this start; it takes none where none are wanted."""
        if (size := self.image_size) is None:
            return dict
        return lambda: self._drawing.observe(ready, manual, backend, size=size)

    def close(self) -> None:
        """Free the renderer and the simulators."""
        self._drawing.close()
        for backend in self._backends.values():
            backend.close()
        self._backends.clear()


def _share(manual: Manual) -> float:
    """Which share of the error a servo gets now: little near the target, where it would spoil the grasp."""
    if feels(manual.sensing.body) or not manual.aim.by_hand:
        return _CLOSED if manual.aim.by_hand else 1.0
    return float(np.clip((_away(manual) - _NEAR) / (_FAR - _NEAR), _LEAST, 1.0))


def _away(manual: Manual) -> float:
    """From the hand to the target, m."""
    hand = manual.aim.stand.point(manual.sensing.body.grip.position)
    return float(np.linalg.norm(manual.aim.target().at - hand))


class _Rows:
    """What is noted in each control period. ``camera``: what takes its pictures."""

    def __init__(self, camera: Callable[[], dict[str, Any]]) -> None:
        self._camera = camera
        self.pictures: list[dict[str, Any]] = []
        self.observations: list[np.ndarray] = []
        self.actions: list[np.ndarray] = []
        self.commands: list[np.ndarray] = []
        self.measured: list[np.ndarray] = []
        self.states: list[np.ndarray] = []
        self.rewards: list[float] = []

    def see(self, manual: Manual) -> None:
        """What there is to see, and whether the last command has succeeded."""
        if self.observations:
            self.rewards.append(float(manual.success))
        self.observations.append(manual.observe())
        self.pictures.append(self._camera())

    def note(self, manual: Manual, backend: PhysicsBackend, q: np.ndarray, opening: float) -> None:
        """What the controller wants now: ``q`` (n,) in the frame of the room."""
        stand, data = manual.aim.stand, backend.data
        self.actions.append(Joints(bodies.get(manual.body)).action(manual.q, q, opening))
        self.commands.append(np.array([*stand.joints(q), opening]))
        self.measured.append(stand.joints(manual.sensing.body.q))
        self.states.append(np.concatenate([data.qpos, data.qvel]))

    def demo(self, **told: object) -> Demo:
        """All of it."""
        def array(rows: Sequence) -> np.ndarray:  # type: ignore[type-arg]
            return np.array(rows, np.float32)

        shown = {name: np.array([each[name] for each in self.pictures]) for name in self.pictures[0]}
        return Demo(
            observations=array(self.observations), actions=array(self.actions), commands=array(self.commands),
            measured=array(self.measured), states=array(self.states), rewards=array(self.rewards), pictures=shown,
            **told,  # type: ignore[arg-type]
        )  # fmt: skip
