"""Adds one mobile Panda to a MuJoCo description: joints, colliders on every link, position servos.

Bodies, joints and actuators are called ``<robot>/<part>`` with the names in :mod:`remac_env.robots.panda.measures`; the
site ``<robot>/grip`` lies between the fingertip pads (z along the approach, x along the opening).
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import mujoco
import numpy as np

from remac_env.robots.panda import measures as panda
from remac_env.robots.panda.measures import PAD_FRICTION, SKIRT

COLLIDER_GROUP = 3
ROBOT_BIT, ROBOT_MEETS = 4, 7
CONTROL_PERIOD = 0.05  # s; servo setpoints ramp linearly over one period

# kg, of a finger with its drive. The damping of its servo is integrated implicitly; on a finger of a quarter of this it
# hides so much of what contacts do that the pads bounce on a hard handle for ever, 3 mm deep, until it slides out.
FINGER_INERTIA = 1.0

PAD: Mapping[str, object] = MappingProxyType({
    "friction": [PAD_FRICTION, 0.01, 0.001], "condim": 4, "priority": 1, "solref": [0.01, 1.0],
    "solimp": [0.97, 0.99, 0.001, 0.5, 2.0],
})  # fmt: skip
"""How the pads of the fingers touch objects.

Sliding: dry rubber on steel, glass and food is told to grip with 0.5 to 1.1 (0.8 to 1.0 in most tables for rubber on
steel); 1.0. Torsional, m: a patch of a pad's half width of 9.5 mm that presses evenly resists a turn with two thirds of
its radius times the sliding friction, 6 mm; of its half length of 18 mm, 12 mm; 10 mm.
"""

BUMPER: Mapping[str, object] = MappingProxyType({
    "friction": [0.3, 0.005, 0.0001], "priority": 1, "solref": [0.01, 1.0], "solimp": [0.98, 0.999, 0.001, 0.5, 2.0],
})  # fmt: skip
"""How a base touches objects: with a smooth skirt, so that what it pushes slides off it."""

_BOX = mujoco.mjtGeom.mjGEOM_BOX
_CAPSULE = mujoco.mjtGeom.mjGEOM_CAPSULE
_CYLINDER = mujoco.mjtGeom.mjGEOM_CYLINDER
_X_AXIS = (1.0, 0.0, 0.0)


def add_robot(
    spec: mujoco.MjSpec, name: str, *, visual: bool = False, accent: tuple[float, float, float] = (0.1, 0.4, 0.8),
    mount_height: float = panda.MOUNT_HEIGHT,
) -> None:
    """Add the robot ``name`` (for instance ``robot_0``) to ``spec``, at the world's origin.

    ``visual`` also adds drawn geoms (group 1, never colliding, massless); ``accent`` is the RGB colour by which
    robots are told apart. Joints and their order do not depend on ``visual``.
    """
    links = _add_bodies(spec, name, mount_height)
    _add_servos(spec, name)
    for one, other in panda.ALWAYS_NEAR:
        spec.add_exclude(bodyname1=f"{name}/{one}", bodyname2=f"{name}/{other}")
    if visual:
        from remac_env.robots.panda import visual as drawing

        drawing.dress(spec, name, links, accent)


def _collider(body: mujoco.MjsBody, kind: mujoco.mjtGeom, mass: float, **shape: object) -> mujoco.MjsGeom:
    return body.add_geom(
        type=kind, mass=mass, contype=ROBOT_BIT, conaffinity=ROBOT_MEETS, group=COLLIDER_GROUP,
        rgba=[0.3, 0.3, 0.8, 1.0], **shape,
    )


def _add_bodies(spec: mujoco.MjSpec, name: str, mount_height: float) -> dict[str, mujoco.MjsBody]:
    """The tree of bodies with joints and colliders, by short name."""
    bodies: dict[str, mujoco.MjsBody] = {}

    def child(
        parent: mujoco.MjsBody, part: str, pos: tuple[float, ...], quat: np.ndarray | None = None
    ) -> mujoco.MjsBody:
        turn = [1.0, 0.0, 0.0, 0.0] if quat is None else list(quat)
        bodies[part] = parent.add_body(name=f"{name}/{part}", pos=pos, quat=turn, gravcomp=1.0)
        return bodies[part]

    base = child(spec.worldbody, "base", (0.0, 0.0, 0.0))
    slide, hinge = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
    base.add_joint(name=f"{name}/base_x", type=slide, axis=[1, 0, 0], armature=1.0)
    base.add_joint(name=f"{name}/base_y", type=slide, axis=[0, 1, 0], armature=1.0)
    base.add_joint(name=f"{name}/base_yaw", type=hinge, axis=[0, 0, 1], armature=1.0)
    _collider(base, _BOX, panda.BASE_MASS, pos=[-0.135, 0.0, 0.195], size=[0.285, 0.24, 0.165], **BUMPER)
    _collider(base, _BOX, 0.0, pos=[-0.135, 0.0, 0.0175], size=[0.285, 0.24, 0.0125], name=f"{name}/{SKIRT}", **BUMPER)
    _collider(base, _CYLINDER, 5.0, pos=[0.0, 0.0, 0.48], size=[0.10, 0.13, 0.0])

    lift = child(base, "lift", (0.0, 0.0, mount_height))
    lift.add_joint(name=f"{name}/torso", type=slide, axis=[0, 0, 1], range=list(panda.TORSO_RANGE), limited=True,
                   armature=1.0, damping=[10.0, 0.0, 0.0])
    _collider(lift, _CYLINDER, panda.TORSO_MASS, pos=[0.0, 0.0, -0.16], size=[0.085, 0.14, 0.0])

    parent = child(lift, "link0", (0.0, 0.0, 0.0))
    _add_capsule(parent, panda.LINK0)
    for index, link in enumerate(panda.LINKS):
        parent = child(parent, link.name, link.position, _turn(_X_AXIS, link.turn_x))
        limits = [float(panda.ARM_LOWER[index]), float(panda.ARM_UPPER[index])]
        force = panda.ARM_FORCE[index]
        # What carries the arm's own weight counts: the limit is on all that the motor gives.
        parent.add_joint(name=f"{name}/joint{index + 1}", type=hinge, axis=[0, 0, 1], range=limits, limited=True,
                         armature=0.1, damping=[1.0, 0.0, 0.0], actgravcomp=True, actfrclimited=True,
                         actfrcrange=[-force, force])
        _add_capsule(parent, link)
    _add_hand(name, parent, child)
    return bodies


def _add_capsule(body: mujoco.MjsBody, link: panda.Link) -> None:
    *ends, radius = link.capsule
    _collider(body, _CAPSULE, link.mass, fromto=list(ends), size=[radius, 0.0, 0.0])


def _add_hand(name: str, link7: mujoco.MjsBody, child: object) -> None:
    """Hand box, two fingers on slides, and their pads; the fingers move along the hand's y."""
    hand = child(link7, "hand", (0.0, 0.0, panda.FLANGE), _turn((0.0, 0.0, 1.0), panda.HAND_TURN))  # type: ignore[operator]
    _collider(hand, _BOX, panda.HAND_MASS, pos=[0.0, 0.0, 0.03], size=[0.032, 0.102, 0.035])
    hand.add_site(name=f"{name}/grip", pos=[0.0, 0.0, panda.GRIP_DEPTH], size=[0.005] * 3, group=5,
                  quat=list(_turn((0.0, 0.0, 1.0), panda.GRIP_TURN - panda.HAND_TURN)))
    for part, side in zip(panda.FINGERS, (1.0, -1.0), strict=True):
        finger = child(hand, part, (0.0, 0.0, 0.0524))  # type: ignore[operator]
        finger.add_joint(name=f"{name}/{part}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, side, 0],
                         range=[0.0, panda.FINGER_OPEN], limited=True, armature=FINGER_INERTIA,
                         damping=[10.0, 0.0, 0.0])
        _collider(finger, _BOX, 0.5 * panda.FINGER_MASS, pos=[0.0, side * 0.013, 0.018], size=[0.010, 0.0065, 0.016])
        _collider(finger, _BOX, 0.5 * panda.FINGER_MASS, pos=[0.0, side * 0.005, 0.043],
                  size=[0.0095, 0.005, 0.018], **PAD)


