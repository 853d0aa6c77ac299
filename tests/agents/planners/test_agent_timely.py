"""What takes its time, planned by rule: something else is done meanwhile, and deadlines too short for one are kept."""

from __future__ import annotations

from dataclasses import replace

import pytest
from agent_kitchens import play, suite_kitchen

import remac_agents
from remac_agents.planners.timely import next_step
from remac_env.events.makespan import makespan
from remac_env.generator.templates import load
from remac_env.rules.subtasks import STEP_ASIDE, WAIT, Subtask
from remac_env.state import Place

LAYOUTS = ("one_wall_large", "l_shaped_large", "galley", "u_shaped_large")
SOLVED = {"RinseAndStow": 69.0, "FillAndShelve": 74.0, "FrozenInTime": 53.0, "SupperInTime": 73.0, "FallingDoor": 44.0}
LONGER = ("HeatAndShelve", "MicrowaveAndFill", "HeatBoth", "RinseThenHeat")


def kitchen(task: str, robots: int = 2, layout: str = LAYOUTS[0]):  # type: ignore[no-untyped-def]
    return suite_kitchen(task, robots=robots, clock="events", layout=layout)


def seconds(
    task: str, *, method: str = "REACT", robots: int = 2, layout: str = LAYOUTS[0], seed: int = 1
) -> float | None:
    """The makespan; None where it fails."""
    env = kitchen(task, robots, layout)
    report = play(env, remac_agents.make(method, planner="timely"), seed=seed, most=500)
    assert "planner" in report.truth_readers and report.errors == ()
    return max(span.ended for span in env.timeline) if report.success else None


@pytest.mark.parametrize("task", SOLVED)
def test_two_robots_solve_it(task: str) -> None:
    assert seconds(task) == SOLVED[task]


@pytest.mark.parametrize(("robots", "takes"), [(1, 65.0), (2, 57.0), (3, 56.0)])
def test_a_vessel_goes_where_it_belongs_before_it_is_filled(robots: int, takes: float) -> None:
    """One put the meat into the bowl on the worktop, and in the sink took it out and put it back for ever."""
    assert seconds("DefrostInBowl", robots=robots) == takes


@pytest.mark.long
@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("task", [*SOLVED, *LONGER])
def test_two_robots_solve_it_everywhere(task: str, layout: str) -> None:
    assert seconds(task, layout=layout, seed=2) is not None


def test_who_has_opened_what_falls_shut_stays_until_the_other_comes() -> None:
    env = kitchen("FallingDoor")
    env.reset(seed=1)
    rules, goal = env.start.scene, env.goal
    opened = env.world.with_robot("robot_0", station="cabinet").with_fixture("cabinet", door="open")
    fetched = opened.with_robot("robot_1", station="counter_1", holding="vegetable")
    fetched = fetched.with_object("vegetable", place=Place("held", "robot_1"))
    assert next_step(rules, opened, goal, "robot_0", {}) == WAIT
    assert next_step(rules, fetched, goal, "robot_0", {"robot_1": STEP_ASIDE}) == WAIT, "it is not there yet"
    assert next_step(rules, fetched, goal, "robot_0", {}) == STEP_ASIDE
    assert next_step(rules, fetched, goal, "robot_0", {"robot_1": Subtask("navigate to", "cabinet")}) == STEP_ASIDE
    assert next_step(rules, fetched, goal, "robot_1", {"robot_0": STEP_ASIDE}) == Subtask("navigate to", "cabinet")
    assert next_step(rules, fetched, goal, "robot_1", {"robot_0": Subtask("open door", "cabinet")}) == STEP_ASIDE
    stays_open = replace(rules, processes=())
    assert next_step(stays_open, opened, goal, "robot_0", {}) == Subtask("navigate to", "vegetable")


@pytest.mark.long
@pytest.mark.parametrize("template", [n for n, each in load().items() if each.team and "falling" in each.team.kind])
def test_what_falls_shut_at_once_is_passed_from_one_to_the_other(template: str) -> None:
    made = {"grade": 1, "template": template, "clock": "events", "max_seconds": 600.0}
    env = suite_kitchen("Generated", **made)
    report = play(env, remac_agents.make("REACT", planner="timely"), seed=1, most=500)
    assert report.success and env.timeline[-1].ended == 44.0


def test_a_robot_alone_is_back_before_it_runs_over() -> None:
    """It fetched the fish first, and stood there with it when the bowl was full.

    A plan goes by the table's seconds; who is asked for each command reckons with those of physics.
    """
    assert seconds("FillAndShelve", method="CC", robots=1) == 99.0
    assert seconds("FillAndShelve", robots=1) == 112.0


def test_one_robot_plans_as_if_nothing_happened_where_it_cannot_keep_a_door_open() -> None:
    env = kitchen("FallingDoor", robots=1)
    plan = play(env, remac_agents.make("CC", planner="timely"), seed=1, most=500).initial_plan["robot_0"]
    there = "navigate to cabinet"
    fetched = ["navigate to vegetable", "pick up vegetable"]
    assert sorted(plan) == sorted([there, "open cabinet door", *fetched, there, "place to cabinet"])


def test_something_else_is_done_meanwhile() -> None:
    env = kitchen("RinseAndStow", robots=1)
    assert play(env, remac_agents.make("REACT", planner="timely"), seed=1, most=500).success
    (rinsing,) = (span for span in env.timeline if span.kind == "process" and span.what == "rinsing")
    meanwhile = [s.what for s in env.timeline if s.kind == "subtask" and rinsing.began <= s.began < rinsing.ended]
    assert any("fish" in what or "microwave" in what for what in meanwhile)


def test_a_plan_in_rounds_has_waits() -> None:
    assert seconds("RinseAndStow", method="CC", robots=1) == 99.0
    env = kitchen("FillAndShelve")
    report = play(env, remac_agents.make("CC", planner="timely"), seed=1, most=500)
    assert report.success and "wait" in report.initial_plan["robot_1"] + report.initial_plan["robot_0"]


def test_nobody_goes_where_another_goes_or_takes_what_another_takes() -> None:
    env = kitchen("SupperInTime")
    env.reset(seed=1)
    rules, world, goal = env.start.scene, env.world, env.goal
    first = next_step(rules, world, goal, "robot_0", {})
    assert first != WAIT and next_step(rules, world, goal, "robot_1", {"robot_0": first}) not in (first, WAIT)
    busy = {"robot_0": Subtask("pick up", "fish")}
    assert next_step(rules, world, goal, "robot_1", busy).target not in ("fish", "cabinet")


@pytest.mark.parametrize(("task", "layout"), [
    pytest.param(task, layout, marks=() if (task, layout) == ("SupperInTime", "galley") else pytest.mark.long)
    for task in ("SupperInTime", "FallingDoor", "FrozenInTime") for layout in LAYOUTS
])  # fmt: skip
def test_one_robot_cannot_do_it_in_time(task: str, layout: str) -> None:
    """All that one robot can do is looked at. Two do it: above."""
    env = kitchen(task, 1, layout)
    env.reset(seed=1)
    alone = makespan(env.start, env.goal, deadline=env.max_seconds, max_states=60_000)
    assert (alone.proof, alone.plan) == ("exhausted", ())
