"""Libraries for learners take our environments as they are: Stable-Baselines3, sb3-contrib, SuperSuit; the examples."""

from __future__ import annotations

import importlib
import re
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from agent_kitchens import play, suite_kitchen
from document_pages import blocks

import remac_agents
import remac_env
from remac_agents.planners.policy_file import read_policy
from remac_env.errors import OptionError

pytest.importorskip("torch", reason="torch is not installed: docs/learning.md says how")
EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "rl"
TASK = "OpenCabinetPnP"


def single(**options: Any) -> gymnasium.Env[Any, Any]:
    return gymnasium.make(f"RemacKitchen-{TASK}-v0", backend="symbolic", max_rounds=6, **options)


@pytest.mark.parametrize("robots", [1, 2])
def test_multi_input_policies_take_dicts_with_pictures_and_without(robots: int) -> None:
    sb3 = pytest.importorskip("stable_baselines3")
    for more in ({}, {"obs": "state+images", "image_size": 36}):
        env = single(robots=robots, **more)
        model = sb3.PPO("MultiInputPolicy", env, n_steps=8, batch_size=4, n_epochs=1, seed=0, device="cpu")
        model.learn(8)
        seen, _ = env.reset(seed=1)
        action, _ = model.predict(seen)
        assert env.action_space.contains(np.asarray(action) if robots == 2 else int(action))
        env.close()


def test_stable_baselines_own_check_finds_nothing() -> None:
    pytest.importorskip("stable_baselines3")
    from stable_baselines3.common.env_checker import check_env

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for form in ("dict", "flat"):
            check_env(single(robots=2, obs_format=form).unwrapped, warn=True)


def test_gymnasium_films_a_round_a_second(tmp_path: Path) -> None:
    pytest.importorskip("moviepy")
    import cv2
    from gymnasium.wrappers import RecordVideo

    env = RecordVideo(single(render_mode="work"), str(tmp_path), episode_trigger=lambda episode: True)
    env.reset(seed=4)
    for command in ("navigate to cabinet", "open cabinet door"):
        env.step(env.unwrapped.vocabulary.encode(command))  # type: ignore[attr-defined]
    env.close()
    film = cv2.VideoCapture(str(tmp_path / "rl-video-episode-0.mp4"))
    assert (film.get(cv2.CAP_PROP_FPS), film.get(cv2.CAP_PROP_FRAME_COUNT)) == (1.0, 3.0)
    pictures = [film.read()[1].astype(int) for _ in range(3)]
    assert pictures[0].shape == (648, 768, 3)
    for one, next_one in zip(pictures, pictures[1:], strict=False):
        assert (abs(one - next_one).max(axis=2) > 40).mean() > 0.02, "nothing is seen to happen"


@pytest.mark.parametrize("robots", [1, 2])
def test_masks_reach_maskable_ppo_and_it_keeps_to_them(robots: int) -> None:
    contrib = pytest.importorskip("sb3_contrib")
    env = single(robots=robots, masks="feasible", obs_format="flat")
    model = contrib.MaskablePPO("MlpPolicy", env, n_steps=8, batch_size=4, n_epochs=1, seed=0, device="cpu")
    model.learn(8)
    seen, _ = env.reset(seed=1)
    for _ in range(6):
        masks = env.unwrapped.action_masks()  # type: ignore[attr-defined]
        action, _ = model.predict(seen, action_masks=masks)
        tokens = np.atleast_1d(action)
        assert all(masks.reshape(robots, -1)[number, token] for number, token in enumerate(tokens))
        seen, _, terminated, truncated, _ = env.step(action if robots == 2 else int(action))
        if terminated or truncated:
            seen, _ = env.reset()
    env.close()


