"""register_task: tasks from outside pass the same checks, and mistakes in them are named."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
import pytest
from outside_task import STORE_BREAD

import remac_env
from remac_env import tasks as task_table
from remac_env.errors import KitchenFileError, OptionError, RemacError, UnknownNameError
from remac_env.oracle import solve
from remac_env.tasks.goals import All, Inside, Released, SwitchedOn
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.testing import check_task, check_world
from remac_env.vocabulary import Noun, built_in


@pytest.fixture(autouse=True)
def _as_before() -> Iterator[None]:
    """What a test registers is gone after it."""
    import sys

    specs = sys.modules["remac_env.tasks"]._SPECS
    kept, ids = dict(specs), set(gymnasium.registry)
    yield
    specs.clear()
    specs.update(kept)
    for name in set(gymnasium.registry) - ids:
        del gymnasium.registry[name]


def reset(spec: TaskSpec, seed: int = 0, **options: Any) -> Any:
    """An environment of a task from outside, after its reset."""
    remac_env.register_task(spec)
    env = remac_env.parallel_env(spec.name, **({"backend": "symbolic"} | options))
    env.reset(seed=seed)
    return env


def test_a_task_with_other_nouns_and_another_kitchen_keeps_every_contract() -> None:
    check_task(STORE_BREAD, seeds=(0,), rounds=12, starts=("mixed",))


def test_once_registered_it_is_there_like_the_others() -> None:
    remac_env.register_task(STORE_BREAD)
    remac_env.register_task(STORE_BREAD)
    assert remac_env.tasks()[-1] == "StoreBread" and len(remac_env.tasks()) == 7
    env = gymnasium.make("RemacKitchen-StoreBread-v0", robots=2, backend="symbolic")
    _, info = env.reset(seed=0)
    assert info["robots"]["robot_1"]["goal"] == "store the bread in the pantry"
    assert info["robots"]["robot_1"]["verbs"] == {"store": ("turn on tap",)}


def test_its_words_come_after_the_built_in_ones_and_stay_its_own() -> None:
    env = reset(STORE_BREAD)
    words, own = env.vocabulary, len(built_in())
    assert [words.decode(token) for token in range(own)] == [built_in().decode(token) for token in range(own)]
    assert words.decode(own) == "navigate to bench" and len(words) == own + 5 + 9
    commands = env.step(dict.fromkeys(env.agents, 0))[4]["robot_0"]["commands"]
    assert "open pantry door" in commands and "navigate to counter" not in commands
    assert len(remac_env.parallel_env("HeatOnStove", backend="symbolic").vocabulary) == len(built_in()) == own
    with pytest.raises(UnknownNameError):
        built_in().encode("open pantry door")


def test_its_plans_are_as_long_as_by_hand() -> None:
    """open, tray: go, pick, go, place; bread: go, pick, go, place; tap: go, turn on; one go more to open the pantry."""
    lengths = []
    for robots in (1, 2):
        env = reset(STORE_BREAD, robots=robots)
        plan = solve(env.start.scene, env.world, env.goal)
        assert plan is not None
        lengths.append(plan.length)
    assert lengths[0] == 12 and 6 <= lengths[1] <= 8


def test_a_vessel_may_stand_in_place_only_where_there_is_room() -> None:
    """Two vessels that both belong into a fixture with one slot: a mixed start never puts both there."""
    crowded = replace(
        STORE_BREAD,
        name="Crowded",
        goal=All(Inside("tray", "pantry"), Inside("plate", "pantry"), Released("bread")),
        roles=(*STORE_BREAD.roles, Role("other", ("plate",), at="pantry")),
    )
    for seed in range(40):
        env = reset(crowded, seed, starts="mixed")
        check_world(env.start.scene, env.world, where=f"seed {seed}")


def test_a_fixture_that_runs_only_when_shut_is_never_running_open() -> None:
    warm = TaskSpec(
        name="Warm",
        wordings=("warm the {food}",) * 3,
        goal=All(Inside("{food}", "microwave"), SwitchedOn("microwave")),
        roles=(Role("food", ("vegetable",)),),
        fixtures=("counter", "microwave"),
    )
    running = 0
    for seed in range(60):
        env = reset(warm, seed, starts="mixed", robots=1)
        check_world(env.start.scene, env.world, where=f"seed {seed}")
        running += bool(env.world.fixtures["microwave"].on)
    assert running > 3
    env = reset(warm, robots=1)
    plan = solve(env.start.scene, env.world, env.goal)
    assert plan is not None and plan.length == 8


def test_things_the_goal_names_do_not_occupy_the_vessel_at_the_start() -> None:
    both = replace(
        STORE_BREAD,
        name="Both",
        goal=All(Inside("bread", "tray"), Inside("tray", "pantry"), Inside("carrot", "pantry")),
        roles=(*STORE_BREAD.roles, Role("carrot", ("carrot",), at="pantry")),
    )
    for seed in range(60):
        env = reset(both, seed, starts="mixed")
        assert env.world.objects["carrot"].place.where != "tray"


TRAY = Role("vessel", ("tray",), at="bench")

# -- mistakes -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["", "store bread", "storeBread", "Store-Bread", "HeatOnStove"])
def test_a_bad_or_taken_name(name: str) -> None:
    with pytest.raises(OptionError, match=name or "''"):
        remac_env.register_task(replace(STORE_BREAD, name=name))
    assert len(remac_env.tasks()) == 6


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"layouts": ("castle",)}, UnknownNameError, "castle"),
        ({"layout_files": {"galley_for_tests": "nowhere.toml"}}, KitchenFileError, "nowhere.toml"),
        ({"fixtures": ("bench", "oven")}, UnknownNameError, "oven.*bench, pantry, tap"),
        ({"roles": (Role("food", ("bread",), at="oven"), TRAY)}, RemacError, "oven"),
        ({"roles": (Role("food", ("cake",), at="bench"), TRAY)}, UnknownNameError, "cake"),
        ({"nouns": (Noun("stove", "object", ("pick up",)),)}, OptionError, "stove"),
        ({"nouns": (*STORE_BREAD.nouns, Noun("lid", "object", ("juggle",)))}, OptionError, "juggle.*pick up"),
        ({"nouns": (*STORE_BREAD.nouns, Noun("tap", "fixture", ("open door",)))}, OptionError, "tap"),
        ({"categories": {"loaf": {"group": "stone"}}}, KitchenFileError, "categories of Wrong"),
    ],
)
def test_a_mistake_is_named_at_the_first_reset_at_the_latest(changes: Any, error: Any, message: str) -> None:
    with pytest.raises(error, match=message):
        reset(replace(STORE_BREAD, name="Wrong", **changes))


def test_commands_for_which_a_thing_is_not_made_are_masked() -> None:
    """The vocabulary may speak of doors and switches that a fixture of this kitchen lacks."""
    odd = replace(
        STORE_BREAD,
        name="Odd",
        nouns=(
            Noun("bench", "fixture", ("place to", "open door", "turn on", "pick up")),
            Noun("pantry", "fixture", ("place to", "open door", "turn on")),
            Noun("tap", "fixture", ("turn on", "place to")),
            Noun("bread", "object", ("pick up", "place to", "open door")),
            Noun("tray", "object", ("pick up", "place to")),
        ),
    )
    env = reset(odd)
    told = set(env.vocabulary.commands(env.start.scene))
    wrong = {"open bench door", "turn on bench", "pick up bench", "turn on pantry", "place to tap", "place to bread"}
    assert not told & (wrong | {"open bread door"})
    assert {"place to bench", "open pantry door", "turn on tap", "pick up bread", "place to tray"} <= told
    observations, _ = env.reset(seed=0)
    for token in range(len(env.vocabulary)):
        if env.agents:
            infos = env.step({"robot_0": token, "robot_1": 0})[4]
            legal = bool(observations["robot_0"]["action_mask"][token])
            assert (infos["robot_0"]["outcome"]["reason"] == "invalid") != legal
        env.reset(seed=0)


def test_registering_does_not_change_the_tasks_of_others() -> None:
    before = remac_env.parallel_env("HeatOnStove", backend="symbolic").reset(seed=5)
    reset(STORE_BREAD, 5)
    after = remac_env.parallel_env("HeatOnStove", backend="symbolic").reset(seed=5)
    assert np.array_equal(before[0]["robot_0"]["observation"], after[0]["robot_0"]["observation"])
    assert before[1]["robot_0"] == after[1]["robot_0"]
    assert task_table is remac_env.tasks
