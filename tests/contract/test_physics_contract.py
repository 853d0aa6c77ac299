"""The same contracts in physics, where a round costs seconds: fewer rounds, fewer tokens, the same promises."""

from __future__ import annotations

from functools import partial
from importlib.util import find_spec
from types import SimpleNamespace
from typing import Any

import gymnasium
import pytest
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import api_test, max_cycles_test, parallel_api_test, parallel_seed_test

import remac_env
from remac_env import testing
from remac_env.oracle import solve
from remac_env.testing.play import opened, play, scripted

CYCLES = 20
TASKS = tuple(remac_env.tasks())

pytestmark = pytest.mark.skipif(
    find_spec("remac_env.backends.physics.backend") is None, reason="backends/physics/backend.py is unfinished"
)
every_task = pytest.mark.parametrize("task", TASKS)
one_and_two = pytest.mark.parametrize("robots", [1, 2])


def maker(task: str, robots: int, **options: Any) -> Any:
    return partial(remac_env.parallel_env, task, robots=robots, **({"backend": "physics"} | options))


def test_spaces_and_worlds() -> None:
    """Includes check_world after every round: what geometry says is a world that can be."""
    testing.check_spaces(maker("DefrostInBowl", 2, starts="mixed"), seeds=(0,), rounds=6)


def test_malformed_actions() -> None:
    """NaN must never reach MuJoCo, which would silently begin anew."""
    testing.check_actions(maker("OpenCabinetPnP", 2), rounds=2)


def test_lifecycle() -> None:
    testing.check_lifecycle(maker("OpenMicrowavePnP", 1))


def test_same_seed_same_episode() -> None:
    testing.check_determinism(maker("OpenCabinetPnP", 2), seeds=(0, 1), rounds=3)


@pytest.mark.parametrize("starts", ["paper", "mixed"])
@every_task
def test_the_start_is_the_one_that_was_drawn(task: str, starts: str) -> None:
    """The world that is read off the simulator at reset is the symbolic one."""
    physics, symbolic = (maker(task, 2, starts=starts, backend=name)() for name in ("physics", "symbolic"))
    for seed in range(3):
        _, infos = physics.reset(seed=seed)
        symbolic.reset(seed=seed)
        assert infos["robot_0"]["world"] == symbolic.world, seed
        assert infos["robot_0"]["episode"]["digest"] == symbolic.start.digest
    physics.close()


@pytest.mark.long
@every_task
@one_and_two
def test_library_tests(task: str, robots: int) -> None:
    """PettingZoo's tests and Gymnasium's, 20 cycles each."""
    make = maker(task, robots, max_rounds=CYCLES)
    parallel_api_test(make(), num_cycles=CYCLES)
    parallel_seed_test(make, num_cycles=CYCLES)
    api_test(remac_env.env(task, robots=robots, max_rounds=4), num_cycles=CYCLES)

    def short(max_cycles: int) -> Any:
        env = maker(task, robots, max_rounds=max_cycles)()
        for name in env.possible_agents:
            env.action_space(name).seed(7)
        return env

    from pettingzoo.utils import parallel_to_aec

    max_cycles_test(SimpleNamespace(parallel_env=short, env=lambda max_cycles: parallel_to_aec(short(max_cycles))))
    check_env(gymnasium.make(f"RemacKitchen-{task}-v0", robots=robots).unwrapped, skip_render_check=True)


@pytest.mark.long
@every_task
@one_and_two
def test_contracts_of_every_task(task: str, robots: int) -> None:
    make = maker(task, robots)
    testing.check_spaces(make, seeds=(0,), rounds=CYCLES)
    testing.check_masks(make, limit=6)
    testing.check_actions(make, rounds=2)
    testing.check_lifecycle(make)
    testing.check_text(make, seeds=(0, 1), rounds=4)
    testing.check_determinism(make, seeds=(0, 1), rounds=5)
    # Robots that start from different places need not do equally well, so only verdicts are mirrored.
    testing.check_names(make, seeds=(0,), rounds=5, replay=False)


@pytest.mark.long
@every_task
@one_and_two
def test_oracle_plan_takes_the_same_worlds_as_the_table(task: str, robots: int) -> None:
    """Round by round, the world read off the simulator is the one that the skill table predicts."""
    with opened(maker(task, robots)) as physics, opened(maker(task, robots, backend="symbolic")) as symbolic:
        for seed in range(2):
            symbolic.reset(seed=seed)
            plan = solve(symbolic.start.scene, symbolic.world, symbolic.goal)
            assert plan is not None
            encode = physics.vocabulary.encode
            script = [{robot: encode(step.text) for robot, step in joint.items()} for joint in plan.rounds]
            turns = zip(
                play(physics, seed, scripted(script, otherwise=0), rounds=plan.length),
                play(symbolic, seed, scripted(script, otherwise=0), rounds=plan.length),
                strict=True,
            )
            for real, predicted in turns:
                name = real.alive[-1]
                told = f"seed {seed}, round {real.number}: {real.infos[name]['outcome']}"
                assert real.infos[name]["world"] == predicted.infos[name]["world"], told
