"""Sharing a row of steps out: independent parts side by side, what depends on something after it, nobody in the way."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest
from agent_kitchens import MadeUpKitchen, play
from made_up_tasks import dough, washings

import remac_agents
from remac_agents.plan import Commands, Plan
from remac_agents.planning.teamwork import parts_of, share_out
from remac_env.rules.facts import Rules
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import Subtask


@pytest.mark.parametrize(("lead", "helper"), [("robot_0", "robot_1"), ("robot_1", "robot_0")])
def test_independent_subgoals_are_shared_out(lead: str, helper: str) -> None:
    agent = remac_agents.make("REMAC", lead=lead, helper=helper)
    reports = [play(washings(), agent) for _ in range(3)]
    assert all(report.success for report in reports)
    assert len(reports[2].initial_plan) == 2 and reports[1].final_plan_length >= 19
    assert reports[2].final_plan_length == 11


def steps(kitchen: MadeUpKitchen, *texts: str) -> tuple[Subtask, ...]:
    commands = Commands(kitchen.commands)
    return tuple(commands[text] for text in texts)


WASH = ("navigate to plum", "pick up plum", "navigate to basin", "place to basin", "turn on tap")
OTHER = ("navigate to pear", "pick up pear", "navigate to basin", "place to basin")


def test_a_row_is_cut_where_a_hand_is_empty() -> None:
    row = steps(washings(), *WASH, *OTHER)
    assert [len(part) for part in parts_of(row)] == [5, 4]
    fine = parts_of(row, fine=True)
    assert [part[-1].text for part in fine] == ["place to basin", "turn on tap", "place to basin"]
    assert fine[1][0].text == "navigate to tap"
    assert parts_of(()) == []


def test_places_are_used_in_turn() -> None:
    kitchen = washings()
    plan = share_out(parts_of(steps(kitchen, *WASH, *OTHER)), ("a", "b"), kitchen.scene, places=True)
    assert plan.length == 7
    assert plan.row("a")[-1].text == "navigate aside"
    early = share_out(parts_of(steps(kitchen, *WASH), fine=True), ("a", "b"), kitchen.scene, places=False)
    assert early.length == 4 and [step.text for step in early.row("b")][:2] == ["navigate to tap", "turn on tap"]


def test_what_cannot_be_shared_stays_with_the_first() -> None:
    kitchen = dough()
    row = steps(kitchen, "navigate to dough", "pick up dough", "navigate to furnace", "place to furnace")
    plan = share_out(parts_of(row), ("b", "a"), kitchen.scene, places=True)
    assert plan.row("b") == row and plan.row("a") == ()
    assert share_out([], ("a", "b"), kitchen.scene, places=True).length == 0


def _done(scene: Rules, kitchen: MadeUpKitchen, plan: Plan) -> list[str]:
    """The steps of a plan that fail by the skill table."""
    world = replace(kitchen.start, robots=kitchen.start.robots)
    failed = []
    for index in range(plan.length):
        world, outcomes = transition(scene, world, plan.round(index))
        failed += [f"{index} {robot} {outcome.reason}" for robot, outcome in outcomes.items() if not outcome.success]
    return failed + ([] if kitchen.goal.holds(scene, world) else ["the goal"])


@pytest.mark.parametrize("seed", range(12))
def test_any_order_of_independent_parts_can_be_run_by_the_table(seed: int) -> None:
    """Random orders of the parts, and any robot first: nothing fails, and the names do not matter."""
    kitchen = washings(places={"plum": "bench.0", "pear": "bench.3"})
    kitchen.reset()
    doors = [("navigate to locker", "open locker door"), ("navigate to chest", "open chest door")]
    away = [(*WASH, "pick up plum", "navigate to locker", "place to locker"),
            (*OTHER, "pick up pear", "navigate to chest", "place to chest")]  # fmt: skip
    random.Random(seed).shuffle(doors)
    row = steps(kitchen, *(text for part in (*doors, *away) for text in part))
    plans = [share_out(parts_of(row), robots, kitchen.scene, places=True) for robots in
             (("robot_0", "robot_1"), ("robot_1", "robot_0"))]  # fmt: skip
    assert [_done(kitchen.scene, kitchen, plan) for plan in plans] == [[], []]
    assert plans[0].length == plans[1].length < len(row)
    assert plans[0].row("robot_0") == plans[1].row("robot_1")


def test_many_parts_are_shared_out_one_after_the_other() -> None:
    kitchen = washings()
    doors = ("navigate to locker", "open locker door") * 6 + ("navigate to chest", "open chest door") * 6
    parts = parts_of(steps(kitchen, *doors))
    plan = share_out(parts, ("a", "b", "c"), kitchen.scene, places=True)
    assert len(parts) == 12 and plan.length <= 13
