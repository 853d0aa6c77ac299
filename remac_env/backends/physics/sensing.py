"""What one robot senses: itself without error, everything else as it is seen."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import mujoco
import numpy as np
from numpy.typing import NDArray

from remac_env.backends.physics.perception import Perception
from remac_env.backends.physics.pose import Pose
from remac_env.backends.physics.simulation import CONTROL_PERIOD, RobotHandle, Simulation
from remac_env.backends.physics.snapshot import shifted
from remac_env.errors import LifecycleError, UnknownNameError, check_choice
from remac_env.kitchen.fixtures import FixtureReading
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.frame import WORLD
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots.rotation import Array, about_z, quaternion
from remac_env.state import WorldState

Draw = Callable[[str], Mapping[str, NDArray[np.uint8]]]
"""What a robot's cameras show."""


_SOLID = np.array([0, 0, 0, 1, 0, 0], np.uint8)  # the group of colliders, see remac_env.robots.panda.model


class Senses:
    """The kitchen as one robot sees it through an episode; in the frame of the room, all of it copies."""

    def __init__(
        self, simulation: Simulation, robot: RobotHandle, layout: Layout, objects: Mapping[str, Category]
    ) -> None:
        self._simulation, self._robot = simulation, robot
        self.layout, self.objects, self.perception = layout, objects, Perception()
        self.model = simulation.model  # shapes, with fixtures where they really are: see `stand`
        self.geoms, self.joint = simulation.geoms, simulation.joint
        self.robots = tuple(simulation.robots)

    @property
    def name(self) -> str:
        """The robot."""
        return self._robot.name

    @property
    def ticks(self) -> int:
        """Control periods since the start."""
        return self._simulation.ticks

    def look(self, chance: np.random.Generator, noise: float, held: str | None) -> None:
        """Look anew: draw all errors, with a standard deviation of ``noise``, m. ``held``: what the hand holds."""
        self.perception.draw(chance, noise, self.layout, self.objects, held)
        if held is not None:
            self.hold(held)

    def hold(self, body: str) -> None:
        """Note that the robot's hand has taken an object, which it goes on misjudging as it does now."""
        self.perception.hold(body, self._simulation.pose(body).rotation)

    def pose(self, name: str) -> Pose:
        """Where an object is seen, or a part of a fixture by the name of its body, site or geom."""
        if name in self.objects:
            truth = self._simulation.pose(name)
            return Pose(*self.perception.seen(name, truth.position, truth.rotation), WORLD)
        position, rotation = self._part(name)
        error = self.perception.fixtures.get(name.partition("/")[0])
        if error is None:
            return Pose(position, rotation, WORLD)
        return Pose(error.point(position), about_z(error.turn) @ rotation, WORLD)

    def _part(self, name: str) -> tuple[Array, Array]:
        """Position and rotation of a part in the simulation."""
        model, data = self._simulation.model, self._simulation.data
        kinds = mujoco.mjtObj
        for kind, places, turns in (
            (kinds.mjOBJ_SITE, data.site_xpos, data.site_xmat), (kinds.mjOBJ_BODY, data.xpos, data.xmat),
            (kinds.mjOBJ_GEOM, data.geom_xpos, data.geom_xmat),
        ):  # fmt: skip
            number = mujoco.mj_name2id(model, kind, name)
            if number >= 0:
                return places[number].copy(), turns[number].reshape(3, 3).copy()
        parts = [model.site(k).name for k in range(model.nsite)] + [model.body(k).name for k in range(1, model.nbody)]
        listed = ", ".join(sorted({*self.objects, *parts} - {""}))
        raise UnknownNameError(f"unknown object or part of a fixture {name!r}; valid: {listed}")

    def slot(self, name: str) -> Pose:
        """Where the middle of a slot is seen; of one in a drawer, where the drawer has it now."""
        fixture, middle = self.layout.slots[name].fixture, np.array(self.layout.middle(name))
        at = middle + self.off(fixture, middle) + shifted(self._simulation, self.layout, name)
        return Pose(at, about_z(self.turned(fixture)) @ self.layout.frame(fixture).rotation, WORLD)

    def off(self, part: str, point: Array) -> Array:
        """By how much (3,) a point (3,) of a fixture seems to be off; ``part``: a name that begins with it."""
        error = self.perception.fixtures.get(part.partition("/")[0])
        return np.zeros(3) if error is None else error.point(np.array(point)) - np.array(point)

    def located(self, part: str, point: Array) -> Array:
        """Where a point (3,) of a fixture is seen."""
        error = self.perception.fixtures.get(part.partition("/")[0])
        return point if error is None else error.point(point)

    def turned(self, part: str) -> float:
        """By how much a fixture seems to be turned about the vertical (rad)."""
        error = self.perception.fixtures.get(part.partition("/")[0])
        return 0.0 if error is None else error.turn

    def reading(self, fixture: str) -> FixtureReading:
        """What a fixture's joints say now."""
        check_choice("fixture", fixture, self.layout.fixtures)
        return self.layout.fixtures[fixture].read(self._simulation.model, self._simulation.data)

    def moved(self, slot: str) -> Array:
        """By how much (3,) a slot has moved with its drawer."""
        return shifted(self._simulation, self.layout, slot)

    def scan(self, angles: Array, *, height: float, farthest: float) -> Array:
        """Distances (n,), m, from the axis of the base to what is solid around it, at angles (n,) to the left of ahead.

        ``height``: over the floor, m. ``farthest``: what is said where nothing is met up to there.
        """
        model, count = self._simulation.model, len(angles)
        x, y, yaw = self._robot.standing
        ways = np.stack([np.cos(yaw + angles), np.sin(yaw + angles), np.zeros(count)], axis=1).ravel()
        met, far = np.empty(count, np.int32), np.empty(count)
        own = model.body(f"{self.name}/base").id
        start = np.array([x, y, height])
        data = self._simulation.data
        mujoco.mj_multiRay(model, data, start, ways, _SOLID, True, own, met, far, None, count, farthest)
        return np.where(met < 0, farthest, far)

    def positions(self) -> Array:
        """All joint positions (nq,), of objects as they are seen."""
        qpos = self._simulation.data.qpos.copy()
        for body in self.perception.objects:
            address = int(self.model.joint(body).qposadr[0])
            seen = self.pose(body)
            qpos[address : address + 7] = [*seen.position, *quaternion(seen.rotation)]
        return qpos

    def stand(self, model: mujoco.MjModel) -> None:
        """Stand the fixtures of a copy of the model where the robot sees them."""
        truth = self.model
        names = [truth.body(body).name for body in range(truth.nbody)]
        for body, name in enumerate(names):
            error = self.perception.fixtures.get(name.partition("/")[0])
            ground = truth.body_parentid[body]
            if error is None or truth.body_parentid[ground] != 0 or not names[ground].startswith("wall/"):
                continue
            turn = np.empty(9)
            mujoco.mju_quat2Mat(turn, truth.body_quat[ground])
            out = turn.reshape(3, 3)
            seen = error.point(truth.body_pos[ground] + out @ truth.body_pos[body])
            model.body_pos[body] = out.T @ (seen - truth.body_pos[ground])
            # All of them are turned about the vertical alone, so the order of turns does not matter.
            mujoco.mju_mulQuat(model.body_quat[body], quaternion(about_z(error.turn)), truth.body_quat[body])

    def pictures(self) -> Mapping[str, NDArray[np.uint8]]:
        """What the robot's cameras show now."""
        if self._simulation.pictures is None:
            raise LifecycleError("nothing draws pictures here; valid: an environment, or PhysicsBackend.pictures")
        return self._simulation.pictures(self.name)


