"""Bowls in cabinets: in between the leaves of a door, out again, and what no hand reaches in them."""

from __future__ import annotations

import remac_env
from remac_env.parallel import KitchenParallelEnv

INTO_CABINET = ("navigate to cabinet", "open cabinet door", "navigate to bowl", "pick up bowl", "navigate to cabinet")

NARROW = 93039
"""Seed of a kitchen whose cabinet has two leaves, with a bowl that is grasped in the sink."""


def told(env: KitchenParallelEnv, *commands: str) -> list[str | None]:
    """Reasons of the outcomes of one robot's commands, None for successes."""
    reasons = []
    for command in commands:
        _, _, _, _, infos = env.step({"robot_0": env.vocabulary.encode(command)})
        reasons.append(infos["robot_0"]["outcome"]["reason"])
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
