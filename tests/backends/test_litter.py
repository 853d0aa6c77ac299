"""A robot gets away from what lies on the floor, around it or through it, and presses nothing into the floor."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
from physics_kit import ROBOT, command, kitchen

from remac_env.backends.physics import multi_robot
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.scripted.motion import StuckError

THINGS = {"steak": "counter", "plate": "counter", "salmon": "counter", "chocolate": "counter"}  # all below 30 mm
Place = tuple[float, float]

RING = {"steak": (0.22, 0.0), "plate": (-0.56, 0.0), "salmon": (-0.135, 0.32), "chocolate": (-0.135, -0.32)}
"""On all four sides of a base, nearer to one another than it is wide: something has to be pushed."""

_BASE, _HALF = np.array([-0.135, 0.0]), np.array([0.285, 0.24])  # m, middle and half of a base, from its arm's axis


def lay(backend: PhysicsBackend, name: str, spot: Place, height: float = 0.002) -> None:
    """Put an object on the floor, upright, at a spot (m) in the frame of the robot's base."""
    x, y, yaw = (float(backend.data.joint(f"{ROBOT}/base_{part}").qpos[0]) for part in ("x", "y", "yaw"))
    c, s = math.cos(yaw), math.sin(yaw)
    address = int(backend.model.joint(name).qposadr[0])
    pose = [x + c * spot[0] - s * spot[1], y + s * spot[0] + c * spot[1], height, 1.0, 0.0, 0.0, 0.0]
    backend.data.qpos[address : address + 7] = pose
    mujoco.mj_forward(backend.model, backend.data)


class Immovable:
    """A bumper for which objects are too heavy, all of them; ``stops``: where they stopped the base, x and y (m)."""

    def __init__(self, backend: PhysicsBackend, stops: list[Place]) -> None:
        self._backend, self._stops = backend, stops

    def check(self) -> None:
        model, data = self._backend.model, self._backend.data
        base, things = model.body(f"{ROBOT}/base").id, {model.body(name).id for name in THINGS}
        touching = (set(pair) for pair in model.geom_bodyid[data.contact.geom[: data.ncon]].tolist())
        if any(base in pair and pair & things for pair in touching):
            self._stops.append(place(self._backend))
            raise StuckError("nothing moves")


def place(backend: PhysicsBackend) -> Place:
    """Where the base is, x and y (m)."""
    x, y = (float(backend.data.joint(f"{ROBOT}/base_{part}").qpos[0]) for part in ("x", "y"))
    return x, y


class Deepest:
    """How deep any shape of the objects has been in the floor (m), and which were under the base, in steps of 5 ms."""

    def __init__(self, backend: PhysicsBackend) -> None:
        self._model, self._data, self.depth = backend.model, backend.data, 0.0
        self.under: set[str] = set()
        bodies = [self._model.body(name).id for name in THINGS]
        self._geoms = np.flatnonzero(np.isin(self._model.geom_bodyid, bodies)).tolist()
        (self._floor,) = np.flatnonzero(self._model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE).tolist()

    def __call__(self) -> None:
        gaps = (mujoco.mj_geomDistance(self._model, self._data, g, self._floor, 1.0, None) for g in self._geoms)
        self.depth = max(self.depth, -min(gaps))
        base = self._data.body(f"{ROBOT}/base")
        for name in THINGS:
            away = (base.xmat.reshape(3, 3).T @ (self._data.body(name).xpos - base.xpos))[:2]
            if np.all(np.abs(away - _BASE) < _HALF):
                self.under.add(name)


def test_out_of_a_ring_around_litter_and_nothing_is_pressed_into_the_floor(monkeypatch: pytest.MonkeyPatch) -> None:
    backend, _, worlds = kitchen(THINGS, 7)

    def drive(text: str) -> str | None:
        return backend.run_round({ROBOT: command(worlds, text)}).outcomes[ROBOT].reason

    assert drive("navigate to sink") is None
    for name, spot in RING.items():
        lay(backend, name, spot, 0.016)
    assert drive("wait") is None
    backend.probe = deepest = Deepest(backend)
    assert [drive(text) for text in ("navigate aside", "navigate to stove", "navigate aside")] == [None] * 3
    assert deepest.depth < 0.005
    assert not deepest.under

    # One object on the straight way, in the open: the robot goes around it, and it stays where it is.
    lay(backend, "steak", (0.8, 0.0), 0.014)
    lay(backend, "plate", (0.8, 0.3))
    before = backend.data.joint("steak").qpos[:2].copy()
    assert drive("navigate to sink") is None
    assert np.linalg.norm(backend.data.joint("steak").qpos[:2] - before) < 0.001

    # What it cannot push stops it; it goes back, tries elsewhere, and gets away once objects give way.
    for name, spot in RING.items():
        lay(backend, name, spot, 0.016)
    stops: list[Place] = []
    with monkeypatch.context() as heavy:
        heavy.setattr(multi_robot, "Bumper", lambda here: Immovable(backend, stops))
        assert drive("navigate aside") == "blocked"
    assert stops and math.dist(place(backend), stops[-1]) > 0.02
    assert drive("navigate aside") is None