def test_supersuit_wraps_the_flat_form() -> None:
    supersuit = pytest.importorskip("supersuit")
    env = remac_env.parallel_env(TASK, robots=2, backend="symbolic", obs_format="flat", max_rounds=6)
    size = env.observation_space("robot_0").shape[0]  # type: ignore[index]
    for wrap, shape in (
        (supersuit.flatten_v0, (size,)),
        (lambda made: supersuit.frame_stack_v1(made, 3), (3 * size,)),
        (supersuit.agent_indicator_v0, (size + 2,)),
        (lambda made: supersuit.frame_stack_v1(supersuit.agent_indicator_v0(supersuit.flatten_v0(made)), 3),
         (3 * (size + 2),)),
    ):  # fmt: skip
        wrapped = wrap(env)
        seen, infos = wrapped.reset(seed=0)
        while wrapped.agents:
            for name in wrapped.agents:
                assert seen[name].shape == shape and wrapped.observation_space(name).contains(seen[name])
            chance = np.random.default_rng(0)
            actions = {n: int(chance.choice(np.flatnonzero(infos[n]["action_mask"])[2:])) for n in wrapped.agents}
            seen, _, _, _, infos = wrapped.step(actions)


def test_a_team_is_one_policy_s_copies_for_stable_baselines_without_glue() -> None:
    """Our "episode" in PettingZoo's infos is no episode of its monitor, which it reads after every step."""
    contrib = pytest.importorskip("sb3_contrib")
    from remac_env.integrations.sb3 import vec_env

    kitchen: dict[str, Any] = {"backend": "symbolic", "masks": "feasible", "max_rounds": 4}
    for policy, form in (("MlpPolicy", "flat"), ("MultiInputPolicy", "dict")):
        envs = vec_env(TASK, robots=2, copies=2, seed=3, obs_format=form, **kitchen)
        assert envs.num_envs == 4
        model = contrib.MaskablePPO(policy, envs, n_steps=8, batch_size=8, n_epochs=1, seed=0, device="cpu")
        model.learn(64)
        assert model.ep_info_buffer and {tuple(sorted(info)) for info in model.ep_info_buffer} == {("l", "r", "t")}
        assert {info["l"] for info in model.ep_info_buffer} <= {1, 2, 3, 4}
        envs.close()


def test_its_robots_are_told_what_the_parallel_environment_tells_them() -> None:
    pytest.importorskip("stable_baselines3")
    from remac_env.integrations.sb3 import vec_env

    options: dict[str, Any] = {"backend": "symbolic", "obs_format": "flat", "max_rounds": 2, "reward": "progress"}
    envs = vec_env(TASK, robots=2, copies=2, seed=7, **options)
    kitchen = remac_env.parallel_env(TASK, robots=2, **options)
    seen, (told, infos) = envs.reset(), kitchen.reset(seed=8)
    assert np.array_equal(seen[2:], np.stack(list(told.values())))
    begun = envs.venv.reset_infos[3]
    assert begun["start"] == infos["robot_1"]["episode"] and "episode" not in begun
    masks = envs.env_method("action_masks")
    assert np.array_equal(masks[2], infos["robot_0"]["action_mask"].astype(bool))
    tokens = [int(np.flatnonzero(mask)[5]) for mask in masks]
    for last in (False, True):
        seen, rewards, dones, told = envs.step(np.array(tokens))
        own, paid, _, cut, infos = kitchen.step({"robot_0": tokens[2], "robot_1": tokens[3]})
        assert dones.tolist() == [last] * 4 and rewards[2] == np.float32(paid["robot_0"])
        assert told[3]["outcome"] == infos["robot_1"]["outcome"] and told[3]["TimeLimit.truncated"] is cut["robot_1"]
    assert np.array_equal(told[2]["terminal_observation"], own["robot_0"]) and told[2]["episode"]["l"] == 2
    assert told[2]["reset_info"]["start"]["seed"] != 8 and not np.array_equal(seen[2], own["robot_0"])
    with pytest.raises(OptionError, match="copies 0"):
        vec_env(TASK, copies=0)
    with pytest.raises(OptionError, match="valid: 'rounds'"):
        vec_env(TASK, clock="events")


