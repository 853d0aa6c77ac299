"""Into and out of cabinets and microwaves: how objects are held there, bowls, and what no hand reaches in them."""

from __future__ import annotations

from dataclasses import replace

import pytest
from test_physics_backend import make_start, run

import remac_env
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.start import Offset
from remac_env.state import Place

INTO_CABINET = ("navigate to cabinet", "open cabinet door", "navigate to bowl", "pick up bowl", "navigate to cabinet")

NARROW = 93039
"""Seed of a kitchen whose cabinet has two door panels, with a bowl that is grasped in the sink."""


def told(env: KitchenParallelEnv, *commands: str) -> list[str | None]:
    """Reasons of the outcomes of one robot's commands, None for successes."""
    reasons = []
    for command in commands:
        _, _, _, _, infos = env.step({"robot_0": env.vocabulary.encode(command)})
        reasons.append(infos["robot_0"]["outcome"]["reason"] or None)
    return reasons


def test_a_bowl_goes_into_a_cabinet_and_no_hand_into_the_bowl() -> None:
    env = remac_env.parallel_env("DefrostInBowl", robots=1, starts="mixed")
    env.reset(seed=NARROW)
    assert told(env, *INTO_CABINET, "place to cabinet") == [None] * 6
    assert told(env, "navigate to meat", "pick up meat", "navigate to bowl") == [None] * 3
    before = env.world
    assert told(env, "place to bowl") == ["blocked"]
    assert env.world == before
    assert told(env, "navigate to counter", "place to counter", "navigate to bowl", "pick up bowl") == [None] * 4


@pytest.mark.parametrize("turn", [-1.9, 1.9])
def test_what_lies_aslant_in_a_microwave_is_held_square(turn: float) -> None:
    start = make_start({"butter": ("butter", Place("slot", "microwave.0"))}, doors={"microwave": 1.45})
    side = 0.048 if turn > 0.0 else -0.048
    backend = PhysicsBackend()
    backend.reset(replace(start, offsets={"butter": Offset(side, -0.098, turn)}))
    commands = ("navigate to", "microwave"), ("pick up", "butter"), ("navigate to", "counter"), ("place to", "counter")
    assert run(backend, *commands) == [None] * 4
