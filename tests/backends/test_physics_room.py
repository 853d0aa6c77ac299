"""Room and grasps are found by trying: where the table lies, physics does what can be done, and the twin tells it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest
import twin
from physics_kit import ROBOT, kitchen
from physics_kit import run as told
from test_physics_backend import make_start, run

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.scripted.room import forbidden, lies_in_dish, seen_on_slots
from remac_env.backends.physics.perception import Error
from remac_env.kitchen.objects import add_object, catalogue
from remac_env.kitchen.objects.catalogue import EDIBLE
from remac_env.kitchen.worlds import Worlds
from remac_env.rules.subtasks import Subtask
from remac_env.start import Offset, Start
from remac_env.state import Place

KITCHEN = make_start(
    {
        "butter": ("butter", Place("slot", "microwave.0")), "bowl": ("bowl", Place("slot", "counter.0")),
        "egg": ("egg", Place("slot", "counter.1")),
    },
    doors={"microwave": 1.45},
)  # fmt: skip
KITCHEN = replace(KITCHEN, offsets=KITCHEN.offsets | {"butter": Offset(0.048, -0.098, 1.9)})  # where hands get at it
EGG = ("navigate to", "egg"), ("pick up", "egg")


def lying(start: Start, **facts: Mapping[str, Any]) -> Start:
    """The start with other facts about objects (noun -> fields) than those of their categories."""
    scene = start.scene
    objects = scene.objects
    for noun, fields in facts.items():
        objects = objects.with_(noun, replace(objects[noun], **fields))
    return replace(start, scene=replace(scene, objects=objects))


def last(start: Start, *commands: tuple[str, str]) -> twin.Compared:
    """Run commands, all but the last of which succeed; the twin's line on the last."""
    backend = PhysicsBackend()
    backend.reset(start)
    assert run(backend, *commands[:-1]) == [None] * (len(commands) - 1)
    before, joint = backend.world, {ROBOT: Subtask(*commands[-1])}
    outcomes = backend.run_round(joint).outcomes
    worlds = SimpleNamespace(categories=Worlds().categories, spec=SimpleNamespace(name="Chain"))
    (line,) = twin.compare(SimpleNamespace(worlds=worlds, start=start, world=backend.world), before, joint, outcomes)
    return line


@pytest.mark.parametrize(
    ("lies", "commands", "foretold", "happened"),
    [
        ({"butter": {"too_big_for": frozenset({"microwave"})}},
         [("navigate to", "microwave"), ("pick up", "butter")], "blocked", "success"),
        ({"egg": {"small": False}}, [*EGG, ("navigate to", "bowl"), ("place to", "bowl")], "blocked", "success"),
        ({"bowl": {"holds": 0}}, [*EGG, ("navigate to", "bowl"), ("place to", "bowl")], "blocked", "success"),
    ],
    ids=["graspable", "small", "holds"],
)  # fmt: skip
def test_a_table_that_forbids_what_can_be_done_is_found_out(lies, commands, foretold: str, happened: str) -> None:
    line = last(lying(KITCHEN, **lies), *commands)
    assert (line.foretold, line.happened, line.verdict) == (foretold, happened, "disagree")
    assert not line.by_rule


def test_a_table_that_promises_room_where_there_is_none_is_found_out() -> None:
    start = make_start(
        {
            "lemon": ("lemon", Place("vessel", "bowl")), "bowl": ("bowl", Place("slot", "counter.0")),
            "egg": ("egg", Place("slot", "counter.1")),
        }
    )  # fmt: skip
    commands = *EGG, ("navigate to", "bowl"), ("place to", "bowl")
    line = last(lying(start, bowl={"holds": 2}), *commands)
    assert (line.foretold, line.happened, line.verdict) == ("success", "blocked", "disagree")
    line = last(start, *commands)
    assert (line.foretold, line.happened, line.verdict, line.by_rule) == ("blocked", "blocked", "agree", False)


def test_a_full_fixture_is_seen_to_be_full() -> None:
    line = last(KITCHEN, *EGG, ("navigate to", "microwave"), ("place to", "microwave"))
    assert (line.foretold, line.happened, line.verdict, line.by_rule) == ("blocked", "blocked", "agree", False)


def test_what_lies_in_a_dish_is_measured() -> None:
    """Every kind of food, by its colliders; what the catalogue says of it comes to the same."""
    food = {name: kind for name, kind in catalogue.load().items() if kind.group in EDIBLE}
    spec = mujoco.MjSpec()
    for name, kind in food.items():
        add_object(spec, spec.worldbody, name, kind, visual=False)
    model = spec.compile()
    bodies = {name: model.body(name) for name in food}
    geoms = {name: range(int(b.geomadr[0]), int(b.geomadr[0] + b.geomnum[0])) for name, b in bodies.items()}
    here: Any = SimpleNamespace(sensed=SimpleNamespace(model=model, geoms=geoms.get))
    assert {name: lies_in_dish(here, name) for name in food} == {name: kind.small for name, kind in food.items()}
    assert {kind.small for kind in food.values()} == {True, False}


def test_what_is_forbidden_is_a_rule_of_the_robots_own() -> None:
    bowl, bottle, potato = (catalogue.get(name) for name in ("bowl", "bottle", "potato"))
    assert forbidden(bottle, "microwave", None) and not forbidden(bottle, "counter", None)
    assert forbidden(bottle, "counter", bowl) and not forbidden(potato, "counter", bowl)
    assert forbidden(potato, "cabinet", bowl), "too deep for a hand in there"


def test_slots_are_free_or_taken_as_they_seem() -> None:
    backend, start, worlds = kitchen({"mug": "counter", "bowl": "counter"}, 120510)
    assert told(backend, worlds, ["wait"]) == [None]
    here = backend._begun()._team.robots[ROBOT]
    places = {name: item.place.where for name, item in start.world.objects.items()}
    assert seen_on_slots(here) == {slot: [name] for name, slot in places.items()}
    away = np.array([0.0, 0.0, 1.0])
    here.sensed.senses.perception.objects["mug"] = Error(away, 0.0, np.zeros(3))
    assert seen_on_slots(here) == {places["bowl"]: ["bowl"]}
    # Where the fixture seems to be off by as much, the object still seems to stand on it.
    for name in ("mug", "bowl"):
        here.sensed.senses.perception.objects[name] = Error(away, 0.0, np.zeros(3))
    for name in here.kitchen.layout.fixtures:
        here.sensed.senses.perception.fixtures[name] = Error(away, 0.0, np.zeros(3))
    assert seen_on_slots(here) == {slot: [name] for name, slot in places.items()}
