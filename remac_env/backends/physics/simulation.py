"""The simulated kitchen: MuJoCo model and data, the clock, and handles on robots and objects."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping

import mujoco
import numpy as np
from numpy.typing import NDArray

from remac_env.backends.physics.bodies import Bodies
from remac_env.backends.physics.pose import Pose
from remac_env.errors import PhysicsError
from remac_env.kitchen.frame import WORLD
from remac_env.robots import bodies
from remac_env.robots.body import Body
from remac_env.robots.rotation import Array

SUBSTEPS = 10  # steps of 5 ms, see remac_env.kitchen.builder
CONTROL_PERIOD = 0.05  # s


class RobotHandle:
    """One robot of the model: where its joints are, and the set-points of its servos. All in the frame of the room.

    ``commanded``: set-points (n,) in force, see `remac_env.robots.body`; ``grip``: of each finger, m. They stay as they
    are until others are taken. ``let_go``: whether its hand opens, whatever it was told.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, name: str, body: Body) -> None:
        self.name, self.body = name, body
        self._most = body.top_speed * CONTROL_PERIOD  # by which set-points move at most
        self.fingers = tuple(f"{name}/{part}" for part in body.fingers)
        self._data = data
        joints = [model.joint(f"{name}/{part}") for part in body.joints]
        servos = [model.actuator(f"{name}/{part}") for part in body.joints]
        fingers = [model.joint(f"{name}/{part}") for part in body.fingers]
        self.qpos = np.array([j.qposadr[0] for j in joints])
        self.finger_qpos = np.array([j.qposadr[0] for j in fingers])
        self._joints = _as_slice(self.qpos)
        self._controls = _as_slice(np.array([s.id for s in servos]))
        self._activations = _as_slice(np.array([s.actadr[0] for s in servos]))
        self._finger_controls = _as_slice(np.array([model.actuator(f"{name}/{part}").id for part in body.fingers]))
        self._site = model.site(f"{name}/grip").id
        self.commanded = body.tuck(0.0, 0.0, 0.0)
        self.grip = body.finger_travel
        self.let_go = False

    def put(self, q: Array, grip: float | None = None) -> None:
        """Pose the robot at once (at reset only); with its hand open where ``grip`` is None."""
        grip = self.body.finger_travel if grip is None else grip
        self.hold(q, grip)
        self._data.qpos[self.qpos] = self.commanded
        self._data.qpos[self.finger_qpos] = grip
        self._data.act[self._activations] = self.commanded

    def take(self, q: Array, grip: float) -> None:
        """Take set-points for the next control period, which move no faster than the maker allows."""
        step, most = q - self.commanded, self._most
        fast = np.abs(step) > most
        if any(fast.tolist()):
            q = np.where(fast, self.commanded + np.clip(step, -most, most), q)
        self.hold(q, grip)

    def hold(self, q: Array, grip: float) -> None:
        """Hold set-points from now on."""
        self.commanded, self.grip = np.array(q, float), float(grip)

    def apply(self) -> None:
        """Write the servo commands that bring the set-points to those in force within one control period."""
        if not math.isfinite(sum(self.commanded.tolist()) + self.grip):
            raise PhysicsError(f"{self.name}: command is not finite: {self.commanded}")
        ctrl = self._data.ctrl
        ctrl[self._controls] = (self.commanded - self._data.act[self._activations]) / CONTROL_PERIOD
        ctrl[self._finger_controls] = self.body.finger_travel if self.let_go else self.grip

    @property
    def q(self) -> Array:
        """The configuration (n,) in which the robot is."""
        q: Array = self._data.qpos[self._joints]
        return q.copy()

    @property
    def standing(self) -> Array:
        """The base pose (3,) in which the robot is."""
        return self._data.qpos[self.qpos[:3]].copy()

    @property
    def push(self) -> float:
        """The force (N) that the base gives along the floor now."""
        return float(np.linalg.norm(self._data.actuator_force[self._controls][:2]))

    @property
    def opening(self) -> float:
        """Distance between the fingertip pads (m)."""
        return float(self._data.qpos[self.finger_qpos].sum())

    @property
    def grip_pose(self) -> Pose:
        """Measured pose of the grip site."""
        rotation = self._data.site_xmat[self._site].reshape(3, 3).copy()
        return Pose(self._data.site_xpos[self._site].copy(), rotation, WORLD)


def _as_slice(ids: NDArray[np.int_]) -> slice | NDArray[np.int_]:
    """The same entries of an array, as a slice where they follow one another, which is quicker to read and write."""
    first = int(ids[0])
    return slice(first, first + len(ids)) if (np.diff(ids) == 1).all() else ids


class Simulation(Bodies):
    """Model, data and clock, with the robots called ``robots``.

    ``before``: a simulation that has ended; its data are used again where it was of the same model. ``probe`` is called
    after every step of 5 ms, for measuring; motion is the same with it and without. ``forces`` is called before every
    step, to apply what is neither a robot's nor the kitchen's own. ``pictures``: what the cameras of a robot show now.
    """

    def __init__(
        self, model: mujoco.MjModel, robots: Iterable[str], before: Simulation | None = None, body: Body | None = None
    ) -> None:
        again = before is not None and before.model is model
        data: mujoco.MjData = before.data if before and again else mujoco.MjData(model)
        super().__init__(model, data, {})
        self.body = body or bodies.get()
        self.robots: dict[str, RobotHandle] = {name: RobotHandle(model, data, name, self.body) for name in robots}
        self.ticks = 0
        self._warned = data.warning  # made anew by MuJoCo's binding each time it is asked for
        self.probe: Callable[[], None] | None = None
        self.forces: Callable[[], None] | None = None
        self.pictures: Callable[[str], Mapping[str, NDArray[np.uint8]]] | None = None

    def clear(self) -> None:
        """Back to the model's initial state; nothing of what went before remains."""
        super().clear()
        self.ticks = 0

    def tick(self) -> None:
        """One control period under the robots' present commands."""
        for robot in self.robots.values():
            robot.apply()
        if self.probe is None and self.forces is None:
            mujoco.mj_step(self.model, self.data, nstep=SUBSTEPS)
        else:
            for _ in range(SUBSTEPS):
                if self.forces is not None:
                    self.forces()
                mujoco.mj_step(self.model, self.data)
                if self.probe is not None:
                    self.probe()
        self.ticks += 1
        if self._warned.number.any():
            raise PhysicsError(f"MuJoCo warned after {self.ticks} control steps: {', '.join(self.warnings())}")

