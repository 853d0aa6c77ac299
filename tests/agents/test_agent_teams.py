"""REMAC with three robots: mastered alone, then shared out among all; every method plays with teams."""

from __future__ import annotations

import pytest
from agent_kitchens import play, suite_kitchen

import remac_agents


@pytest.mark.parametrize(("handover", "task"), [("reflections", "WashPnPHeat"), ("search", "OpenMicrowavePnP")])
def test_what_one_robot_has_mastered_is_shared_among_three(handover: str, task: str) -> None:
    env = suite_kitchen(task, robots=3)
    agent = remac_agents.make("REMAC", handover=handover, lead="robot_1", helper="robot_2")
    reports = [play(env, agent, seed=1) for _ in range(5)]
    assert all(report.success for report in reports[1:])
    assert {len(report.initial_plan) for report in reports[:1]} == {1}, "mastered alone"
    team = next(report for report in reports if len(report.initial_plan) > 1)
    assert set(team.initial_plan) <= {"robot_0", "robot_1", "robot_2"}
    assert team.final_plan_length <= reports[0].final_plan_length


@pytest.mark.parametrize("robots", [2, 3])
def test_the_searching_hand_over_leaves_out_no_washing(robots: int) -> None:
    """The vegetable stands in the pan as well unwashed: what has happened to it belongs to the end."""
    env, agent = suite_kitchen("WashPnPHeat", robots=robots), remac_agents.make("REMAC", handover="search")
    reports = [play(env, agent, seed=1) for _ in range(4)]
    assert all(report.success for report in reports)
    assert {(len(report.initial_plan), report.final_plan_length) for report in reports[2:]} == {(robots, 9)}


@pytest.mark.parametrize("method", ["BASE", "CC", "RE", "REFLECT", "CAPE", "SMART-LLM"])
def test_every_method_plays_with_four(method: str) -> None:
    report = play(suite_kitchen("OpenCabinetPnP", robots=4), remac_agents.make(method))
    assert report.method == method and not report.errors
