"""RLlib's new stack with two robots and masks, and Tianshou with masks: the examples run, only smaller."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "rl"
TASK = "OpenCabinetPnP"

pytestmark = pytest.mark.long


def test_rllib_plays_two_robots_with_masks(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("ray.rllib", reason="make ray installs it")
    monkeypatch.syspath_prepend(str(EXAMPLES))
    example = importlib.import_module("rllib_two_robots")
    algorithm = example.learner(TASK, batch=64)
    told = algorithm.train()["env_runners"]
    assert told["num_env_steps_sampled"] >= 64
    assert 0 <= example.successes(algorithm, TASK, range(1)) <= 1
    algorithm.stop()


def test_tianshou_plays_one_robot_with_masks(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("tianshou", reason="make ray installs it")
    monkeypatch.syspath_prepend(str(EXAMPLES))
    example = importlib.import_module("tianshou_dqn")
    policy = example.learn(TASK, 80)
    assert 0 <= example.successes(policy, TASK, range(1)) <= 1
