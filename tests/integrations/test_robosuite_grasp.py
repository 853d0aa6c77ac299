"""Hands of robosuite lift our objects, by friction, and our snapshot says so."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from robosuite_kitchen import make

import remac_env
from remac_env.state import Place

pytest.importorskip("robosuite", reason="robosuite is not installed: docs/robosuite.md says how")

LIFTED = 0.2  # m
AHEAD = 0.6  # m before the arm's axis that objects are within reach of a hand that looks down
LAYOUT = "one_wall_large"
ROUND = ("beetroot", "onion", "tomato")  # which a hand takes that does not turn


def seed_with(categories: tuple[str, ...]) -> int:
    """The first seed whose food is of one of these categories."""
    there = remac_env.parallel_env("OpenCabinetPnP", robots=1, backend="symbolic", layout=LAYOUT)
    for seed in range(100):
        there.reset(seed=seed)
        if there.start.categories["vegetable"] in categories:
            return seed
    raise AssertionError("no such food in a hundred starts")


def put(env: Any, robot: str, x: float, y: float, yaw: float) -> None:
    """Set a robot's base down with the arm's axis at x, y (m): driving is not what is tested here."""
    index = env.episode.start.scene.robots.index(robot)
    parked = env._bodies.robots[robot].standing[2]
    moved = np.array([env._bodies.joint(f"mobilebase{index}_joint_mobile_{axis}") for axis in ("forward", "side")])
    parked -= env._bodies.joint(f"mobilebase{index}_joint_mobile_yaw")
    cos, sin = math.cos(parked), math.sin(parked)
    for _ in range(2):  # the base turns about a point behind the arm's axis
        now = env._bodies.robots[robot].standing
        moved += np.array([[cos, sin], [-sin, cos]]) @ [x - now[0], y - now[1]]
        for name, value in zip(("forward", "side", "yaw"), (*moved, yaw - parked), strict=True):
            env.sim.data.set_joint_qpos(f"mobilebase{index}_joint_mobile_{name}", value)
        env.sim.forward()
    env.robots[index].composite_controller.reset()


class Hand:
    """Moves one robot's hand with operational space control; the other robot stands still."""

    def __init__(self, env: Any, robot: str) -> None:
        self._env, self._index = env, env.episode.start.scene.robots.index(robot)

    def go(self, target: Any, steps: int, grip: float) -> None:
        for _ in range(steps):
            env = self._env
            position = env.sim.data.site_xpos[env.sim.model.site_name2id(f"gripper{self._index}_right_grip_site")]
            turn = env.sim.data.body_xmat[env.sim.model.body_name2id(f"mobilebase{self._index}_base")].reshape(3, 3)
            step = np.clip(turn.T @ (target - position) / 0.05, -1.0, 1.0)
            parts = []
            for index, robot in enumerate(env.robots):
                mine = index == self._index
                parts.append(robot.create_action_vector({
                    "right": np.array([*(step if mine else np.zeros(3)), 0.0, 0.0, 0.0]),
                    "right_gripper": np.array([grip if mine else -1.0]),
                    "base": np.zeros(3),
                    "torso": np.zeros(1),
                }))  # fmt: skip
            env.step(np.concatenate(parts))


@pytest.mark.parametrize("step", [0.002, 0.005])
def test_a_hand_lifts_a_thing(step: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """With robosuite's own step of the simulation (s), and with ours."""
    import robosuite.macros

    monkeypatch.setattr(robosuite.macros, "SIMULATION_TIMESTEP", step)
    env = make("OpenCabinetPnP", robots=1, layout=LAYOUT, seed=seed_with(ROUND))
    env.reset()
    obj, robot, layout = env.episode.roles["food"], "robot_0", env.episode.layout
    slot = layout.slots[env.world.objects[obj].place.where]
    station, at, hand = layout.stations[slot.station], env._bodies.pose(obj).position, Hand(env, robot)
    put(env, robot, station.x, station.y, station.yaw)
    assert env.world.robots[robot].station == slot.station
    put(env, robot, at[0] - AHEAD * math.cos(station.yaw), at[1] - AHEAD * math.sin(station.yaw), station.yaw)
    hand.go(at + [0.0, 0.0, 0.15], 80, -1.0)
    hand.go(at, 50, -1.0)
    assert env.world.robots[robot].holding is None, "the hand is about it, but open"
    hand.go(at, 20, 1.0)
    hand.go(at + [0.0, 0.0, LIFTED], 50, 1.0)
    assert env.world.robots[robot].holding == obj
    assert env.world.objects[obj].place == Place("held", robot)
    assert env._bodies.pose(obj).position[2] - at[2] == pytest.approx(LIFTED, abs=0.02)
    hand.go(at + [0.0, 0.0, 0.01], 50, 1.0)
    hand.go(at + [0.0, 0.0, 0.01], 20, -1.0)
    assert env.world.robots[robot].holding is None
    assert env.world.objects[obj].place == Place("slot", slot.name)
    env.close()
