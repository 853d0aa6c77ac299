"""Kinematics of the robot against MuJoCo, and the closed form against itself."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from remac_env.robots import bodies
from remac_env.robots.panda import measures as panda
from remac_env.robots.panda.ik import solutions
from remac_env.robots.panda.model import add_robot
from remac_env.robots.rotation import about_x, about_z, from_rotation_vector, quaternion, rotation_vector


def random_configuration(rng: np.random.Generator) -> np.ndarray:
    base = np.concatenate([rng.uniform(-1, 1, 2), rng.uniform(-3, 3, 1), rng.uniform(0, 0.34, 1)])
    return np.concatenate([base, rng.uniform(panda.LOWER[4:], panda.UPPER[4:])])


def test_closed_form_recovers_random_configurations() -> None:
    rng = np.random.default_rng(0)
    kinematics = bodies.get().kinematics()
    worst = 0.0
    for _ in range(1000):
        q = random_configuration(rng)
        position, rotation = kinematics.forward(q)
        found = solutions(position, rotation, q[:3], torsos=q[3:4], wrist_turns=q[10:])
        assert np.abs(found - q).max(axis=1).min() < 1e-5
        for other in found:
            p, r = kinematics.forward(other)
            worst = max(worst, np.abs(p - position).max(), np.abs(r - rotation).max())
    assert worst < 1e-7


def test_every_solution_of_the_grid_reaches_the_pose() -> None:
    kinematics = bodies.get().kinematics()
    q = np.concatenate([[0.3, -0.4, 1.2, 0.1], panda.HOME_ARM])
    position, rotation = kinematics.forward(q)
    found = solutions(position, rotation, q[:3])
    assert len(found) > 20
    for other in found:
        p, r = kinematics.forward(other)
        np.testing.assert_allclose(p, position, atol=1e-8)
        np.testing.assert_allclose(r, rotation, atol=1e-8)
        assert (other >= panda.LOWER).all() and (other <= panda.UPPER).all()


def test_forward_agrees_with_two_robots_in_one_model() -> None:
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    for name in ("robot_0", "robot_1"):
        add_robot(spec, name)
    model = spec.compile()
    data = mujoco.MjData(model)
    rng = np.random.default_rng(1)
    kinematics = bodies.get().kinematics()
    for name in ("robot_0", "robot_1"):
        q = random_configuration(rng)
        for part, value in zip(panda.JOINTS, q, strict=True):
            data.joint(f"{name}/{part}").qpos[0] = value
        mujoco.mj_kinematics(model, data)
        position, rotation = kinematics.forward(q)
        np.testing.assert_allclose(data.site(f"{name}/grip").xpos, position, atol=1e-12)
        np.testing.assert_allclose(data.site(f"{name}/grip").xmat.reshape(3, 3), rotation, atol=1e-12)


def test_jacobian_equals_finite_differences() -> None:
    rng = np.random.default_rng(2)
    kinematics = bodies.get().kinematics()
    q = random_configuration(rng)
    jacobian = kinematics.jacobian(q)
    position, rotation = kinematics.forward(q)
    for joint in range(11):
        moved = q.copy()
        moved[joint] += 1e-6
        p, r = kinematics.forward(moved)
        np.testing.assert_allclose((p - position) / 1e-6, jacobian[:3, joint], atol=1e-4)
        np.testing.assert_allclose(rotation_vector(r @ rotation.T) / 1e-6, jacobian[3:, joint], atol=1e-4)


def test_tracking_reaches_a_near_pose() -> None:
    kinematics = bodies.get().kinematics()
    q = np.concatenate([[0.0, 0.0, 0.0, 0.1], panda.HOME_ARM])
    position, rotation = kinematics.forward(q)
    target = position + [0.02, -0.01, 0.02]
    turned = about_z(0.1) @ rotation
    tracked = kinematics.track(q, target, turned, iterations=12, largest=np.ones(11))
    p, r = kinematics.forward(tracked.q)
    assert np.linalg.norm(p - target) < 1e-3
    assert np.linalg.norm(rotation_vector(turned @ r.T)) < 5e-3
    np.testing.assert_array_equal(tracked.q[:3], q[:3])


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.9, -2.8])
def test_rotation_vector_and_quaternion(angle: float) -> None:
    vector = np.array([0.2, -0.5, 0.7])
    vector *= angle / np.linalg.norm(vector)
    rotation = from_rotation_vector(vector)
    np.testing.assert_allclose(rotation_vector(rotation), vector, atol=1e-9)
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, (about_x(0.2) @ rotation).ravel())
    np.testing.assert_allclose(np.abs(quat @ quaternion(about_x(0.2) @ rotation)), 1.0, atol=1e-12)


def test_servos_hold_a_tucked_robot_against_gravity() -> None:
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.timestep = 0.005
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    add_robot(spec, "robot_0", visual=True)
    model = spec.compile()
    data = mujoco.MjData(model)
    q = panda.tucked(0.2, -0.3, 1.0)
    data.qpos[:11] = q
    data.act[:] = q
    for _ in range(200):
        mujoco.mj_step(model, data)
    np.testing.assert_allclose(data.qpos[:11], q, atol=2e-3)
    assert data.ncon == 0
