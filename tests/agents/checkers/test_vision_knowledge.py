"""What the rules say of knowledge from what is seen: it is right, or it cannot tell."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from agent_kitchens import suite_kitchen

from remac_agents.checkers.knowledge import all_of, any_of, ruled
from remac_env.rules.conditions import Condition, condition
from remac_env.rules.facts import Rules
from remac_env.state import Place, WorldState

ROBOT = "robot_0"


def kitchen(task: str) -> tuple[Rules, WorldState]:
    env = suite_kitchen(task, robots=2)
    env.reset(seed=3)
    return env.start.scene, env.start.world


def with_held(world: WorldState, held: str, station: str) -> WorldState:
    return world.with_robot(ROBOT, holding=held, station=station).with_object(held, place=Place("held", ROBOT))


def judged(asked: Condition, rules: Rules, world: WorldState, hidden: Any = ()) -> bool | None:
    holding = {name: state.holding for name, state in world.robots.items()}
    return ruled(asked, rules, holding, lambda c: None if c in hidden else c.holds(rules, world))


@pytest.mark.parametrize(("task", "held", "vessel", "target"), [
    ("DefrostInBowl", "meat", "bowl", "sink"), ("HeatOnStove", "vegetable", "pan", "stove"),
])  # fmt: skip
def test_what_must_not_touch_a_fixture_needs_the_vessel_that_is_not_there(
    task: str, held: str, vessel: str, target: str
) -> None:
    rules, world = kitchen(task)
    held = held if held in rules.objects else next(n for n, o in rules.objects.items() if target in o.needs_vessel_in)
    asked, there = condition("no_vessel_needed", ROBOT, target), condition("inside", vessel, target)
    world = with_held(world, held, target)
    assert judged(asked, rules, world) is False is asked.holds(rules, world)
    assert judged(asked, rules, world, hidden=(there,)) in (None, False)
    others = [condition("inside", name, target) for name in rules.objects if name != vessel]
    assert judged(asked, rules, world, hidden=others) is False, "nothing else can be its vessel"
    assert judged(condition("no_vessel_needed", ROBOT, "counter"), rules, world) is True
    assert judged(condition("no_vessel_needed", ROBOT, vessel), rules, world) is True
    slot = rules.fixtures[target].slots[0]
    placed = world.with_object(vessel, place=Place("slot", slot))
    if len(rules.fixtures[target].slots) == 1:
        assert judged(asked, rules, placed) is True is asked.holds(rules, placed)
        assert judged(asked, rules, placed, hidden=(there,)) is None, "the bowl may be there, and nobody sees it"
    else:
        assert judged(asked, rules, placed) is False is asked.holds(rules, placed), "other burners are free"


def test_a_verdict_is_the_truth_whatever_is_seen_and_by_whomever() -> None:
    """Random worlds in which a share of the conditions is hidden: it cannot tell, or it is right."""
    chance, said = np.random.default_rng(5), 0
    for task in ("DefrostInBowl", "HeatOnStove", "OpenMicrowavePnP"):
        rules, world = kitchen(task)
        names = list(rules.objects)
        for _ in range(60):
            now, slots = world, [str(slot) for slot in chance.permutation(list(rules.slots))]
            for name, slot in zip(names, slots, strict=False):
                now = now.with_object(name, place=Place("slot", slot))
            thing = str(chance.choice(names))
            target = str(chance.choice([name for name, facts in rules.fixtures.items() if facts.slots]))
            station = str(chance.choice(rules.stations_of(target)))
            inner, outer = (str(name) for name in chance.permutation(names)[:2])
            if rules.objects[outer].holds and rules.objects[inner].small:
                now = now.with_object(inner, place=Place("vessel", outer))
            placed = [condition("graspable", name) for name in names]
            if not any(item.place == Place("vessel", thing) for item in now.objects.values()):
                now = with_held(now, thing, station)
                placed = [condition("graspable", name) for name in names if name != thing]
            holding = {name: state.holding for name, state in now.robots.items()}

            def look(asked: Condition, now: WorldState = now, rules: Rules = rules) -> bool | None:
                return None if chance.random() < 0.2 else asked.holds(rules, now)

            for asked in (condition("no_vessel_needed", ROBOT, target), *placed):
                found = ruled(asked, rules, holding, look)
                assert found in (None, asked.holds(rules, now)), (asked, now)
                said += found is not None
    assert said > 600


def test_where_there_is_no_rule_or_nobody_feels_the_gripper_it_cannot_tell() -> None:
    rules, world = kitchen("DefrostInBowl")
    assert judged(condition("door_open", "microwave"), rules, world) is None
    assert ruled(condition("no_vessel_needed", ROBOT, "sink"), rules, {}, lambda asked: True) is None


def test_answers_of_three_values() -> None:
    for answers in itertools.product((True, False, None), repeat=3):
        assert any_of(answers) is (True if True in answers else None if None in answers else False)
        assert all_of(answers) is (False if False in answers else None if None in answers else True)
    assert any_of(()) is False and all_of(()) is True
