"""Three and four Pandas in physics: they stand, drive and act at the same time, and never touch one another."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

import pytest

import remac_env
from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.testing.play import play, random_legal

LONG_ROUNDS = 10
KITCHENS = ("galley", "g_shaped_small", "l_shaped_small", "one_wall_small", "u_shaped_small")


def make(robots: int, layout: str, task: str = "WashPnPHeat") -> KitchenParallelEnv:
    return remac_env.parallel_env(task, robots=robots, layout=layout, starts="mixed", max_rounds=100)


def random_rounds(robots: int, layout: str, *, seed: int, rounds: int) -> Counter[str]:
    """How subtasks ended; under "rounds" those played, and under "contacts" periods in which robots touched."""
    env, tally = make(robots, layout), Counter[str]()
    for turn in play(env, seed, random_legal(seed, env.vocabulary), rounds=rounds):
        tally["rounds"] += bool(turn.number)
        for name, token in turn.tokens.items():
            reason = turn.infos[name]["outcome"]["reason"]
            drive = "drive " if env.vocabulary.subtask(token).moves else ""
            tally[f"{drive}{reason}" if reason in ("blocked", "timeout") else reason or "success"] += 1
    tally["contacts"] = env._backend.counters.robot_contacts  # type: ignore[union-attr]
    env.close()
    return tally


def step(env: KitchenParallelEnv, commands: Mapping[str, str]) -> dict[str, str]:
    """Robot -> why its command failed, "" where it did not."""
    infos = env.step({name: env.vocabulary.encode(text) for name, text in commands.items()})[-1]
    return {name: info["outcome"]["reason"] for name, info in infos.items()}


def test_three_robots_change_places_in_a_ring_and_go_out_of_the_way_together() -> None:
    env = make(3, "u_shaped_small")
    env.reset(seed=3)
    places = ["sink", "stove", "cabinet"]
    for shift in (0, 1):
        goes = {name: f"navigate to {places[(i + shift) % 3]}" for i, name in enumerate(env.possible_agents)}
        assert step(env, goes) == dict.fromkeys(goes, "")
    assert step(env, dict.fromkeys(env.possible_agents, "navigate aside")) == dict.fromkeys(env.possible_agents, "")
    backend = env._backend
    assert backend is not None and backend.counters.robot_contacts == 0
    env.close()


def test_four_robots_play_random_rounds_without_touching() -> None:
    tally = random_rounds(4, "galley", seed=5, rounds=2)
    assert tally["rounds"] == 2 and tally["contacts"] == 0 and tally["success"] > 2, tally


@pytest.mark.long
@pytest.mark.parametrize("layout", KITCHENS)
@pytest.mark.parametrize("robots", (3, 4))
def test_two_hundred_random_rounds_of_teams_are_played_without_touching(robots: int, layout: str) -> None:
    """With the other kitchens and the other size of team: 200 rounds."""
    total = Counter[str]()
    for seed in range(20):
        if total["rounds"] < 2 * LONG_ROUNDS:
            total += random_rounds(robots, layout, seed=seed, rounds=LONG_ROUNDS)
    assert total["rounds"] >= 2 * LONG_ROUNDS and total["contacts"] == 0, total
    assert total["drive blocked"] + total["drive timeout"] <= 0.02 * robots * total["rounds"], total
