"""Names and numbers that are not valid, and the Gymnasium view."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces
from gymnasium.error import ResetNeeded

import remac_env
from remac_env.errors import ActionError, LifecycleError, OptionError, UnknownNameError, check_choice
from remac_env.kitchen import layout, style

TASKS = tuple(remac_env.tasks())


def make(task: str = "OpenCabinetPnP", **options: Any) -> Any:
    return remac_env.parallel_env(task, **({"backend": "symbolic"} | options))


# -- options --------------------------------------------------------------------------------------------------------


def test_the_tasks_are_there_in_their_order() -> None:
    table = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove")
    assert (*table, "WashPnPHeat", "SeasonedMicrowave") == TASKS


@pytest.mark.parametrize("name", ["OpenCabinetPNP", "", None, 3, ["OpenCabinetPnP"]])
def test_an_unknown_task_gets_the_list(name: Any) -> None:
    with pytest.raises(UnknownNameError) as error:
        remac_env.parallel_env(name, backend="symbolic")
    assert all(task in str(error.value) for task in TASKS)
    assert repr(name) in str(error.value)


@pytest.mark.parametrize(
    ("option", "value", "valid"),
    [
        ("backend", "mujoco", ("physics", "symbolic")),
        ("starts", "easy", ("paper", "mixed")),
        ("obs", "pixels", ("state", "state+images")),
        ("text", "long", ("plain", "states")),
        ("feedback", "none", ("status", "reason")),
        ("wording", 4, ("1", "2", "3")),
        ("naming", "model", ("role", "category")),
        ("reward", "dense", ("sparse", "progress")),
        ("render_mode", "ansi", ("rgb_array", "work", "human")),
        ("style", "baroque", style.names()),
        ("style", "", style.names()),
        ("layout", "castle", layout.names()),
        ("layout", 7, layout.names()),
    ],
)
def test_an_unknown_value_gets_the_valid_ones(option: str, value: Any, valid: tuple[str, ...]) -> None:
    with pytest.raises((UnknownNameError, OptionError)) as error:
        make(**{option: value})
    assert all(name in str(error.value) for name in valid)
    assert option in str(error.value) and repr(value) in str(error.value)


@pytest.mark.parametrize(
    ("option", "values"),
    [
        ("robots", (0, 5, -1, 1.0, "2", True, None)),
        ("image_size", (0, 15, 5000, 128.0)),
        ("max_rounds", (0, -1, None, 2.5)),
        ("perception_noise", (-0.1, 5, float("nan"), float("inf"), "0.01")),
        ("failure_rate", (-0.1, 1.1, float("nan"), True)),
    ],
)
def test_a_number_outside_its_range_gets_the_range(option: str, values: tuple[Any, ...]) -> None:
    for value in values:
        with pytest.raises(OptionError, match=f"{option} .* is not valid; valid: "):
            make(**{option: value})


def test_failure_rate_is_not_for_physics() -> None:
    with pytest.raises(OptionError, match="perception_noise"):
        remac_env.parallel_env("OpenCabinetPnP", backend="physics", failure_rate=0.1)


def test_an_unknown_keyword_is_named() -> None:
    with pytest.raises(TypeError, match="colour"):
        make(colour="red")


@pytest.mark.parametrize("seed", [-1, 2**63, 1.0, "1", [1], True, np.float64(3)])
def test_a_bad_seed_is_refused_and_the_episode_goes_on(seed: Any) -> None:
    env = make()
    env.reset(seed=1)
    before = env.start.digest
    with pytest.raises(OptionError, match="seed"):
        env.reset(seed=seed)
    assert env.start.digest == before and env.agents == env.possible_agents


def test_seeds_of_any_whole_kind_are_the_same() -> None:
    env = make()
    digests = set()
    for seed in (7, np.int64(7), np.uint8(7)):
        _, infos = env.reset(seed=seed)
        digests.add(infos["robot_0"]["episode"]["digest"])
        assert type(infos["robot_0"]["episode"]["seed"]) is int
    assert len(digests) == 1
    env.reset(seed=2**63 - 1)


def test_reset_without_a_seed_goes_on_from_the_last_one() -> None:
    def walk(first: int | None) -> list[int]:
        env = make()
        env.reset(seed=first)
        return [env.reset()[1]["robot_0"]["episode"]["seed"] for _ in range(3)]

    assert walk(5) == walk(5)
    assert len({*walk(5), *walk(6)}) == 6
    assert walk(None) != walk(None)
    assert all(seed < 900_000 for seed in walk(5))


def test_reset_options_choose_style_and_layout() -> None:
    env = make()
    name = style.names()[-1]
    _, infos = env.reset(seed=0, options={"style": name, "layout": layout.names()[0], "anything": 1})
    assert infos["robot_0"]["episode"]["style"] == name
    for options in ({"style": "baroque"}, {"layout": "castle"}, {"style": 3}):
        with pytest.raises(UnknownNameError):
            env.reset(seed=0, options=options)


@pytest.mark.parametrize("action", [3, np.int64(3), np.int32(3), np.uint8(3), np.array(3)])
def test_whole_numbers_of_any_kind_are_tokens(action: Any) -> None:
    env = make(robots=1)
    env.reset(seed=0)
    _, _, _, _, infos = env.step({"robot_0": action})
    assert infos["robot_0"]["outcome"]["status"] == "success"


# -- the Gymnasium view ---------------------------------------------------------------------------------------------


def view(robots: int, **options: Any) -> Any:
    return gymnasium.make("RemacKitchen-HeatOnStove-v0", robots=robots, backend="symbolic", **options)


def test_every_task_can_be_made_by_gymnasium() -> None:
    for task in TASKS:
        env = gymnasium.make(f"RemacKitchen-{task}-v0", backend="symbolic")
        observation, info = env.reset(seed=1)
        assert env.observation_space.contains(observation)
        assert info["robots"]["robot_0"]["episode"]["task"] == task
        assert info["robots"]["robot_0"]["episode"]["robots"] == 1


@pytest.mark.parametrize("robots", [1, 2])
def test_the_view_shows_what_the_parallel_environment_does(robots: int) -> None:
    env, parallel = view(robots, starts="mixed"), make("HeatOnStove", robots=robots, starts="mixed")
    size = len(parallel.vocabulary)
    wanted = spaces.Discrete(size) if robots == 1 else spaces.MultiDiscrete([size, size])
    assert env.action_space == wanted
    flat, info = env.reset(seed=4)
    nested, infos = parallel.reset(seed=4)
    chance = np.random.default_rng(0)
    for _ in range(8):
        assert set(flat) == {f"{name}_{key}" for name in nested for key in nested[name]}
        assert all(np.array_equal(flat[f"{n}_{k}"], v) for n, seen in nested.items() for k, v in seen.items())
        assert info["robots"] == infos
        masks = env.unwrapped.action_masks()
        assert masks.dtype == bool and masks.shape == (robots * size,)
        assert np.array_equal(masks, np.concatenate([s["action_mask"] for s in nested.values()]).astype(bool))
        tokens = chance.choice(np.flatnonzero(nested["robot_0"]["action_mask"]), robots)
        flat, reward, terminated, truncated, info = env.step(int(tokens[0]) if robots == 1 else tokens)
        nested, rewards, terminations, truncations, infos = parallel.step(
            dict(zip(parallel.agents, tokens, strict=True))
        )
        assert {(reward, terminated, truncated)} == set(
            zip(rewards.values(), terminations.values(), truncations.values(), strict=True)
        )
        if terminated or truncated:
            break


def test_a_masked_token_is_a_lost_round_in_the_view_too() -> None:
    env = view(2)
    env.reset(seed=0)
    *_, info = env.step([10**9, 0])
    assert info["robots"]["robot_0"]["outcome"]["reason"] == "invalid"
    assert info["robots"]["robot_1"]["outcome"]["status"] == "success"


@pytest.mark.parametrize("action", [None, 1.0, float("nan"), "wait", True, [0.0], np.array([1]), [0, 0], {}, (0,)])
def test_malformed_actions_of_one_robot(action: Any) -> None:
    env = view(1).unwrapped
    env.reset(seed=0)
    with pytest.raises(ActionError, match="robot_0"):
        env.step(action)
    assert env.parallel._running().rounds == 0


BAD_PAIRS = (None, 0, np.array(0), [0], [0, 0, 0], [0, 1.5], [0, None], np.zeros(2), "00", [[0, 0]])


@pytest.mark.parametrize("action", BAD_PAIRS)
def test_malformed_actions_of_two_robots(action: Any) -> None:
    env = view(2).unwrapped
    env.reset(seed=0)
    with pytest.raises(ActionError, match="robot_"):
        env.step(action)
    assert env.parallel._running().rounds == 0


def test_life_cycle_of_the_view() -> None:
    env = view(1, max_rounds=2).unwrapped
    for call in (lambda: env.step(0), env.render):
        with pytest.raises(ResetNeeded):
            call()
    with pytest.raises(LifecycleError):
        env.action_masks()
    env.reset(seed=0)
    env.step(0)
    assert env.step(0)[3] is True
    with pytest.raises(ResetNeeded):
        env.step(0)
    env.reset(seed=0)
    env.close()
    env.close()
    with pytest.raises(ResetNeeded):
        env.step(0)
    with pytest.raises(LifecycleError):
        env.reset(seed=0)


def test_of_a_long_list_of_valid_names_an_error_shows_the_nearest() -> None:
    names = [f"template number {number:03} about fruit" for number in range(200)] + ["hidden glasses"]
    with pytest.raises(UnknownNameError) as told:
        check_choice("template", "hiden glases", names)
    assert "valid: hidden glasses, template" in str(told.value) and str(told.value).endswith(" and 189 more")
    assert len(str(told.value)) < 1_000
