"""A model with its data: where bodies and joints are, which is all that reading a world or posing a start needs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import mujoco
import numpy as np

from remac_env.backends.physics.pose import Pose
from remac_env.kitchen.frame import WORLD
from remac_env.robots.rotation import Array


class Standing(Protocol):
    """A robot as far as the state of the kitchen goes: where its base is, and which bodies it holds objects with."""

    name: str
    fingers: tuple[str, ...]

    @property
    def standing(self) -> Array:
        """The base pose (3,) in the world: x and y of the arm's first axis (m), and yaw (rad)."""

    def put(self, q: Array) -> None:
        """Pose the robot at once (at reset only); ``q``: a configuration (n,)."""


class Bodies:
    """``model``, ``data`` and the robots in them."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, robots: Mapping[str, Standing]) -> None:
        self.model, self.data = model, data
        self.robots = robots

    def clear(self) -> None:
        """Back to the model's initial state; nothing of what went before remains."""
        mujoco.mj_resetData(self.model, self.data)

    def geoms(self, body: str) -> list[int]:
        """Ids of the geoms that belong to ``body`` itself."""
        b = self.model.body(body)
        return list(range(int(b.geomadr[0]), int(b.geomadr[0]) + int(b.geomnum[0]))) if b.geomnum[0] else []

    def pose(self, body: str) -> Pose:
        """Where a body is, in the frame of the room."""
        b = self.model.body(body).id
        return Pose(self.data.xpos[b].copy(), self.data.xmat[b].reshape(3, 3).copy(), WORLD)

    def joint(self, name: str) -> float:
        """Position of a hinge (rad) or slide (m)."""
        return float(self.data.qpos[self.model.jnt_qposadr[self.model.joint(name).id]])

    def place(self, body: str, position: Array, quaternion: Array) -> None:
        """Pose a free object at once (at reset only)."""
        address = int(self.model.joint(body).qposadr[0])
        self.data.qpos[address : address + 3] = position
        self.data.qpos[address + 3 : address + 7] = quaternion

    def moving(self) -> float:
        """Largest speed of any joint in the model (m/s or rad/s)."""
        return float(np.abs(self.data.qvel).max())

    def warnings(self) -> list[str]:
        """What MuJoCo has warned of since the start. It then goes on with a state that is wrong, or made up."""
        return [mujoco.mjtWarning(kind).name for kind, warned in enumerate(self.data.warning) if warned.number]
