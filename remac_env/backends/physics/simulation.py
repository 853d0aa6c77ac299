"""The simulated kitchen: MuJoCo model and data, the clock, and handles on robots and objects."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

import mujoco
import numpy as np

from remac_env.backends.physics.bodies import Bodies
from remac_env.backends.physics.perception import Perception
from remac_env.errors import PhysicsError
from remac_env.kitchen.frame import WORLD, Frame
from remac_env.robots import panda
from remac_env.robots.rotation import Array

SUBSTEPS = 10  # steps of 5 ms, see remac_env.kitchen.builder
CONTROL_PERIOD = 0.05  # s


class RobotHandle:
    """Addresses of one robot in the model, its commanded configuration ``q`` (11,) and finger opening ``grip`` (m).

    Configurations and poses are told in the robot's ``frame``, that of the wall it faces; see :meth:`enter`.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, name: str) -> None:
        self.name = name
        self.fingers = tuple(f"{name}/{part}" for part in panda.FINGERS)
        self._data = data
        joints = [model.joint(f"{name}/{part}") for part in panda.JOINTS]
        servos = [model.actuator(f"{name}/{part}") for part in panda.JOINTS]
        fingers = [model.joint(f"{name}/{part}") for part in panda.FINGERS]
        self.qpos = np.array([j.qposadr[0] for j in joints])
        self.finger_qpos = np.array([j.qposadr[0] for j in fingers])
        self._controls = np.array([s.id for s in servos])
        self._activations = np.array([s.actadr[0] for s in servos])
        self._finger_controls = np.array([model.actuator(f"{name}/{part}").id for part in panda.FINGERS])
        self._site = model.site(f"{name}/grip").id
        self.frame = WORLD
        self.q = panda.tucked(0.0, 0.0, 0.0)
        self.grip = panda.FINGER_OPEN

    def put(self, q: Array, grip: float = panda.FINGER_OPEN) -> None:
        """Pose the robot at once (at reset only)."""
        self.q, self.grip = np.array(q, float), float(grip)
        self._data.qpos[self.qpos] = self.in_world(self.q)
        self._data.qpos[self.finger_qpos] = grip
        self._data.act[self._activations] = self.in_world(self.q)

    def apply(self) -> None:
        """Write the servo commands that bring the setpoints to ``q`` within one control period."""
        if not math.isfinite(float(self.q.sum()) + self.grip):
            raise PhysicsError(f"{self.name}: command is not finite: {self.q}")
        ctrl = self._data.ctrl
        ctrl[self._controls] = (self.in_world(self.q) - self._data.act[self._activations]) / CONTROL_PERIOD
        ctrl[self._finger_controls] = self.grip

    @property
    def measured(self) -> Array:
        """The configuration (11,) in which the robot is."""
        return self.in_frame(self._data.qpos[self.qpos])

    @property
    def standing(self) -> Array:
        """The base pose (3,) in which the robot is, in the world."""
        return self._data.qpos[self.qpos[:3]].copy()

    def enter(self, frame: Frame) -> None:
        """Tell configurations and poses in another frame from now on."""
        q = self.in_world(self.q)
        self.frame = frame
        self.q = self.in_frame(q)

    def in_world(self, q: Array) -> Array:
        """A configuration of the robot's frame, in the world."""
        told = np.array(q, float)
        told[:2] = self.frame.point(told[0], told[1])
        told[2] += self.frame.heading
        return told

    def in_frame(self, q: Array) -> Array:
        """A configuration of the world, in the robot's frame."""
        told = np.array(q, float)
        told[:2] = self.frame.local(told[0], told[1])
        told[2] -= self.frame.heading
        return told

    @property
    def push(self) -> float:
        """The force (N) that the base gives along the floor now."""
        return float(np.linalg.norm(self._data.actuator_force[self._controls[:2]]))

    @property
    def opening(self) -> float:
        """Distance between the fingertip pads (m)."""
        return float(self._data.qpos[self.finger_qpos].sum())

    def grip_pose(self) -> tuple[Array, Array]:
        """Measured position (3,) and rotation (3, 3) of the grip site."""
        return pose_in(self.frame, self._data.site_xpos[self._site], self._data.site_xmat[self._site].reshape(3, 3))

    @property
    def heading(self) -> Array:
        """Unit vector (3,) in which the commanded base looks, in the robot's frame."""
        return np.array([np.cos(self.q[2]), np.sin(self.q[2]), 0.0])


