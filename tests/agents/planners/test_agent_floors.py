"""The floors: what reads the goal with common sense, what knows plans by heart, and that neither looks at anything."""

from __future__ import annotations

from typing import Any

import pytest

import remac_agents
import remac_env
from remac_agents.planners.memorised import pattern, templated

TASKS = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove")


def played(task: str, planner: str, seeds: range, **options: Any) -> list[Any]:
    """The reports of BASE with this planner, one a seed."""
    env = remac_env.parallel_env(task, robots=1, backend="symbolic", **options)
    reports = []
    for seed in seeds:
        agent = remac_agents.make("BASE", planner=planner)
        observations, infos = env.reset(seed=seed)
        agent.reset(observations, infos)
        while env.agents:
            observations, _, _, _, infos = env.step(agent.act(observations, infos))
        agent.close_episode(observations, infos)
        reports.append(agent.report())
    return reports


@pytest.mark.parametrize(("task", "length"), list(zip(TASKS, (6, 6, 9, 9), strict=True)))
def test_common_sense_solves_every_paper_start_at_once_and_shortest(task: str, length: int) -> None:
    reports = played(task, "reader", range(6))
    assert all(report.success and report.initial_plan_length == length for report in reports)
    assert not any(report.truth_readers and "planner" in report.truth_readers for report in reports)


def test_common_sense_is_not_enough_where_starts_differ() -> None:
    won = [report.success for task in TASKS for report in played(task, "reader", range(10), starts="mixed")]
    assert 0 < sum(won) < len(won)


def test_plans_known_by_heart_solve_many_starts_and_not_all() -> None:
    won = [report.success for task in TASKS for report in played(task, "memorised", range(8), starts="mixed")]
    assert 0.5 * len(won) < sum(won) < len(won)


def test_a_goal_that_was_not_learnt_gets_no_plan() -> None:
    (report,) = played("HeatOnStove", "memorised", range(1), naming="category")
    assert report.initial_plan_length > 0  # the sentence is the same; the nouns of this kitchen are not
    sentence = "place the {food} into the cabinet"
    assert pattern(sentence).match("place the sweet potato into the cabinet").groupdict() == {"food": "sweet potato"}
    assert pattern(sentence).match("place the vegetable into the fridge") is None
    row = ["pick up fish", "navigate to fishbowl"]
    assert templated(row, {"food": "fish"}) == ["pick up {food}", "navigate to fishbowl"]
