"""A floating two-finger hand for tests: grasps one object on a table as the catalogue says, lifts and shakes it."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from remac_env.kitchen.objects import add_object
from remac_env.kitchen.objects.catalogue import Category, Grasp
from remac_env.robots.panda.model import FINGER_INERTIA, PAD

LIFT = 0.20  # m
_APPROACH = 0.12  # m
_FORCE = 70.0  # N a finger, as the robot does


@dataclass(frozen=True)
class Trial:
    """rest: position (3,) m after falling still. speed: its largest velocity then. risen: how high it hangs, m."""

    rest: np.ndarray
    speed: float
    risen: float


def grasp_and_shake(category: Category, *, grasp: Grasp | None = None) -> Trial:
    """Let the object come to rest, grasp it, lift it by LIFT and shake it; all in about 5 s of simulated time."""
    grasp = grasp or category.grasp
    position, rotation = hand_pose(grasp, grasp.lean[0])
    approach = rotation[:, 2]
    model = _model(category, position + [0, 0, category.rest_height] - _APPROACH * approach, rotation)
    data = mujoco.MjData(model)
    opening = min(0.04, grasp.width / 2 + 0.012)
    data.ctrl[3:] = opening
    data.joint("left").qpos[0] = data.joint("right").qpos[0] = opening
    _run(model, data, 100)
    rest, speed = data.body("thing").xpos.copy(), float(np.abs(data.qvel[:6]).max())
    _run(model, data, 160, approach * _APPROACH)
    data.ctrl[3:] = 0
    _run(model, data, 80)
    for move, steps in (((0, 0, LIFT), 200), ((0.15, 0, 0), 60), ((0, 0.15, 0), 60), ((0, 0, 0), 150)):
        _run(model, data, steps, move)
    return Trial(rest, speed, float(data.body("thing").xpos[2] - rest[2]))


def hand_pose(grasp: Grasp, lean: float) -> tuple[np.ndarray, np.ndarray]:
    """Where the fingertips meet (3,) and the hand's axes (3, 3) in the object's frame: x opening, z approach."""
    down = np.array([0.0, 0.0, -1.0])
    if grasp.mode == "side":
        at, fingers = np.array([0.0, 0.0, grasp.height]), np.array([0.0, 1.0, 0.0])
        approach = np.array([np.sin(lean), 0.0, 0.0]) + np.cos(lean) * down
    elif grasp.mode == "rim":
        out = np.array([1.0, 0.0, 0.0])
        at, approach = out * grasp.reach[0] + [0, 0, grasp.height], -np.sin(lean) * out + np.cos(lean) * down
        fingers = np.cos(lean) * out + np.sin(lean) * down
    else:
        along = np.array([0.0, -1.0, 0.0])
        at, fingers = along * grasp.reach[0] + [0, 0, grasp.height], np.array([1.0, 0.0, 0.0])
        approach = -np.sin(lean) * along + np.cos(lean) * down
    return at, np.stack([fingers, np.cross(approach, fingers), approach], axis=1)


def _model(category: Category, position: np.ndarray, rotation: np.ndarray) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    option = spec.option
    option.timestep, option.impratio, option.ls_iterations = 0.005, 10, 50
    option.integrator, option.cone = mujoco.mjtIntegrator.mjINT_IMPLICITFAST, mujoco.mjtCone.mjCONE_ELLIPTIC
    box = mujoco.mjtGeom.mjGEOM_BOX
    spec.worldbody.add_geom(type=box, size=[1, 1, 0.1], pos=[0, 0, -0.1], contype=1, conaffinity=0)
    add_object(spec, spec.worldbody, "thing", category, visual=False)
    turn = np.zeros(4)
    mujoco.mju_mat2Quat(turn, rotation.ravel())
    hand = spec.worldbody.add_body(name="hand", pos=position, quat=turn, gravcomp=1)
    slide = mujoco.mjtJoint.mjJNT_SLIDE
    for name, axis in zip("xyz", np.eye(3), strict=True):
        hand.add_joint(name=name, type=slide, axis=rotation.T @ axis)
        _servo(spec, name, 2e4, 1e3, 500.0)
    hand.add_geom(type=box, size=[0.01] * 3, pos=[0, 0, -0.2], mass=1, contype=0, conaffinity=0)
    for name, side in (("left", 1), ("right", -1)):
        finger = hand.add_body(name=name, gravcomp=1)
        finger.add_joint(
            name=name, type=slide, axis=[side, 0, 0], range=[0, 0.04], limited=True, armature=FINGER_INERTIA
        )
        finger.add_geom(
            type=box, size=[0.005, 0.0095, 0.018], pos=[side * 0.005, 0, -0.003], mass=0.05, contype=4, conaffinity=7,
            **PAD,
        )  # fmt: skip
        _servo(spec, name, 4000, 80, _FORCE)
    return spec.compile()


def _servo(spec: mujoco.MjSpec, joint: str, stiffness: float, damping: float, force: float) -> None:
    spec.add_actuator(
        name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT, forcelimited=True, forcerange=[-force, force],
        gaintype=mujoco.mjtGain.mjGAIN_FIXED, biastype=mujoco.mjtBias.mjBIAS_AFFINE,
        gainprm=[stiffness] + [0] * 9, biasprm=[0, -stiffness, -damping] + [0] * 7,
    )  # fmt: skip


def _run(model: mujoco.MjModel, data: mujoco.MjData, steps: int, move=(0.0, 0.0, 0.0)) -> None:
    start = data.ctrl[:3].copy()
    for step in range(steps):
        data.ctrl[:3] = start + np.asarray(move) * min(1.0, (step + 1) / (0.8 * steps))
        mujoco.mj_step(model, data)
