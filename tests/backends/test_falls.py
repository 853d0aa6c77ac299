"""Nothing falls without an outcome: who carried it answers for it."""

from __future__ import annotations

from typing import Any

import pytest
from physics_kit import ROBOT, command, kitchen, run

from remac_env.backends.physics.controllers.scripted import controller
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure, Steps
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.falls import fallen
from remac_env.backends.physics.simulation import CONTROL_PERIOD
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.scene import build_scene, resting_fixtures
from remac_env.rules.facts import Rules
from remac_env.rules.subtasks import Subtask
from remac_env.state import FLOOR, FrozenMap, ObjectState, Place, RobotState, WorldState

A, B = "robot_0", "robot_1"


@pytest.fixture(scope="module")
def scene() -> Rules:
    things = {noun: catalogue.get(noun) for noun in ("carrot", "bowl", "mug")}
    return build_scene(layouts.load("one_wall_large"), things, (A, B))


def world(scene: Rules, **places: Place) -> WorldState:
    """Robots aside and objects in these places; what a place says is held is held."""
    objects = {"carrot": Place("slot", "counter.1"), "bowl": Place("slot", "counter.2"), "mug": Place("slot", "sink.0")}
    objects.update(places)
    held = {place.where: name for name, place in objects.items() if place.relation == "held"}
    robots = {name: RobotState(holding=held.get(name)) for name in (A, B)}
    states = {name: ObjectState(place) for name, place in objects.items()}
    return WorldState(FrozenMap(robots), FrozenMap(states), resting_fixtures(scene))


HELD_A, IN_BOWL = Place("held", A), Place("vessel", "bowl")
DRIVE, WAIT = Subtask("navigate to", "sink"), Subtask("wait")


@pytest.mark.parametrize(
    ("before", "after", "subtasks", "answers"),
    [
        ({"carrot": HELD_A}, {"carrot": FLOOR}, {A: DRIVE, B: DRIVE}, [("carrot", (A,))]),
        ({"bowl": HELD_A, "carrot": IN_BOWL}, {"bowl": HELD_A, "carrot": FLOOR}, {A: DRIVE, B: WAIT},
         [("carrot", (A,))]),
        ({"carrot": IN_BOWL}, {"bowl": HELD_A}, {A: Subtask("pick up", "bowl"), B: WAIT}, [("carrot", (A,))]),
        ({"carrot": IN_BOWL}, {"carrot": HELD_A}, {A: Subtask("pick up", "carrot"), B: WAIT}, []),
        ({"carrot": IN_BOWL}, {"carrot": FLOOR}, {A: Subtask("pick up", "carrot"), B: WAIT}, [("carrot", (A,))]),
        ({"bowl": HELD_A, "carrot": IN_BOWL}, {"bowl": Place("slot", "sink.0"), "carrot": IN_BOWL},
         {A: Subtask("place to", "sink"), B: WAIT}, []),
        ({}, {"mug": FLOOR}, {A: DRIVE, B: WAIT}, [("mug", (A,))]),
        ({}, {"mug": FLOOR}, {A: DRIVE, B: Subtask("navigate to", "carrot")}, [("mug", (A, B))]),
        ({"mug": FLOOR}, {"mug": FLOOR}, {A: DRIVE, B: WAIT}, []),
    ],
)  # fmt: skip
def test_who_answers(
    scene: Rules, before: dict[str, Place], after: dict[str, Place], subtasks: dict[str, Subtask], answers: list[object]
) -> None:
    assert list(fallen(scene, world(scene, **before), world(scene, **after), subtasks)) == answers


def test_what_is_knocked_out_of_a_hand_on_the_way_is_dropped() -> None:
    backend, _, worlds = kitchen({"mug": "counter"}, 120700)
    assert run(backend, worlds, ["navigate to mug", "pick up mug"]) == [None, None]
    mug = backend.model.body("mug").id
    ticks = 0

    def pull() -> None:
        nonlocal ticks
        ticks += 1
        backend.data.xfrc_applied[mug, 2] = -60.0 if 10 < ticks < 20 else 0.0

    backend.watch = pull
    result = backend.run_round({ROBOT: command(worlds, "navigate to sink")})
    assert result.outcomes[ROBOT].reason == "dropped"
    assert result.outcomes[ROBOT].seconds == result.seconds > 20 * CONTROL_PERIOD
    assert backend.world.objects["mug"].place == FLOOR
    assert backend.world.robots[ROBOT].holding is None


def test_a_drive_that_loses_nothing_succeeds() -> None:
    backend, _, worlds = kitchen({"mug": "counter"}, 120700)
    assert run(backend, worlds, ["navigate to mug", "pick up mug", "navigate to sink"]) == [None] * 3


def test_a_skill_that_only_says_that_it_took_something_slipped_and_took_its_time(monkeypatch) -> None:
    backend, _, worlds = kitchen({"mug": "counter"}, 120700)
    assert run(backend, worlds, ["navigate to mug"]) == [None]

    def idle(here: Workspace, *_: Any) -> Steps:
        yield from [here.robot.command] * 10

    def fails(here: Workspace, *_: Any) -> Steps:
        yield from [here.robot.command] * 10
        raise SkillFailure("slipped", "it says so itself")

    for motion in (idle, fails):
        monkeypatch.setattr(controller, "motion", motion)
        result = backend.run_round({ROBOT: command(worlds, "pick up mug")})
        assert result.outcomes[ROBOT].reason == "slipped"
        assert result.outcomes[ROBOT].seconds == result.seconds == pytest.approx(10 * CONTROL_PERIOD)
