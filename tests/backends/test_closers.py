"""Doors that fall shut in physics: by a force on the hinge, when it is time, unless something is in the way."""

from __future__ import annotations

import pickle
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from physics_kit import ROBOT, command, kitchen

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.closers import FALL
from remac_env.rules.processes import chosen
from remac_env.state import CLOSED_MAX

(FALLING,) = chosen([("falling_shut", ("cabinet",))])
KEY = (FALLING, "cabinet")
REACHING = (0.1, 0.0, 0.4, 0.0, -1.2, 0.0, 2.2, 0.79)
"""Lift (m) and arm (rad) of a robot whose hand is where the cabinet's door swings."""


def opened(angle: float = 1.45, *, arm: tuple[float, ...] = (), aside: float = 0.1) -> PhysicsBackend:
    """A kitchen with the cabinet's door open, and perhaps the robot before it, `aside` m right of its station."""
    backend, start, worlds = kitchen({"vegetable": "counter"}, 3)
    backend.data.joint("cabinet/door").qpos[0] = angle
    if arm:
        place = worlds.layout_of(start).stations["cabinet"]
        robot = backend._begun().simulation.robots[ROBOT]
        robot.put(np.array([place.x + aside, place.y, place.yaw, *arm]))
    mujoco.mj_forward(backend.model, backend.data)
    return backend


def angle(backend: PhysicsBackend) -> float:
    return float(backend.data.joint("cabinet/door").qpos[0])


@pytest.mark.parametrize("swung", [0.5, 1.45, 2.15])
def test_a_door_falls_shut_in_its_time(swung: float) -> None:
    backend = opened(swung)
    backend.go_on({KEY: 2.0})
    backend.advance(until=2.0 + FALLING.seconds - FALL)
    assert angle(backend) == pytest.approx(swung, abs=0.02), "until then it stays where it was left"
    fastest, moments = 0.0, []
    while backend.clock < 2.0 + FALLING.seconds:
        backend.advance(until=round(backend.clock + 0.05, 2))
        fastest = max(fastest, -float(backend.data.joint("cabinet/door").qvel[0]))
        moments.append(angle(backend))
    assert angle(backend) <= CLOSED_MAX and backend.world.fixtures["cabinet"].door == "closed"
    assert fastest < 1.1
    assert np.abs(np.diff([swung, *moments])).max() < 0.06, "it swings, and does not jump"


def test_a_door_that_nobody_spoke_of_stays_and_so_does_one_to_which_somebody_came_back() -> None:
    backend = opened()
    backend.advance(until=12.0)
    assert angle(backend) == pytest.approx(1.45, abs=0.02) and not backend.data.qfrc_applied.any()
    backend.go_on({KEY: 12.0 - FALLING.seconds + FALL})
    backend.advance(until=13.0)
    assert 0.2 < angle(backend) < 1.4
    backend.go_on({})
    backend.advance(until=13.5)
    there = angle(backend)
    backend.advance(until=16.0)
    assert angle(backend) == pytest.approx(there, abs=0.01) and not backend.data.qfrc_applied.any()


def test_whoever_stands_in_its_way_keeps_it_open() -> None:
    backend = opened(arm=REACHING)
    backend.go_on({KEY: 0.0})
    backend.advance(until=FALLING.seconds)
    assert angle(backend) > 0.8 and backend.world.fixtures["cabinet"].door != "closed"
    door, robot = backend.model.body("cabinet/door").id, []
    for pair in backend.model.geom_bodyid[backend.data.contact.geom[: backend.data.ncon]]:
        robot += [backend.model.body(int(other)).name for other in pair if door in pair and other != door]
    assert any(name.startswith(ROBOT) for name in robot), "by nothing but contact"


def test_a_copy_plays_it_again() -> None:
    backend = opened()
    backend.reset(backend._begun().start)  # what a copy plays again begins with the start
    backend.go_on({KEY: 0.0})
    backend.advance(until=1.0)
    twin = pickle.loads(pickle.dumps(backend))
    assert [call for call, _ in twin._played] == ["go_on", "advance"]
    assert np.array_equal(twin.data.qpos, backend.data.qpos) and twin._begun().closers.armed


def test_what_is_under_way_begins_nothing_before_it_has_ended() -> None:
    backend, _, worlds = kitchen({"vegetable": "counter"}, 3)
    start = backend._begun().start
    backend.reset(replace(start, scene=replace(start.scene, processes=(FALLING,))))
    backend.run_round({ROBOT: command(worlds, "navigate to faucet")})
    backend.begin({ROBOT: command(worlds, "turn on faucet")})
    while not backend.world.fixtures["faucet"].on:
        backend.advance(until=round(backend.clock + 0.5, 2))
        assert backend.busy
    assert not backend.settled.fixtures["faucet"].on
    backend.advance()
    assert backend.settled.fixtures["faucet"].on and backend.settled == backend.world
