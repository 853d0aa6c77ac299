"""Poses as seen: with noise everything but the robot is misjudged, height and turn included; without it nothing is."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
from physics_kit import ROBOT, kitchen, run

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.perception import Error, HeldError, Perception
from remac_env.robots.rotation import Array, about_z, rotation_vector

NOISE = 0.02
THINGS = {"bowl": "counter", "mug": "counter"}


def looking(noise: float, *, seed: int = 120500) -> tuple[PhysicsBackend, Workspace]:
    """A robot that has looked around once: a round has begun."""
    backend, _, worlds = kitchen(THINGS, seed, noise=noise)
    run(backend, worlds, ["wait"])
    return backend, backend._begun()._team.robots[ROBOT]


def spread(values: list[Array]) -> Array:
    return np.std(np.array(values), axis=0)


@pytest.fixture(scope="module")
def looks() -> list[tuple[PhysicsBackend, Workspace]]:
    return [looking(NOISE, seed=120500 + k) for k in range(12)]


def test_things_are_seen_off_in_height_and_turn_too(looks: list[tuple[PhysicsBackend, Workspace]]) -> None:
    shifts, turns = [], []
    for backend, here in looks:
        for name in THINGS:
            seen, truth = here.sensed.in_room(name), backend._begun().simulation.pose(name)
            shifts.append(seen.position - truth.position)
            turns.append(rotation_vector(seen.rotation @ truth.rotation.T))
    assert (spread(shifts) > 0.5 * NOISE).all() and (spread(shifts) < 2.0 * NOISE).all(), spread(shifts)
    assert spread(turns)[2] > 0.5 * NOISE / 0.15
    assert np.abs(np.array(turns)[:, :2]).max() < 1e-9, "about the vertical"


def test_slots_are_where_their_fixture_is_seen(looks: list[tuple[PhysicsBackend, Workspace]]) -> None:
    off = []
    for _, here in looks:
        for name, slot in here.kitchen.layout.slots.items():
            seen = here.sensed.located(slot.fixture, np.array(slot.center))
            off.append(seen - np.array(slot.center))
            assert np.abs(off[-1]).max() > 1e-6, name
    assert (spread(off) > 0.5 * NOISE).all()


def test_paths_are_checked_in_the_world_as_seen(looks: list[tuple[PhysicsBackend, Workspace]]) -> None:
    for backend, here in looks[:3]:
        here.begin()
        truth = mujoco.MjData(here.sensed.model)
        truth.qpos[:] = backend.data.qpos
        mujoco.mj_kinematics(here.sensed.model, truth)
        mujoco.mj_kinematics(here.clear.checker.model, here.clear.checker.data)
        moved = here.clear.checker.data.xpos - truth.xpos
        for body in range(1, here.sensed.model.nbody):
            name = here.sensed.model.body(body).name
            if name.startswith((f"{ROBOT}/", "room/", "wall/")) or name == f"{ROBOT}/base":
                assert np.abs(moved[body]).max() < 1e-12, name
            else:
                assert np.abs(moved[body]).max() > 1e-5, name
        for name in THINGS:
            body = here.sensed.model.body(name).id
            np.testing.assert_allclose(here.clear.checker.data.xpos[body], here.sensed.in_room(name).position)


def test_a_handle_is_seen_where_the_checked_world_has_it(looks: list[tuple[PhysicsBackend, Workspace]]) -> None:
    for _, here in looks[:3]:
        here.begin()
        mujoco.mj_kinematics(here.clear.checker.model, here.clear.checker.data)
        model = here.sensed.model
        site = model.site("microwave/button").id
        face = np.array(model.body("microwave/button").pos) + np.array(model.site("microwave/button").pos)
        seen = here.sensed.located("microwave/button", face)
        x, y = here.kitchen.layout.frame("microwave").point(float(seen[0]), float(seen[1]))
        drawn = here.clear.checker.data.xpos[model.site_bodyid[site]]
        drawn = drawn + here.clear.checker.data.xmat[model.site_bodyid[site]].reshape(3, 3) @ model.site_pos[site]
        np.testing.assert_allclose(drawn, [x, y, seen[2]], atol=1e-9)


def test_a_thing_in_the_hand_is_misjudged_as_a_whole() -> None:
    seen = Perception()
    seen.objects["mug"] = Error(np.array([0.01, 0.0, 0.02]), 0.3, np.zeros(3))
    turned, at = about_z(0.7), np.array([1.0, 2.0, 3.0])
    before = seen.seen("mug", at, turned)
    seen.hold("mug", turned)
    held = seen.objects["mug"]
    assert isinstance(held, HeldError)
    for one, other in zip(seen.seen("mug", at, turned), before, strict=True):
        np.testing.assert_allclose(one, other)
    # Wherever the hand turns it, what is seen stays in the same place of the object.
    turn = about_z(1.1) @ np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    position, rotation = seen.seen("mug", np.zeros(3), turn @ turned)
    np.testing.assert_allclose(position, turn @ (before[0] - at), atol=1e-12)
    np.testing.assert_allclose(rotation, turn @ before[1], atol=1e-12)


def test_each_round_looks_anew_and_each_episode_alike() -> None:
    backend, here = looking(NOISE)
    first = here.sensed.in_room("mug").position
    other_backend, other = looking(NOISE)
    np.testing.assert_array_equal(first, other.sensed.in_room("mug").position)
    _, _, worlds = kitchen(THINGS, 120500, noise=NOISE)
    run(backend, worlds, ["wait"])
    assert np.abs(here.sensed.in_room("mug").position - first).max() > 1e-4
    assert other_backend.world == backend.world


def test_without_noise_nothing_is_off() -> None:
    backend, here = looking(0.0)
    assert not here.sensed.senses.perception.objects and not here.sensed.senses.perception.fixtures
    np.testing.assert_array_equal(here.clear.checker.model.body_pos, here.sensed.model.body_pos)
    np.testing.assert_array_equal(here.clear.checker.model.body_quat, here.sensed.model.body_quat)
    assert here.sensed.turned("microwave/door") == 0.0
    point = np.array([1.0, math.pi, 3.0])
    np.testing.assert_array_equal(here.sensed.located("microwave/door", point), point)


def test_no_noise_is_bit_for_bit_no_perception(monkeypatch: pytest.MonkeyPatch) -> None:
    texts = ["navigate to mug", "pick up mug", "navigate to counter"]

    def end() -> Array:
        backend, _, worlds = kitchen(THINGS, 120501)
        assert run(backend, worlds, texts) == [None] * 3
        return np.concatenate([backend.data.qpos, backend.data.qvel])

    with_perception = end()
    monkeypatch.setattr(Perception, "seen", lambda self, name, position, rotation: (position, rotation))
    monkeypatch.setattr(Perception, "hold", lambda self, name, rotation: None)
    np.testing.assert_array_equal(with_perception, end())
