"""The tests that PettingZoo and Gymnasium ship, on every task, with one and two robots (symbolic backend)."""

from __future__ import annotations

import warnings
from types import SimpleNamespace
from typing import Any

import gymnasium
import pytest
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import api_test, max_cycles_test, parallel_api_test, parallel_seed_test, render_test
from pettingzoo.utils import aec_to_parallel, parallel_to_aec

import remac_env
from remac_env import sights, testing
from remac_env.options import CAMERAS

TASKS = tuple(remac_env.tasks())
CYCLES = 1000

every_task = pytest.mark.parametrize("task", TASKS)
one_and_two = pytest.mark.parametrize("robots", [1, 2])


def make(task: str, robots: int, **options: Any) -> Any:
    return remac_env.parallel_env(task, robots=robots, **({"backend": "symbolic", "max_rounds": CYCLES} | options))


@every_task
@one_and_two
def test_parallel_api(task: str, robots: int) -> None:
    with warnings.catch_warnings():
        # What is amiss, PettingZoo often only warns of.
        warnings.simplefilter("error")
        parallel_api_test(make(task, robots, starts="mixed"), num_cycles=CYCLES)


@every_task
@one_and_two
def test_parallel_seed(task: str, robots: int) -> None:
    parallel_seed_test(lambda: make(task, robots), num_cycles=CYCLES)


@every_task
@one_and_two
def test_max_cycles(task: str, robots: int) -> None:
    def seeded(max_cycles: int) -> Any:
        env = make(task, robots, max_rounds=max_cycles)
        for name in env.possible_agents:
            # This test draws unmasked tokens; unseeded, one run in many would end the episode by `done`.
            env.action_space(name).seed(7)
        return env

    module = SimpleNamespace(parallel_env=seeded, env=lambda max_cycles: parallel_to_aec(seeded(max_cycles)))
    max_cycles_test(module)


@every_task
@one_and_two
def test_agent_environment_cycle(task: str, robots: int) -> None:
    with warnings.catch_warnings():
        # PettingZoo warns that the observation is a Dict, which its own mask convention asks for.
        warnings.simplefilter("ignore")
        api_test(remac_env.env(task, robots=robots, backend="symbolic", max_rounds=100), num_cycles=200)


def test_round_trip_to_parallel() -> None:
    parallel_api_test(aec_to_parallel(remac_env.env(TASKS[0], backend="symbolic")), num_cycles=50)


@every_task
@one_and_two
def test_gymnasium(task: str, robots: int) -> None:
    env = gymnasium.make(f"RemacKitchen-{task}-v0", robots=robots, backend="symbolic")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*out of date.*")
        check_env(env.unwrapped, skip_render_check=True)
    env.close()


@pytest.mark.long
@every_task
@one_and_two
def test_render(task: str, robots: int) -> None:
    pytest.importorskip("remac_env.rendering.stage", reason="remac_env.rendering is unfinished: no stage.py")
    seen = {"rgb_array": lambda picture: min(picture.shape[:2]) >= 240 and picture.std() > 5}
    render_test(lambda render_mode: remac_env.env(task, robots=robots, backend="symbolic", render_mode=render_mode),
                custom_tests=seen)  # fmt: skip


def test_the_pictures_are_those_that_were_asked_for() -> None:
    env = make(TASKS[0], 1, obs="state+images", image_size=32, cameras=("station", "wrist"))
    obs, _ = env.reset(seed=1)
    assert set(obs["robot_0"]) == {"observation", "action_mask", "wrist", "station"}
    assert env.observation_space("robot_0").contains(obs["robot_0"])
    assert set(sights.CAMERAS) == set(CAMERAS), "each camera is told of"
    env.close()


def test_images_lie_in_their_space_and_render_gives_a_picture() -> None:
    pytest.importorskip("remac_env.rendering.stage", reason="remac_env.rendering is unfinished: no stage.py")
    env = make(TASKS[0], 1, obs="state+images", image_size=32, render_mode="rgb_array")
    observations, _ = env.reset(seed=0)
    assert env.observation_space("robot_0").contains(observations["robot_0"])
    picture = env.render()
    assert picture.dtype == "uint8" and picture.shape[2] == 3 and picture.std() > 5
    testing.check_spaces(lambda: env, seeds=(0,), rounds=1)