def test_its_robots_may_be_told_which_of_them_they_are() -> None:
    """At a start two robots see the same, so that one policy's best token is the same for both."""
    pytest.importorskip("stable_baselines3")
    from remac_env.integrations.sb3 import vec_env

    for form in ("flat", "dict"):
        options: dict[str, Any] = {"backend": "symbolic", "obs_format": form, "max_rounds": 1, "seed": 7}
        plain, signed = (vec_env(TASK, robots=2, sign=sign, **options) for sign in (0, 3))
        same, seen = plain.reset(), signed.reset()
        if form == "dict":
            assert signed.observation_space.contains({key: part[0] for key, part in seen.items()})
            same, seen = same["observation"], seen["observation"]
        assert np.array_equal(same[0], same[1]) and np.array_equal(seen[:, :-6], same)
        assert seen[:, -6:].tolist() == [[1, 1, 1, 0, 0, 0], [0, 0, 0, 1, 1, 1]]
        *_, told = signed.step(np.zeros(2, int))
        last = told[1]["terminal_observation"]
        assert (last["observation"] if form == "dict" else last)[-6:].tolist() == [0, 0, 0, 1, 1, 1]
    with pytest.raises(OptionError, match="sign -1"):
        vec_env(TASK, sign=-1)


def test_the_python_of_the_page_runs() -> None:
    for needed in ("supersuit", "stable_baselines3"):
        pytest.importorskip(needed)
    shown = [block for block in blocks("docs/learning.md") if block.language == "python" and "vec_env" in block.code]
    assert shown
    for block in shown:
        space: dict[str, Any] = {"__name__": "page"}
        exec(compile(block.code, block.where, "exec"), space)  # noqa: S102
        assert space["envs"].num_envs == 8 and space["model"].num_timesteps >= 64


@pytest.mark.long
@pytest.mark.parametrize(("example", "needs"), [("maskable_ppo", "sb3_contrib"), ("ppo_in_torch", "torch")])
def test_an_example_learns_and_its_policy_plays(example: str, needs: str, tmp_path: Path) -> None:
    pytest.importorskip(needs)
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / f"{example}.py"), "--steps", "30000", "--out", "policy.npz"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    reached = {starts: int(n) for starts, n in re.findall(r"(\w+) starts: (\d+) of 100 unseen", done.stdout)}
    assert reached["paper"] >= 90 and reached["mixed"] >= 70, done.stdout
    planner = f"policy:{tmp_path / 'policy.npz'}"
    reports = [
        play(suite_kitchen(TASK, robots=1), remac_agents.make("BASE", planner=planner), seed=seed) for seed in range(10)
    ]
    assert sum(report.success for report in reports) >= 8


def test_a_short_lesson_ends_in_a_file_that_says_what_the_network_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import torch

    monkeypatch.syspath_prepend(str(EXAMPLES))
    kitchens, loop = (importlib.import_module(name) for name in ("kitchens", "ppo_in_torch"))
    monkeypatch.setattr(loop, "ROUNDS", 8)
    tasks = (TASK, "HeatOnStove")
    policy = loop.learn(tasks, 32)
    kitchens.save_policy(tmp_path / "policy.npz", policy)
    again = read_policy(tmp_path / "policy.npz")
    assert again.tasks == tasks and again.masks == "feasible"
    env = kitchens.Kitchens("HeatOnStove", tasks)
    seen, _ = env.reset(seed=0, options={})
    net = loop.network(len(seen), len(again.vocabulary))
    with torch.no_grad():
        for layer, (weights, bias) in zip([part for part in net if hasattr(part, "bias")], again.layers, strict=True):
            layer.weight.copy_(torch.from_numpy(weights))
            layer.bias.copy_(torch.from_numpy(bias))
        scores = net(torch.from_numpy(seen)).numpy()
    assert np.allclose(scores, again.scores(seen[:-2], "HeatOnStove"), atol=1e-4)
    assert seen[-2:].tolist() == [0.0, 1.0]
    assert 0 <= kitchens.successes(again, "HeatOnStove", "paper", range(2)) <= 2
