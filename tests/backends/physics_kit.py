"""Chains of commands in physics for tests: which objects stand where, what is run, and what came of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.base import MakeController
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.simulation import Simulation
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.rules.subtasks import Subtask
from remac_env.start import Start
from remac_env.tasks.goals import Inside
from remac_env.tasks.spec import Role, TaskSpec

ROBOT = "robot_0"


def kitchen(
    things: Mapping[str, str], seed: int, *, noise: float = 0.0, layout: str = "one_wall_large",
    style: str = "modern_1", robots: tuple[str, ...] = (ROBOT,),
    controllers: Mapping[str, MakeController] | None = None,
) -> tuple[PhysicsBackend, Start, TaskWorlds]:
    """A kitchen with these objects (noun -> fixture where it starts), at its start."""
    roles = tuple(Role(noun, (noun,), at=at) for noun, at in things.items())
    first = next(iter(things))
    spec = TaskSpec("Chain", ("", "", ""), Inside(f"{{{first}}}", "fridge"), roles, (), distractors=(0, 0))
    worlds = TaskWorlds(spec)
    start, _ = worlds.start(
        seed, style=style, layout=layout, starts="paper", robots=robots, perception_noise=noise
    )
    backend = PhysicsBackend(worlds, controllers=controllers)
    backend.reset(start)
    return backend, start, worlds


def stand(simulation: Simulation, here: Workspace, q: np.ndarray) -> None:
    """Pose a robot at once, in the frame of the room."""
    here.leave()
    simulation.robots[here.robot.name].put(q)
    here.robot.catch_up()


def command(worlds: TaskWorlds, text: str) -> Subtask:
    """The subtask that a command names."""
    subtask = worlds.vocabulary.subtask(worlds.vocabulary.encode(text))
    assert subtask is not None
    return subtask


def run(backend: PhysicsBackend, worlds: TaskWorlds, texts: Sequence[str]) -> list[str | None]:
    """Run commands one after the other; the reasons of their outcomes, None for successes."""
    return [backend.run_round({ROBOT: command(worlds, text)}).outcomes[ROBOT].reason for text in texts]
