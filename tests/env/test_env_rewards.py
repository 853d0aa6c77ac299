"""What rounds are worth, and what may be chosen: the options for those who learn."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces

import remac_env
from remac_env import testing
from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.errors import OptionError
from remac_env.oracle import FARTHEST, Distances, solve
from remac_env.seeding import generator
from remac_env.state import FLOOR
from remac_env.tasks.goals import progress

TASKS = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove", "WashPnPHeat")


def played(env: KitchenParallelEnv, seed: int, *, detour: int = 0) -> list[float]:
    """The rewards of random feasible rounds, and of a shortest plan from where they lead."""
    env.reset(seed=seed)
    rewards = []
    chance = generator(seed, "detour")
    for _ in range(detour):
        tokens = {name: int(chance.choice(np.flatnonzero(env.action_mask(name))[2:])) for name in env.agents}
        _, paid, *_ = env.step(tokens)
        rewards.append(paid[env.possible_agents[-1]])
        assert env.agents, "the detour ended the episode"
    plan = solve(env.start.scene, env.world, env.goal)
    assert plan is not None
    for joint in plan.rounds:
        _, paid, *_ = env.step({name: env.vocabulary.encode(step.text) for name, step in joint.items()})
        rewards.append(paid[env.possible_agents[-1]])
    assert not env.agents
    return rewards


def kitchen(task: str, **options: Any) -> KitchenParallelEnv:
    return remac_env.parallel_env(task, backend="symbolic", max_rounds=100, **options)


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("starts", ["paper", "mixed"])
@pytest.mark.parametrize("seeds", [range(2), pytest.param(range(2, 6), marks=pytest.mark.long)])
def test_no_round_of_a_shortest_plan_costs_progress_and_the_sum_is_one(task: str, starts: str, seeds: range) -> None:
    env = kitchen(task, robots=1, starts=starts, reward="progress", masks="feasible")
    for seed in seeds:
        rewards = played(env, seed)
        assert min(rewards) >= 0.0
        assert sum(rewards) == pytest.approx(1.0)
        assert sum(played(env, seed, detour=2)) == pytest.approx(1.0)


def test_the_change_of_progress_would_punish_the_right_move() -> None:
    """Or else the test above would prove nothing."""
    env = kitchen("OpenCabinetPnP", robots=1)
    env.reset(seed=0)
    plan = solve(env.start.scene, env.world, env.goal)
    assert plan is not None
    seen = [progress(env.goal, env.start.scene, env.world)]
    for joint in plan.rounds:
        env.step({name: env.vocabulary.encode(step.text) for name, step in joint.items()})
        seen.append(progress(env.goal, env.start.scene, env.world))
    assert min(np.diff(seen)) < 0.0


@pytest.mark.parametrize(("task", "robots"), [*((task, 1) for task in TASKS), ("OpenCabinetPnP", 2)])
def test_every_round_of_a_shortest_plan_comes_nearer_and_all_ways_are_worth_the_same(task: str, robots: int) -> None:
    env = kitchen(task, robots=robots, starts="mixed", reward="distance", masks="feasible")
    for seed in range(2):
        rewards = played(env, seed)
        assert rewards == [1.0] * (len(rewards) - 1) + [2.0]
        assert sum(played(env, seed, detour=3)) == pytest.approx(sum(rewards))


def team(task: str, reward: str) -> KitchenParallelEnv:
    env = kitchen(task, robots=2, reward=reward)
    env.reset(seed=0)
    return env


def paid(env: KitchenParallelEnv, *rounds: tuple[str, str]) -> list[float]:
    """What these rounds are worth, each said as the commands of both robots."""
    worth = []
    for commands in rounds:
        tokens = [env.vocabulary.encode(command) for command in commands]
        worth.append(env.step(dict(zip(env.agents, tokens, strict=True)))[1]["robot_0"])
    return worth


def test_the_nearest_robot_is_paid_for_a_right_step_that_the_teams_distance_does_not_pay() -> None:
    right = ("wait", "navigate to cabinet"), ("wait", "open cabinet door")
    assert paid(team("OpenCabinetPnP", "nearest"), *right) == [1.0, 1.0]
    assert paid(team("OpenCabinetPnP", "distance"), *right)[0] == 0.0


def test_all_ways_to_the_goal_are_worth_the_same_to_the_nearest_and_for_one_robot_it_is_the_distance() -> None:
    for seed in range(2):
        short, long = (played(kitchen("OpenCabinetPnP", reward="nearest"), seed, detour=n) for n in (0, 4))
        assert sum(short) == sum(long) == pytest.approx(7.0)  # one robot's shortest plan takes six rounds
    both = [played(kitchen("HeatOnStove", robots=1, reward=name), 0, detour=3) for name in ("nearest", "distance")]
    assert both[0] == both[1]


@pytest.mark.long
def test_where_each_holds_what_the_other_needs_the_teams_distance_counts() -> None:
    env, names = team("DefrostInBowl", "nearest"), ("meat", "bowl")
    paid(env, *(tuple(f"{step} {name}" for name in names) for step in ("navigate to", "pick up")))  # type: ignore[arg-type]
    assert {state.holding for state in env.world.robots.values()} == set(names)
    scene, world, distances = env.start.scene, env.world, Distances()
    assert distances.nearest(scene, world, env.goal) == distances.of(scene, world, env.goal) < FARTHEST


def test_distances_are_searched_once_and_bounded() -> None:
    env = kitchen("DefrostInBowl", robots=1)
    env.reset(seed=0)
    scene, world, goal = env.start.scene, env.world, env.goal
    distances = Distances()
    length = distances.of(scene, world, goal)
    env.step({"robot_0": env.vocabulary.encode(solve(scene, world, goal).rounds[0]["robot_0"].text)})  # type: ignore[union-attr]
    assert distances.of(scene, env.world, goal) == length - 1
    assert distances.searched == 1, "a world on the way of a plan that was found is not searched again"
    thrown = world.with_object(next(n for n in goal.names() if n in scene.objects), place=FLOOR)
    assert distances.of(scene, thrown, goal) == FARTHEST
    assert Distances(max_states=1).of(scene, world, goal) <= length, "what is proven, where the search gives up"


@pytest.mark.parametrize("task", ["DefrostInBowl", "HeatOnStove"])
@pytest.mark.parametrize("seeds", [range(1), pytest.param(range(1, 3), marks=pytest.mark.long)])
def test_feasible_masks_are_what_the_table_does_not_refuse(task: str, seeds: range) -> None:
    env = kitchen(task, robots=1, starts="mixed", masks="feasible")
    chance = generator(0, "feasible")
    for seed in seeds:
        env.reset(seed=seed)
        legal = np.flatnonzero(env.vocabulary.mask(env.start.scene))
        script: list[int] = []
        for _ in range(4):
            mask = env.action_mask("robot_0")
            assert mask[:2].all() and set(np.flatnonzero(mask)) < set(legal)
            for token in legal[2:]:
                twin = kitchen(task, robots=1, starts="mixed")
                twin.reset(seed=seed)
                for before in script:
                    twin.step({"robot_0": before})
                *_, infos = twin.step({"robot_0": int(token)})
                outcome = infos["robot_0"]["outcome"]
                assert (outcome["status"] == "success") == bool(mask[token]), (seed, script, int(token), outcome)
            script.append(int(chance.choice(np.flatnonzero(mask)[2:])))
            env.step({"robot_0": script[-1]})


def test_flat_observations_are_vectors_and_keep_every_contract() -> None:
    make = lambda: kitchen("OpenCabinetPnP", obs_format="flat")  # noqa: E731
    for check in (testing.check_spaces, testing.check_determinism, testing.check_names):
        check(make, seeds=(0, 1), rounds=8)
    testing.check_masks(make, limit=4)
    with pytest.raises(OptionError, match="no room for the pictures"):
        kitchen("OpenCabinetPnP", obs_format="flat", obs="state+images")


def test_gymnasium_gets_one_vector_or_keys_that_modules_may_have() -> None:
    single = gymnasium.make("RemacKitchen-OpenCabinetPnP-v0", robots=2, backend="symbolic")
    assert isinstance(single.observation_space, spaces.Dict)
    assert all(key.isidentifier() for key in single.observation_space)
    flat = gymnasium.make("RemacKitchen-OpenCabinetPnP-v0", robots=2, backend="symbolic", obs_format="flat")
    seen, info = flat.reset(seed=3)
    assert seen in flat.observation_space
    masks = np.concatenate([info["robots"][name]["action_mask"] for name in ("robot_0", "robot_1")])
    assert np.array_equal(masks, flat.unwrapped.action_masks())  # type: ignore[attr-defined]


def test_an_environment_says_what_it_is() -> None:
    env = kitchen("OpenCabinetPnP", robots=1)
    assert repr(env) == "<OpenCabinetPnP robots=1 backend='symbolic' max_rounds=100, not reset>"
    assert env._repr_png_() is None
    env.reset(seed=0)
    env.step({"robot_0": 0})
    assert "round 1" in repr(env)
    picture = env._repr_png_()
    assert picture is not None and picture.startswith(b"\x89PNG")
    env.close()
    assert "closed" in repr(env) and env._repr_png_() is None
