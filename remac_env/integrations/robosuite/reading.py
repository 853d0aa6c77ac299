"""robosuite's simulation as our world is read from it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import mujoco
import numpy as np

from remac_env.backends.physics.bodies import Bodies
from remac_env.errors import OptionError
from remac_env.robots.rotation import Array

_PADS = ("left_fingerpad", "right_fingerpad")
"""What robosuite calls the geoms with which grippers hold."""


class Robot:
    """A robot of robosuite's, under one of our names."""

    def __init__(self, name: str, robot: Any, sim: Any) -> None:
        """Raises OptionError for a robot that does not hold objects between two pads of one hand."""
        self.name, self._sim = name, sim
        self.fingers = fingers(robot, sim.model)
        self._base = sim.model.body_name2id(_base_body(robot))

    @property
    def standing(self) -> Array:
        """The base pose (3,) in the world."""
        x, y, _ = self._sim.data.body_xpos[self._base]
        turn = self._sim.data.body_xmat[self._base].reshape(3, 3)
        return np.array([x, y, np.arctan2(turn[1, 0], turn[0, 0])])

    def put(self, q: Array) -> None:
        """Nothing: the model says where bases stand at the start, and robosuite how the arm is held."""


class Reading(Bodies):
    """What reading a world and posing a start need of a simulation, out of robosuite's."""

    def __init__(self, sim: Any, robots: Mapping[str, Any]) -> None:
        handles = {name: Robot(name, robot, sim) for name, robot in robots.items()}
        super().__init__(sim.model._model, sim.data._data, handles)

    def clear(self) -> None:
        """Nothing: robosuite has cleared already, and posed its robots."""


def check_robots(robots: Sequence[Any]) -> None:
    """See that every robot has one gripper with two pads, before anything is built.

    Raises:
        OptionError: where not.
    """
    for robot in robots:
        grippers = _grippers(robot)
        if len(grippers) != 1 or not all(grippers[0].important_geoms.get(pad) for pad in _PADS):
            raise _unfit(robot)


def fingers(robot: Any, model: Any) -> tuple[str, ...]:
    """The bodies of a robot's fingertips, one for each pad; raises OptionError where a pad is not one body."""
    (gripper,) = _grippers(robot)
    raw, found = model._model, list[str]()
    for pad in _PADS:
        geoms = [mujoco.mj_name2id(raw, mujoco.mjtObj.mjOBJ_GEOM, name) for name in gripper.important_geoms[pad]]
        bodies = {int(raw.geom_bodyid[geom]) for geom in geoms}
        if min(geoms) < 0 or len(bodies) != 1:
            raise _unfit(robot)
        found.append(str(raw.body(bodies.pop()).name))
    return tuple(found)


def _unfit(robot: Any) -> OptionError:
    return OptionError(
        f"robot {robot.name!r} does not hold objects between the two pads of one gripper; valid: robots of robosuite "
        "that do, such as 'PandaOmron'"
    )


def _grippers(robot: Any) -> list[Any]:
    """The grippers that a robot's hands have."""
    return [robot.gripper[arm] for arm in robot.arms if robot.gripper.get(arm) is not None]


def _base_body(robot: Any) -> str:
    """The body that moves when the robot drives; of a robot that cannot drive, its root."""
    base = robot.robot_model.base
    drives = base is not None and base.joints
    return str(base.correct_naming("base") if drives else robot.robot_model.root_body)
