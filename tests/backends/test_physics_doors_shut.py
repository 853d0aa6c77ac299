"""Every skill that reaches for what stands behind a door takes an open one, whatever kind of place that is."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from remac_env.backends.physics.controllers.scripted.dispatch import motion
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.fixtures import FixtureReading
from remac_env.rules.subtasks import Subtask
from remac_env.state import FrozenMap, ObjectState, Place, WorldState

LAYOUT = layouts.load("rich_one_wall")
SLOTS = [slot for slot in LAYOUT.slots.values() if LAYOUT.fixtures[slot.fixture].door_panels]


def test_there_are_doors_before_slots_of_more_than_one_kind() -> None:
    assert len({slot.kind for slot in SLOTS}) > 1


@pytest.mark.parametrize("skill", ["pick up", "place to", "season"])
@pytest.mark.parametrize("slot", SLOTS, ids=lambda slot: slot.name)
def test_an_ajar_door_is_not_open(slot: Any, skill: str) -> None:
    world = WorldState(FrozenMap({}), FrozenMap({"apple": ObjectState(Place("slot", slot.name))}), FrozenMap({}))
    reading = FixtureReading(door_angles=(0.28,))
    here = SimpleNamespace(
        kitchen=SimpleNamespace(layout=LAYOUT), hand=SimpleNamespace(body="seasoning"),
        sensed=SimpleNamespace(reading=lambda name: reading),
    )  # fmt: skip
    rules = cast(Any, SimpleNamespace(fixtures={}))
    with pytest.raises(SkillFailure, match="0.28") as failed:
        next(motion(cast(Workspace, here), rules, world, "robot_0", Subtask(skill, "apple")))
    assert failed.value.reason == "door_closed"
