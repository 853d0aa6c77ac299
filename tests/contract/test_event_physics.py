"""In physics, under the event clock and with processes, the same seed is the same episode, bit for bit."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import remac_env

COMMANDS = {
    "FallingDoor": ("navigate to cabinet; open cabinet door; navigate aside; wait; wait; wait", "wait"),
    "RinseAndStow": (
        "navigate to vegetable; pick up vegetable; navigate to sink; place to sink; turn on faucet"
        + 7 * "; wait",
        "navigate to microwave; open microwave door",
    ),
}


def played(env: Any, task: str, seed: int) -> str:
    """What an episode was: positions, observations and infos of all decision points, as a digest."""
    rows, digest = [text.split("; ") for text in COMMANDS[task]], hashlib.sha256()
    seen, infos = env.reset(seed=seed)
    left = dict(zip(env.possible_agents, rows, strict=True))
    while env.agents and any(left.values()):
        tokens = {}
        for robot in env.agents:
            command = (left[robot].pop(0) if left[robot] else "wait") if infos[robot]["ready"] else "continue"
            tokens[robot] = env.vocabulary.encode(command)
        seen, _, _, _, infos = env.step(tokens)
        digest.update(env._backend.positions().tobytes())
        for robot in env.agents:
            digest.update(seen[robot]["observation"].tobytes())
            digest.update(repr([infos[robot][key] for key in ("seconds", "running", "processes", "text")]).encode())
    came = {span.what for span in env.timeline if span.kind == "process" and span.status == "success"}
    assert came == {"FallingDoor": {"falling_shut"}, "RinseAndStow": {"rinsing"}}[task]
    return digest.hexdigest()


def made(task: str) -> Any:
    return remac_env.parallel_env(task, robots=2, clock="events", layout="one_wall_large")


@pytest.mark.long
@pytest.mark.parametrize("task", COMMANDS)
def test_the_same_seed_is_the_same_episode_whatever_was_before_and_with_another_hash_seed(task: str) -> None:
    env = made(task)
    first = played(env, task, 1)
    played(env, task, 2)
    assert played(env, task, 1) == first, "after another episode"
    env.close()
    code = f"from test_event_physics import made, played; print(played(made({task!r}), {task!r}, 1))"
    folders = os.pathsep.join([str(Path(__file__).parent), *(path for path in sys.path if path)])
    for hash_seed in ("1", "77"):
        environment = os.environ | {"PYTHONHASHSEED": hash_seed, "PYTHONPATH": folders}
        done = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment
        )
        assert done.stdout.strip() == first, f"with hash seed {hash_seed}"
