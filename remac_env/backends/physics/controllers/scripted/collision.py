"""Collision checks on a copy of the world, for one robot at a time.

The copied model differs from the simulated one only in what meets what: pairs without the planning robot (or the
object in its hand) are switched off, and margins are added around the robot. The simulation is never touched.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from remac_env.backends.physics.controllers.scripted.robot import Robot, View
from remac_env.backends.physics.controllers.scripted.verdicts import FREE, Free, Hit
from remac_env.backends.physics.pose import Pose
from remac_env.robots.rotation import Array, quaternion

ARM_MARGIN = 0.008  # m, around arm links, column and base
TOUCH_MARGIN = 0.001  # m, around the gripper where it works; more would forbid every grasp on a counter
TRANSIT_MARGIN = 0.012  # m, around the gripper and what it holds on the way: the arm lags its command at speed
HELD_MARGIN = 0.010  # m, around what is held on straight ways: a vessel goes on drooping in the fingers

OTHER, ARM, GRIPPER, HELD, TARGET, IGNORED = range(6)


def _forbidden() -> np.ndarray:
    """Table (6, 6): which classes of geoms must not meet."""
    bad = np.zeros((6, 6), bool)
    bad[ARM, [OTHER, ARM, GRIPPER, HELD, TARGET]] = True
    bad[GRIPPER, OTHER] = True
    bad[HELD, OTHER] = True
    return bad | bad.T


_FORBIDDEN = _forbidden()


@dataclass(frozen=True)
class Attached:
    """An object in the hand: its body, qpos address, and its pose in the grip frame."""

    body: str
    address: int
    position: Array
    rotation: Array


@dataclass(frozen=True)
class KeepOutPlane:
    """An upright plane in the world: its normal, of length 1, and how far along it one may go (m)."""

    x: float
    y: float
    limit: float

    @cached_property
    def normal(self) -> Array:
        """The normal (3,)."""
        return np.array([self.x, self.y, 0.0])


class CollisionChecker:
    """Answers whether a configuration of one robot, expressed in the robot's frame, is free of forbidden contact."""

    def __init__(self, sensed: View, robot: Robot) -> None:
        self.sensed, self.robot = sensed, robot
        model = sensed.model
        self.model = copy.copy(model)
        self._use(mujoco.MjData(self.model))
        self.checks = 0
        names = [model.body(b).name for b in range(model.nbody)]
        own = np.array([n.startswith(robot.name + "/") for n in names])
        gripper = {f"{robot.name}/{part}" for part in ("hand", *robot.body.fingers)}
        grip = np.array([n in gripper for n in names])
        others = np.array([any(n.startswith(r + "/") for r in sensed.robots) for n in names]) & ~own
        self._body_names, self._others = names, others
        of = model.geom_bodyid
        self._classes = np.full(model.ngeom, OTHER)
        self._classes[own[of]] = ARM
        self._classes[grip[of]] = GRIPPER
        self.model.geom_contype[model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE] = 0  # bases are within margins of it
        self._own_grip = np.flatnonzero(grip[of])
        # Only pairs with the planning robot are tested; body masks must follow, the broad phase reads them.
        for mask, at in ((self.model.geom_conaffinity, of), (self.model.body_conaffinity, slice(None))):
            mask[~(own | others)[at]], mask[others[at]] = 0, 4
        self._keep_away(np.flatnonzero(self._classes == ARM), ARM_MARGIN)
        self._keep_away(self._own_grip, TOUCH_MARGIN)
        self.model.opt.enableflags = 0
        self.classes = self._classes.copy()
        self.held: Attached | None = None
        self.keep_out: tuple[KeepOutPlane, ...] = ()  # robot and held object must stay on this side of them
        self._spans = _geom_spans(model)
        self._radii = np.linalg.norm(self._spans[:, :3], axis=1) + self._spans[:, 3]
        self._confined = np.flatnonzero(own[of])
        self._start = self.data.qpos.copy()

    def begin(
        self, *, target: Iterable[int] = (), held: str | None = None, contents: Iterable[str] = (),
        held_meets: bool = True,
    ) -> None:
        """Copy the present world. The gripper and what it holds may touch the geoms ``target``.

        ``contents`` ride in a held vessel and are ignored. ``held_meets=False`` ignores the held object's contacts.
        """
        self.release()
        self.data.qpos[:] = self.sensed.positions()
        self._start = self.data.qpos.copy()
        self.classes[:] = self._classes
        self.mark(target, TARGET)
        for body in contents:
            self.mark(self.sensed.geoms(body), IGNORED)
        if held is not None:
            grip = self.robot.grip_pose()
            self.hold(held, grip, self.sensed.pose(held), meets=held_meets)

    def look(self) -> None:
        """Stand the fixtures where the robot sees them."""
        self.sensed.stand(self.model)

    def mark(self, geoms: Iterable[int], kind: int) -> None:
        """Class ``kind`` for these geoms until the next :meth:`begin`."""
        for geom in geoms:
            self.classes[geom] = kind

    def fingers(self, opening: float) -> None:
        """Plan with each finger ``opening`` (m) from the middle."""
        self.data.qpos[self.robot.finger_qpos] = opening

    def hold(self, body: str, grip: Pose, pose: Pose, *, meets: bool = True) -> None:
        """Attach ``body`` to the hand, at ``pose`` when the grip is at ``grip``."""
        self.release()
        geoms = self.sensed.geoms(body)
        self.mark(geoms, HELD)
        self._confined = np.concatenate([self._confined, geoms])
        self._set_meeting(body, 3 if meets else 0)
        address = int(self.sensed.model.joint(body).qposadr[0])
        self.held = Attached(body, address, *grip.of(pose))

    def release(self, *, leave: bool = False) -> None:
        """Detach the held object: back to where it was, or left where it is now."""
        if self.held is None:
            return
        if not leave:
            a = self.held.address
            self.data.qpos[a : a + 7] = self._start[a : a + 7]
        self._set_meeting(self.held.body, 0)
        self._confined = self._confined[: len(self._confined) - len(self.sensed.geoms(self.held.body))]
        self.held = None

    @contextmanager
    def clearance(self, margin: float, *, gripper: bool = True, arm: bool = False) -> Iterator[None]:
        """Keep what is held and the gripper, or the arm alone, ``margin`` (m) away from objects within this context."""
        held = self.sensed.geoms(self.held.body) if self.held and not arm else []
        own = np.flatnonzero(self._classes == ARM) if arm else self._own_grip if gripper else ()
        geoms = np.array([*held, *own], int)
        before = self.model.geom_margin[geoms]
        self._keep_away(geoms, margin)
        try:
            yield
        finally:
            self._keep_away(geoms, before)

    def free(self, q: Array, joints: Mapping[int, float] | None = None) -> Free | Hit:
        """Whether configuration ``q`` (n,) has no forbidden contact; ``joints`` sets other qpos entries first."""
        self.checks += 1
        data = self.data
        self.pose(q, joints)
        if any(self._beyond(plane) for plane in self.keep_out):
            return Hit(self.robot.name, "the room of another robot")
        try:
            mujoco.mj_collision(self.model, data)
        except mujoco.FatalError:
            # Deeply overlapping boxes can yield more contacts than MuJoCo allows for; that is not a free configuration.
            self._renew()
            return Hit(self.robot.name, "something it overlaps deeply")
        count = data.ncon
        if count == 0:
            return FREE
        pairs = data.contact.geom[:count]
        kinds = self.classes[pairs]
        bad = _FORBIDDEN[kinds[:, 0], kinds[:, 1]]
        if not bad.any():
            return FREE
        first = pairs[int(np.argmax(bad))]
        one, other = (self._body_names[self.sensed.model.geom_bodyid[g]] or "world" for g in first)
        return Hit(one, other)

    def pose(self, q: Array, joints: Mapping[int, float] | None = None) -> None:
        """Put the robot and what it holds into configuration ``q`` (n,), without looking at contacts."""
        data, qpos = self.data, self._qpos
        q = self.robot.in_world(q)
        qpos[self.robot.qpos] = q
        if joints:
            for address, value in joints.items():
                qpos[address] = value
        if self.held is not None:
            a = self.held.address
            position, rotation = self.robot.kinematics.forward(q)
            qpos[a : a + 3] = position + rotation @ self.held.position
            qpos[a + 3 : a + 7] = quaternion(rotation @ self.held.rotation)
        mujoco.mj_kinematics(self.model, data)

    def extent(self) -> tuple[Array, Array]:
        """Low and high corners (n, 3), in the world, around the geoms of robot and held object, as last checked."""
        return self._boxes(self._confined)

    def obstacles(self) -> tuple[Array, Array]:
        """The same (m, 3) around all that these must not meet, with the margins; without other robots and the floor."""
        met = (self.classes == OTHER) | (self.classes == TARGET)
        met &= ~self._others[self.model.geom_bodyid] & (self.model.geom_type != mujoco.mjtGeom.mjGEOM_PLANE)
        ids = np.flatnonzero(met)
        low, high = self._boxes(ids)
        margins = self.model.geom_margin[ids, None] + self.model.geom_margin[self._confined].max()
        return low - margins, high + margins

    def _boxes(self, ids: np.ndarray) -> tuple[Array, Array]:
        turns = np.abs(self._geom_xmat[ids])
        reach = np.einsum("nij,nj->ni", turns, self._spans[ids, :3]) + self._spans[ids, 3:]
        return self._geom_xpos[ids] - reach, self._geom_xpos[ids] + reach

    @contextmanager
    def without_robots(self) -> Iterator[None]:
        """Leave the other robots out of account within this context."""
        self._set_others(0)
        try:
            yield
        finally:
            self._set_others(4)

    def _set_others(self, bits: int) -> None:
        self.model.geom_conaffinity[self._others[self.model.geom_bodyid]] = bits
        self.model.body_conaffinity[self._others] = bits
        self.model.geom_contype[self._others[self.model.geom_bodyid]] = bits
        self.model.body_contype[self._others] = bits

    def _keep_away(self, geoms: np.ndarray, margin: np.ndarray | float) -> None:
        self.model.geom_margin[geoms] = margin
        self.model.body_margin[self.model.geom_bodyid[geoms]] = margin  # by which the broad phase goes

    def _renew(self) -> None:
        """Fresh memory after MuJoCo gave up in the middle of a computation."""
        qpos = self.data.qpos.copy()
        self._use(mujoco.MjData(self.model))
        self.data.qpos[:] = qpos

    def _use(self, data: mujoco.MjData) -> None:
        """Take these data, and views on what is read at every check."""
        self.data, self._qpos = data, data.qpos
        self._geom_xpos, self._geom_xmat = data.geom_xpos, data.geom_xmat.reshape(-1, 3, 3)

    def _beyond(self, plane: KeepOutPlane) -> bool:
        """True when a geom of the robot or of what it holds reaches over the keep-out plane."""
        ids, normal = self._confined, plane.normal
        along = self._geom_xpos[ids] @ normal
        # Spheres around the geoms are quick to test; few configurations need their real spans.
        doubtful = along + self._radii[ids] > plane.limit
        if not doubtful.any():
            return False
        ids = ids[doubtful]
        turned = np.abs(np.einsum("nij,i->nj", self._geom_xmat[ids], normal))
        reach = (turned * self._spans[ids, :3]).sum(axis=1) + self._spans[ids, 3]
        return bool((along[doubtful] + reach).max() > plane.limit)

    def _set_meeting(self, body: str, bits: int) -> None:
        self.model.geom_conaffinity[self.sensed.geoms(body)] = bits
        self.model.body_conaffinity[self.sensed.model.body(body).id] = bits


def _geom_spans(model: mujoco.MjModel) -> np.ndarray:
    """(ngeom, 4): half extents along a geom's own axes, and a radius around them."""
    spans = np.zeros((model.ngeom, 4))
    size, kind = model.geom_size, model.geom_type
    box = kind == mujoco.mjtGeom.mjGEOM_BOX
    rod = (kind == mujoco.mjtGeom.mjGEOM_CAPSULE) | (kind == mujoco.mjtGeom.mjGEOM_CYLINDER)
    spans[box, :3] = size[box]
    spans[rod, 2], spans[rod, 3] = size[rod, 1], size[rod, 0]
    spans[~box & ~rod, 3] = size[~box & ~rod].max(axis=1)
    return spans
