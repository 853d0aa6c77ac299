"""A task registered from outside - a shut pantry in which bread needs a tray - shows the same staircase."""

from __future__ import annotations

import pytest
from outside_task import STORE_BREAD

import remac_agents
import remac_env
from remac_env.oracle import solve


def reports(
    method: str, seed: int, *, robots: int, iterations: int, **options: object
) -> list[remac_agents.EpisodeReport]:
    """Play the iterations of one job."""
    remac_env.register_task(STORE_BREAD)
    env = remac_env.parallel_env("StoreBread", robots=robots, backend="symbolic", max_rounds=60)
    agent = remac_agents.make(method, **options)
    found = []
    for _ in range(iterations):
        observations, infos = env.reset(seed=seed)
        agent.reset(observations, infos)
        while env.agents:
            observations, _, _, _, infos = env.step(agent.act(observations, infos))
        agent.close_episode(observations, infos)
        found.append(agent.report())
    return found


def optimum(seed: int, robots: int) -> int:
    """The shortest plan's rounds."""
    remac_env.register_task(STORE_BREAD)
    env = remac_env.parallel_env("StoreBread", robots=robots, backend="symbolic")
    env.reset(seed=seed)
    plan = solve(env.start.scene, env.world, env.goal)
    if plan is None:
        raise AssertionError("the task cannot be solved")
    return plan.length


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_staircase(seed: int) -> None:
    alone, team = optimum(seed, 1), optimum(seed, 2)
    assert not reports("BASE", seed, robots=1, iterations=1)[-1].success
    checked = reports("CC", seed, robots=1, iterations=1)[-1]
    assert checked.success and checked.final_plan_length > alone
    learned = reports("RE", seed, robots=1, iterations=3)[-1]
    assert learned.success and learned.initial_plan_length == alone and not learned.adjusted
    together = reports("REMAC", seed, robots=2, iterations=4)[-1]
    assert together.success and team <= together.initial_plan_length < alone
    searched = reports("REMAC", seed, robots=2, iterations=4, handover="search")[-1]
    assert searched.success and searched.initial_plan_length == team