class Felt:
    """What a robot feels of itself; see :class:`remac_env.backends.physics.controllers.base.Proprioception`."""

    def __init__(self, robot: RobotHandle) -> None:
        self._robot = robot

    @property
    def q(self) -> Array:
        """The configuration (n,) in which it is."""
        return self._robot.q

    @property
    def commanded(self) -> Array:
        """The set-points (n,) in force."""
        return self._robot.commanded.copy()

    @property
    def commanded_opening(self) -> float:
        """The set-point of each finger, m."""
        return self._robot.grip

    @property
    def opening(self) -> float:
        """The distance between the fingertips, m."""
        return self._robot.opening

    @property
    def grip(self) -> Pose:
        """The pose of the point between the fingertips."""
        return self._robot.grip_pose

    @property
    def push(self) -> float:
        """The force, N, with which the base pushes along the floor."""
        return self._robot.push


@dataclass(frozen=True, eq=False)
class Briefed:
    """What a robot senses while it carries out one subtask, with what it was told; see ``Sensing``."""

    _senses: Senses
    body: Felt
    station: Station
    goal: Station | None
    told: WorldState
    random: np.random.Generator
    _began: int = field(init=False)

    def __post_init__(self) -> None:
        """Note when it began."""
        object.__setattr__(self, "_began", self._senses.ticks)

    @property
    def name(self) -> str:
        """The robot."""
        return self._senses.name

    @property
    def layout(self) -> Layout:
        """The floor plan."""
        return self._senses.layout

    @property
    def objects(self) -> Mapping[str, Category]:
        """What there is by name."""
        return self._senses.objects

    @property
    def seconds(self) -> float:
        """Simulated time since the subtask began."""
        return (self._senses.ticks - self._began) * CONTROL_PERIOD

    def pose(self, name: str) -> Pose:
        """Where an object or a part of a fixture is seen."""
        return self._senses.pose(name)

    def slot(self, name: str) -> Pose:
        """Where the middle of a slot is seen."""
        check_choice("slot", name, self._senses.layout.slots)
        return self._senses.slot(name)

    def reading(self, fixture: str) -> FixtureReading:
        """How far doors stand open and switches are turned."""
        return self._senses.reading(fixture)

    def scan(self, angles: Array, *, height: float, farthest: float) -> Array:
        """Distances (n,) to what is solid around the base."""
        return self._senses.scan(angles, height=height, farthest=farthest)

    def pictures(self) -> Mapping[str, NDArray[np.uint8]]:
        """What the cameras show now."""
        return self._senses.pictures()
