"""One to four robots: what each is told, observes and may do, and that nobody is number zero."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest

import remac_env
from remac_env import testing
from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.errors import OptionError
from remac_env.observation import Facts
from remac_env.oracle import certify

TEAMS = (1, 2, 3, 4)


def make(robots: int, **options: object) -> KitchenParallelEnv:
    return remac_env.parallel_env("OpenCabinetPnP", robots=robots, backend="symbolic", **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("robots", TEAMS)
def test_a_team_keeps_the_contract(robots: int) -> None:
    def env_fn() -> KitchenParallelEnv:
        return make(robots, starts="mixed")

    testing.check_spaces(env_fn, seeds=(3,), rounds=6)
    testing.check_determinism(env_fn, seeds=(3, 4), rounds=4)
    testing.check_changes(env_fn, seeds=(3,))
    testing.check_text(env_fn, seeds=(3,), rounds=3)


@pytest.mark.parametrize("robots", (3, pytest.param(4, marks=pytest.mark.long)))
def test_no_robot_of_a_larger_team_is_number_zero(robots: int) -> None:
    testing.check_names(lambda: make(robots, starts="mixed"), seeds=(1,), rounds=8)


def test_a_team_of_five_is_refused() -> None:
    with pytest.raises(OptionError, match="valid: 1, 2, 3, 4"):
        make(5)


def test_one_and_two_robots_see_vectors_of_one_size_and_each_robot_more_adds_a_block() -> None:
    sizes = [make(robots).observation_space("robot_0")["observation"].shape[0] for robots in TEAMS]
    facts = Facts(make(1).vocabulary)
    assert sizes[0] == sizes[1] == facts.size
    block = 1 + len(facts.fixtures) + 2 * len(facts.objects)
    assert [size - sizes[0] for size in sizes] == [0, 0, block, 2 * block]


def test_the_blocks_are_the_own_one_and_then_the_others_by_name() -> None:
    env = make(3)
    env.reset(seed=2)
    scene = env.start.scene
    facts = Facts(env.vocabulary, 3)
    block = 1 + len(facts.fixtures) + 2 * len(facts.objects)
    world = env.world.with_robot("robot_2", station=scene.fixtures["sink"].station)
    vectors = facts.vectors(scene, world, scene.robots)
    seen = {name: vector[: 3 * block].reshape(3, block) for name, vector in vectors.items()}
    aside, sink = seen["robot_0"][0], seen["robot_2"][0]
    assert aside[0] == 1 and sink[0] == 0 and not np.array_equal(aside, sink)
    for robot, blocks in {"robot_0": [aside, aside, sink], "robot_2": [sink, aside, aside]}.items():
        assert np.array_equal(seen[robot], blocks), robot


def test_the_joint_view_takes_a_token_for_each() -> None:
    env = gymnasium.make("RemacKitchen-HeatOnStove-v0", robots=3, backend="symbolic")
    env.reset(seed=0)
    size = env.action_space.nvec
    assert len(size) == 3 and len(env.unwrapped.action_masks()) == size.sum()
    _, _, _, _, info = env.step(np.zeros(3, int))
    assert list(info["robots"]) == ["robot_0", "robot_1", "robot_2"]


def test_one_place_takes_one_robot_and_out_of_the_way_there_is_room_for_all() -> None:
    env = make(4)
    env.reset(seed=0)
    tokens = {text: env.vocabulary.encode(text) for text in ("navigate to sink", "navigate to stove", "navigate aside")}
    sink, stove, aside = tokens.values()
    goes = dict(zip(env.agents, (sink, stove, sink, aside), strict=True))
    infos = env.step(goes)[-1]
    assert [infos[name]["outcome"]["reason"] for name in goes] == ["station_occupied", "", "station_occupied", ""]
    infos = env.step(dict.fromkeys(env.agents, aside))[-1]
    assert all(info["outcome"]["status"] == "success" for info in infos.values())


def test_a_shortest_plan_of_three_is_no_longer_than_of_two_and_reaches_the_goal() -> None:
    lengths = []
    for robots in (2, 3):
        env = make(robots, starts="mixed")
        env.reset(seed=7)
        found = certify(env.start.scene, env.world, env.goal)
        assert found.proof == "search" and found.plan is not None
        lengths.append(found.plan.cost)
        for joint in found.plan.rounds:
            infos = env.step({name: env.vocabulary.encode(step.text) for name, step in joint.items()})[-1]
        assert all(info["success"] for info in infos.values())
    assert lengths[1] <= lengths[0]