class Simulation(Bodies):
    """Model, data and clock, with the robots called ``robots``.

    ``before``: a simulation that has ended; its data are used again where it was of the same model. ``probe`` is called
    after every step of 5 ms, for measuring; motion is the same with it and without.
    """

    def __init__(self, model: mujoco.MjModel, robots: Iterable[str], before: Simulation | None = None) -> None:
        again = before is not None and before.model is model
        data: mujoco.MjData = before.data if before and again else mujoco.MjData(model)
        super().__init__(model, data, {})
        self.robots: dict[str, RobotHandle] = {name: RobotHandle(model, data, name) for name in robots}
        self.ticks = 0
        self.probe: Callable[[], None] | None = None

    def clear(self) -> None:
        """Back to the model's initial state; nothing of what went before remains."""
        super().clear()
        self.ticks = 0

    def tick(self) -> None:
        """One control period under the robots' present commands."""
        for robot in self.robots.values():
            robot.apply()
        if self.probe is None:
            mujoco.mj_step(self.model, self.data, nstep=SUBSTEPS)
        else:
            for _ in range(SUBSTEPS):
                mujoco.mj_step(self.model, self.data)
                self.probe()
        self.ticks += 1
        if self.data.warning.number.any():
            raise PhysicsError(f"MuJoCo warned after {self.ticks} control steps: {', '.join(self.warnings())}")


class View:
    """The simulation as one robot sees it: poses are expressed in its frame and as ``perception`` misjudges them."""

    def __init__(self, simulation: Simulation, robot: RobotHandle) -> None:
        self._simulation, self._robot, self.perception = simulation, robot, Perception()
        self.model, self.data, self.robots = simulation.model, simulation.data, simulation.robots
        self.geoms, self.joint = simulation.geoms, simulation.joint

    def pose(self, body: str) -> tuple[Array, Array]:
        """Position (3,) and rotation (3, 3) of a body, in the robot's frame."""
        return pose_in(self._robot.frame, *self.in_world(body))

    def in_world(self, body: str) -> tuple[Array, Array]:
        """The same in the world."""
        return self.perception.thing(body, *self._simulation.pose(body))

    def hold(self, body: str) -> None:
        """Note that the robot's hand has taken an object, which it goes on misjudging as it does now."""
        self.perception.hold(body, self._simulation.pose(body)[1])

    def located(self, part: str, point: Array) -> Array:
        """Where a point (3,) of a fixture, robot's frame, is seen; ``part``: a name that begins with the fixture's."""
        error = self.perception.fixtures.get(part.partition("/")[0])
        if error is None:
            return point
        frame = self._robot.frame
        x, y, z = error.point(np.array([*frame.point(float(point[0]), float(point[1])), point[2]]))
        return np.array([*frame.local(x, y), z])

    def off(self, part: str, point: Sequence[float]) -> Array:
        """By how much (3,) a point (3,) of a fixture seems to be off, both in the world."""
        error = self.perception.fixtures.get(part.partition("/")[0])
        return np.zeros(3) if error is None else error.point(np.array(point)) - np.array(point)

    def turned(self, part: str) -> float:
        """By how much a fixture seems to be turned about the vertical (rad)."""
        error = self.perception.fixtures.get(part.partition("/")[0])
        return 0.0 if error is None else error.turn


def pose_in(frame: Frame, position: Array, rotation: Array) -> tuple[Array, Array]:
    """A pose of the world, in a frame."""
    x, y = frame.local(float(position[0]), float(position[1]))
    return np.array([x, y, position[2]]), frame.rotation.T @ rotation
