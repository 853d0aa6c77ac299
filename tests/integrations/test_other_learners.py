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


def test_rllib_masks_what_it_learns_from_and_not_only_what_it_plays(monkeypatch: pytest.MonkeyPatch) -> None:
    """No pass of the module gives a forbidden token any probability: exploring, playing, training."""
    pytest.importorskip("ray.rllib", reason="make ray installs it")
    torch = pytest.importorskip("torch")
    monkeypatch.syspath_prepend(str(EXAMPLES))
    example = importlib.import_module("rllib_two_robots")
    algorithm = example.learner(TASK, batch=64)
    module = algorithm.get_module("robot")
    seen, _ = example.Team(TASK).reset(seed=0)
    masks = torch.from_numpy(seen["robot_0"]["action_mask"][None])

    def rows() -> dict[str, object]:
        return {name: torch.from_numpy(part[None]) for name, part in seen["robot_0"].items()}

    batch = {"obs": rows()}
    module.compute_values(batch)  # as the learner does before it trains: this takes the mask out of the observation
    for told in (module.forward_exploration({"obs": rows()}), module.forward_inference({"obs": rows()}),
                 module.forward_train(batch)):  # fmt: skip
        chances = torch.softmax(told["action_dist_inputs"], dim=-1)
        assert 0 < masks.sum() < masks.numel()
        assert chances[masks == 0].sum() == 0 and chances[masks == 1].min() > 0
    algorithm.stop()


def test_robots_that_see_the_same_are_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("ray.rllib", reason="make ray installs it")
    monkeypatch.syspath_prepend(str(EXAMPLES))
    example = importlib.import_module("rllib_two_robots")
    team = example.Team(TASK)
    seen, _ = team.reset(seed=0)
    one, other = (seen[name]["observations"] for name in team.possible_agents)
    signs = 2 * example.SIGN  # repeated, as a faint one is not learnt from
    assert (one[:-signs] == other[:-signs]).all() and example.SIGN >= 32
    assert one[-signs:].tolist() == [1.0] * example.SIGN + [0.0] * example.SIGN
    assert other[-signs:].tolist() == one[-signs:].tolist()[::-1]
    assert all(seen[name] in team.observation_space(name) for name in seen)


def test_tianshou_plays_one_robot_with_masks(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("tianshou", reason="make ray installs it")
    monkeypatch.syspath_prepend(str(EXAMPLES))
    example = importlib.import_module("tianshou_ppo")
    policy = example.learn(TASK, 300)
    assert 0 <= example.successes(policy, TASK, range(1)) <= 1
