"""The robot as its skills see it: set-points and proprioception, both in the frame of the wall that it faces."""

from __future__ import annotations

import numpy as np

from remac_env.backends.physics.controllers.base import Command, in_room, seen_from
from remac_env.backends.physics.pose import Pose
from remac_env.backends.physics.sensing import Senses
from remac_env.backends.physics.simulation import RobotHandle
from remac_env.kitchen.fixtures import FixtureReading
from remac_env.kitchen.frame import WORLD, Frame
from remac_env.robots.body import Kinematics
from remac_env.robots.rotation import Array

_FALLEN = 0.4  # m; objects lower than this have fallen down


class Robot:
    """``q`` (n,) and ``grip`` (m of each finger) are commanded by the next :attr:`command`, expressed in ``frame``."""

    def __init__(self, handle: RobotHandle, kinematics: Kinematics) -> None:
        self._handle, self.body, self.kinematics = handle, handle.body, kinematics
        self.name, self.qpos, self.finger_qpos = handle.name, handle.qpos, handle.finger_qpos
        self.frame = WORLD
        self.catch_up()

    def catch_up(self) -> None:
        """Go on from the set-points that are in force."""
        self.q, self.grip = self.in_frame(self._handle.commanded), self._handle.grip

    @property
    def command(self) -> Command:
        """The set-points as they are now."""
        return Command(self.q, self.grip, self.frame)

    @property
    def measured(self) -> Array:
        """The configuration (n,) in which the robot is."""
        return self.in_frame(self._handle.q)

    @property
    def standing(self) -> Array:
        """The base pose (3,) in which the robot is, in the world."""
        return self._handle.standing

    def enter(self, frame: Frame) -> None:
        """Tell configurations and poses in another frame from now on."""
        q = self.in_world(self.q)
        self.frame = frame
        self.q = self.in_frame(q)

    def in_world(self, q: Array) -> Array:
        """A configuration of the robot's frame, in the world."""
        return in_room(q, self.frame)

    def in_frame(self, q: Array) -> Array:
        """A configuration of the world, in the robot's frame."""
        return seen_from(q, self.frame)

    @property
    def push(self) -> float:
        """The force (N) that the base gives along the floor now."""
        return self._handle.push

    @property
    def opening(self) -> float:
        """Distance between the fingertip pads (m)."""
        return self._handle.opening

    def grip_pose(self) -> Pose:
        """Measured pose of the grip site."""
        return self._handle.grip_pose.seen_from(self.frame)

    @property
    def heading(self) -> Array:
        """Unit vector (3,) in which the commanded base looks, in the robot's frame."""
        return np.array([np.cos(self.q[2]), np.sin(self.q[2]), 0.0])


class View:
    """What the robot sees, in its frame."""

    def __init__(self, senses: Senses, robot: Robot) -> None:
        self.senses, self._robot = senses, robot
        self.model, self.robots = senses.model, senses.robots
        self.geoms, self.joint, self.hold = senses.geoms, senses.joint, senses.hold
        self.positions, self.off, self.turned, self.stand = senses.positions, senses.off, senses.turned, senses.stand

    def pose(self, body: str) -> Pose:
        """Where an object is seen, in the robot's frame."""
        return self.senses.pose(body).seen_from(self._robot.frame)

    def in_room(self, body: str) -> Pose:
        """The same in the frame of the room."""
        return self.senses.pose(body)

    def reading(self, fixture: str) -> FixtureReading:
        """What a fixture's joints say now."""
        return self.senses.reading(fixture)

    def on_floor(self, body: str) -> bool:
        """Whether an object lies on the floor, as the robot sees it."""
        return bool(self.pose(body).position[2] < _FALLEN)

    def located(self, part: str, point: Array) -> Array:
        """Where a point (3,) of a fixture, robot's frame, is seen; ``part``: a name that begins with the fixture's."""
        frame = self._robot.frame
        here = np.array([*frame.point(float(point[0]), float(point[1])), point[2]])
        seen = self.senses.located(part, here)
        if seen is here:
            return point
        x, y, z = seen
        return np.array([*frame.local(x, y), z])
