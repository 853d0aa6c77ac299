"""Goals judge, count and lose."""

from __future__ import annotations

import pytest
from table_kitchen import A, B, TableKitchen

import remac_env
from remac_env.oracle import solve
from remac_env.state import FLOOR
from remac_env.tasks import get
from remac_env.tasks.goals import All, DoorIs, Inside, Marked, Released, SwitchedOn, lost, progress

NAMES = {"food": "vegetable", "vessel": "pan", "plate": "plate"}


@pytest.fixture
def kitchen() -> TableKitchen:
    return TableKitchen()


def holds(kitchen: TableKitchen, goal: All | Inside | Released | SwitchedOn | DoorIs | Marked) -> bool:
    return goal.holds(kitchen.scene, kitchen.world)


def test_inside_is_transitive_and_minds_what_is_between(kitchen: TableKitchen) -> None:
    kitchen.put("vegetable", "plate")
    assert holds(kitchen, Inside("vegetable", "cabinet"))
    assert holds(kitchen, Inside("vegetable", "cabinet", only_on=("plate",)))
    assert not holds(kitchen, Inside("vegetable", "cabinet", only_on=()))
    assert holds(kitchen, Inside("vegetable", "cabinet.0"))
    assert not holds(kitchen, Inside("vegetable", "microwave"))


@pytest.mark.parametrize("robot", [A, B])
def test_released_asks_every_robot(kitchen: TableKitchen, robot: str) -> None:
    kitchen.hold(robot, "vegetable")
    assert not holds(kitchen, Released("vegetable"))
    assert holds(kitchen, Released("pan"))


def test_switched_on_under_a_thing(kitchen: TableKitchen) -> None:
    kitchen.put("pan", "stove.1").on("stove", "stove.0")
    assert holds(kitchen, SwitchedOn("stove"))
    assert not holds(kitchen, SwitchedOn("stove", under="pan"))
    assert holds(kitchen.on("stove", "stove.1"), SwitchedOn("stove", under="pan"))


def test_marks_and_doors(kitchen: TableKitchen) -> None:
    kitchen.stand(A, "counter_mid").hold(A, "seasoning").run(**{A: "season vegetable"})
    assert holds(kitchen, Marked("vegetable", "seasoned")) and not holds(kitchen, Marked("fish", "seasoned"))
    assert holds(kitchen, DoorIs("cabinet", "closed")) and not holds(kitchen, DoorIs("cabinet", "open"))


def test_progress_is_the_share_of_the_parts(kitchen: TableKitchen) -> None:
    goal = get("HeatOnStove").goal.bind(NAMES)
    assert progress(goal, kitchen.scene, kitchen.world) == 2 / 5
    kitchen.put("pan", "stove.0").on("stove", "stove.0")
    assert progress(goal, kitchen.scene, kitchen.world) == 4 / 5
    kitchen.put("vegetable", "pan")
    assert progress(goal, kitchen.scene, kitchen.world) == 1.0
    assert holds(kitchen, goal)  # type: ignore[arg-type]


def test_lost_when_something_the_goal_needs_is_on_the_floor(kitchen: TableKitchen) -> None:
    goal = get("HeatOnStove").goal.bind(NAMES)
    assert not lost(goal, kitchen.scene, kitchen.world)
    assert not lost(goal, kitchen.scene, kitchen.hold(A, "pan").world)
    assert not lost(goal, kitchen.scene, kitchen.world.with_object("fish", place=FLOOR))
    assert lost(goal, kitchen.scene, kitchen.put("vegetable", "bowl").world.with_object("bowl", place=FLOOR))
    assert lost(goal, kitchen.scene, kitchen.world.with_object("pan", place=FLOOR))


def test_binding_fills_every_field() -> None:
    goal = All(Inside("{food}", "cabinet", only_on=("{plate}", "shelf")), Released("{food}")).bind(NAMES)
    assert next(goal.atoms()) == Inside("vegetable", "cabinet", only_on=("plate", "shelf"))
    assert goal.names() == ("vegetable", "cabinet")
    assert goal.text == "the vegetable is on or in the cabinet and no robot holds the vegetable"


def test_a_lost_goal_ends_the_episode_for_all_robots() -> None:
    env = remac_env.parallel_env("OpenCabinetPnP", backend="symbolic")
    _, infos = env.reset(seed=0)
    spot = "vegetable"
    steps = [
        {"robot_0": f"navigate to {spot}", "robot_1": "wait"},
        {"robot_0": f"pick up {spot}", "robot_1": "wait"},
        {"robot_0": "navigate to cabinet", "robot_1": "wait"},
        {"robot_0": "open cabinet door", "robot_1": "wait"},
    ]
    for step in steps:
        assert env.agents == ["robot_0", "robot_1"]
        answer = env.step({robot: env.vocabulary.encode(text) for robot, text in step.items()})
    _, rewards, terminations, truncations, infos = answer
    assert set(terminations.values()) == {True} and set(truncations.values()) == {False}
    assert set(rewards.values()) == {0.0} and env.agents == []
    assert infos["robot_1"]["end"] == "lost" and infos["robot_0"]["outcome"]["reason"] == "dropped"
    assert solve(env.start.scene, env.world, env.goal) is None
