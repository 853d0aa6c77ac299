"""Fingers on a hard handle come to rest after a knock; fingers that are too light bounce on it until it slides out."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.robots.panda import measures as panda
from remac_env.tasks.goals import Inside
from remac_env.tasks.spec import Role, TaskSpec

ROBOT = "robot_0"
SPEC = TaskSpec("Pan", ("", "", ""), Inside("{pan}", "cabinet"), (Role("pan", ("pan",), at="counter"),), ())

KNOCK = 0.002
"""m by which a finger is off the handle all at once: what a jerk of the arm does."""

TOO_LIGHT = 0.2
"""kg."""


@pytest.fixture(scope="module")
def held() -> PhysicsBackend:
    """A pan in the hand."""
    worlds = TaskWorlds(SPEC)
    start, _ = worlds.start(
        46020, style="modern_1", layout="one_wall_large", starts="paper", robots=(ROBOT,), perception_noise=0.0
    )
    backend = PhysicsBackend(worlds)
    backend.reset(start)
    for text in ("navigate to pan", "pick up pan"):
        subtask = worlds.vocabulary.subtask(worlds.vocabulary.encode(text))
        assert backend.run_round({ROBOT: subtask}).outcomes[ROBOT].success, text
    return backend


def stroke(model: mujoco.MjModel, held: mujoco.MjData, inertia: float) -> float:
    """How far (m) a finger still moves to and fro one to two seconds after the knock."""
    names = [f"{ROBOT}/{finger}" for finger in panda.FINGERS]
    data = mujoco.MjData(model)
    mujoco.mj_copyData(data, model, held)
    for name in names:
        model.dof_armature[model.joint(name).dofadr[0]] = inertia
        data.joint(name).qpos[0] += KNOCK
    places = []
    for _ in range(400):
        mujoco.mj_step(model, data)
        places.append([float(data.joint(name).qpos[0]) for name in names])
    return float(np.ptp(np.array(places[200:]), axis=0).max())


def test_a_knock_dies_away(held: PhysicsBackend) -> None:
    inertia = float(held.model.dof_armature[held.model.joint(f"{ROBOT}/{panda.FINGERS[0]}").dofadr[0]])
    assert stroke(held.model, held.data, inertia) < 0.0002
    assert stroke(held.model, held.data, TOO_LIGHT) > 0.001
