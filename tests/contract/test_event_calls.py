"""Very many random calls by the event clock: nothing raises, and time goes on."""

from __future__ import annotations

import os

import numpy as np
import pytest

import remac_env

CALLS = int(os.environ.get("REMAC_EVENT_CALLS", "100000"))
"""Steps in all."""


@pytest.mark.long
def test_random_calls_have_no_fault() -> None:
    """Every task by turns, with legal tokens, any tokens and stops; thinking costs what is drawn."""
    chance, left, seed = np.random.default_rng(11), CALLS, 0
    tasks = remac_env.tasks("events")
    while left > 0:
        task, robots = tasks[seed % len(tasks)], 1 + seed % 3
        env = remac_env.parallel_env(
            task, robots=robots, backend="symbolic", clock="events", interrupts=seed % 2 == 0, think="tokens:5",
            starts=("paper", "mixed")[seed // 2 % 2], failure_rate=0.1 * (seed % 3), max_seconds=600.0,
        )  # fmt: skip
        env.reset(seed=seed)
        before = -1.0
        while env.agents and left > 0:
            tokens = {}
            for robot in env.agents:
                mask = env.action_mask(robot)
                assert mask.any()
                anything = chance.random() < 0.1
                tokens[robot] = int(chance.integers(len(mask)) if anything else chance.choice(np.flatnonzero(mask)))
                if tokens[robot] == env.vocabulary.encode("done"):
                    tokens[robot] = env.vocabulary.encode("wait")
            _, rewards, _, _, infos = env.step(tokens)
            now = next(iter(infos.values()))["seconds"]
            assert now > before and all(np.isfinite(reward) for reward in rewards.values())
            before, left = now, left - 1
        env.close()
        seed += 1
    assert seed >= min(3, CALLS // 1000)