def _add_servos(spec: mujoco.MjSpec, name: str) -> None:
    """Position servos; those of base and arm integrate their control, so that a setpoint moves inside mj_step."""
    base = panda.BASE_FORCE
    gains = [(2e5, 1.6e4, base), (2e5, 1.6e4, base), (4e4, 3.2e3, base), (3e4, 3e3, 1500.0)]
    gains += list(zip(panda.ARM_STIFFNESS, panda.ARM_DAMPING, panda.ARM_FORCE, strict=True))
    for part, (stiffness, damping, force) in zip(panda.JOINTS, gains, strict=True):
        servo = _servo(spec, f"{name}/{part}", stiffness, damping, force)
        servo.dyntype = mujoco.mjtDyn.mjDYN_INTEGRATOR
    for part in panda.FINGERS:
        _servo(spec, f"{name}/{part}", panda.FINGER_STIFFNESS, 80.0, panda.FINGER_FORCE)
    coupling = np.zeros(11)
    coupling[1] = 1.0
    spec.add_equality(
        type=mujoco.mjtEq.mjEQ_JOINT, name=f"{name}/fingers", objtype=mujoco.mjtObj.mjOBJ_JOINT, data=coupling,
        name1=f"{name}/{panda.FINGERS[0]}", name2=f"{name}/{panda.FINGERS[1]}", solref=[0.01, 1.0],
    )


def _servo(spec: mujoco.MjSpec, joint: str, stiffness: float, damping: float, force: float) -> mujoco.MjsActuator:
    servo = spec.add_actuator(name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    servo.gaintype = mujoco.mjtGain.mjGAIN_FIXED
    servo.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    gain, bias = np.zeros(10), np.zeros(10)
    gain[0], bias[1], bias[2] = stiffness, -stiffness, -damping
    servo.gainprm, servo.biasprm = gain, bias
    servo.forcelimited = True
    servo.forcerange = [-force, force]
    return servo


def _turn(axis: tuple[float, float, float], angle: float) -> np.ndarray:
    quat = np.zeros(4)
    mujoco.mju_axisAngle2Quat(quat, np.array(axis), angle)
    return quat
