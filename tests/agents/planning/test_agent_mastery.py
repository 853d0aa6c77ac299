"""When a task counts as mastered by one robot, with which plan, and that false alarms do not put it off for ever."""

from __future__ import annotations

from typing import Any

import pytest
from agent_kitchens import play, suite_kitchen
from made_up_tasks import towels

import remac_agents
from remac_agents.memory import Run
from remac_agents.plan import Commands
from remac_agents.planning.mastery import proven_plan, without_detours
from remac_env.errors import OptionError

TASKS = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove")
FACTS = towels().scene
COMMANDS = Commands(towels().commands)
OPENED = ("navigate to dryer", "open dryer door")
FETCHED = ("navigate to towel", "pick up towel", "navigate to dryer", "place to dryer")
RESTED = ("navigate to bench", "place to bench", "navigate to towel", "pick up towel", "navigate to dryer")


def run(planned: tuple[str, ...], played: tuple[str, ...], *, success: bool = True, **changes: Any) -> Run:
    """A run by one robot; a command that failed ends with "!"."""
    entries = [f"a: {c.removesuffix('!')} ({'failure' if c.endswith('!') else 'success'})" for c in played]
    checks = [] if planned == played else [{"verdict": False}]
    told = {"initial_plan": {"a": list(planned)}, "action_list": entries, "pre_check_results": checks, **changes}
    return Run(
        **{
            "task_description": "T",
            "task_goal": "t",
            "post_check_results": [],
            "success": success,
            "reflection": [],
            **told,
        }
    )


def proven(*runs: Run, last: bool = False) -> tuple[str, ...] | None:
    found = proven_plan(runs, COMMANDS, FACTS, last=last)
    return None if found is None else tuple(step.text for step in found)


PLAN = (*OPENED, *FETCHED)


def test_a_plan_that_worked_as_it_was_is_proven() -> None:
    assert proven(run(PLAN, PLAN)) == PLAN
    assert proven() is None and proven(run(PLAN, PLAN, success=False)) is None


def test_steps_that_came_to_nothing_do_not_count() -> None:
    alarmed = (*OPENED, *FETCHED[:3], *RESTED[:2], "navigate to dryer", "open dryer door!", *RESTED[2:], FETCHED[3])
    assert proven(run(PLAN, alarmed)) == PLAN
    assert proven(run(PLAN, (*alarmed[:2], "open dryer door!", *alarmed[2:]))) == PLAN


def test_a_plan_that_needed_more_than_was_planned_is_no_mastery_yet() -> None:
    mended = (*FETCHED[:3], *RESTED[:2], *OPENED, *RESTED[2:], FETCHED[3])
    short = run(FETCHED, mended)
    assert proven(short) is None
    assert proven(short, last=True) == PLAN, "what the plan had fetched too early is fetched once"
    assert proven(short, short) == PLAN, "nothing is learnt any more"
    assert proven(short, run(PLAN, PLAN, success=False), last=True) == PLAN
    assert proven(run(FETCHED, mended, success=False), last=True) is None


def test_what_made_other_work_possible_stays() -> None:
    """The soap was moved because it was in the way: the plan itself had it later."""
    dryer = ("navigate to dryer", "place to dryer")
    steps = ("navigate to soap", "pick up soap", "navigate to bench", "place to bench", "navigate to towel",
             "pick up towel", *dryer, "navigate to soap", "pick up soap", *dryer)  # fmt: skip
    planned = (*steps[4:],)
    read = tuple(COMMANDS[text] for text in steps)
    assert without_detours(read, FACTS, tuple(COMMANDS[text] for text in planned)) == read
    early = without_detours(read, FACTS, read)
    assert [step.text for step in early] == list(planned)


def test_a_shorter_plan_that_was_tried_in_vain_is_dropped() -> None:
    """What looked like a fetch too early was needed: the plan without it came out longer."""
    mended = (*FETCHED[:3], *RESTED[:2], *OPENED, *RESTED[2:], FETCHED[3])
    longer = ("navigate to soap", "pick up soap", "navigate to bench", "place to bench", *PLAN)
    assert proven(run(FETCHED, mended), run(PLAN, longer), last=True) == longer
    assert proven(run(FETCHED, mended), run(PLAN, longer)) is None


def test_a_failed_team_takes_mastery_away() -> None:
    team = run(PLAN, PLAN, success=False, initial_plan={"a": list(PLAN), "b": []})
    assert proven(run(PLAN, PLAN), team, last=True) is None
    assert proven(run(PLAN, PLAN), team, run(PLAN, PLAN)) == PLAN
    assert proven(run(("fly",), ("fly",))) is None


def test_the_team_forms_by_the_last_iteration_whatever_the_checker_cries() -> None:
    noisy = {"name": "noisy", "false_alarm": 0.05, "miss": 0.05}
    formed = worked = 0
    for task in TASKS:
        env = suite_kitchen(task)
        for seed in range(3):
            agent = remac_agents.make("REMAC", checker=noisy, iterations=2)
            reports = [play(env, agent, seed=seed) for _ in range(3)]
            assert len(reports[2].initial_plan) == 2 or not any(r.success for r in reports[:2])
            formed += len(reports[2].initial_plan) == 2
            worked += reports[2].success
    assert formed >= 11 and worked >= 11


def test_without_a_known_end_the_team_waits_for_mastery() -> None:
    env = suite_kitchen("HeatOnStove")
    for iterations, robots in ((None, [1, 1]), (1, [1, 2]), (5, [1, 1])):
        agent = remac_agents.make("REMAC", iterations=iterations)
        reports = [play(env, agent) for _ in range(2)]
        assert [len(report.initial_plan) for report in reports] == robots
        assert all(report.success for report in reports)
    with pytest.raises(OptionError, match="iterations -1"):
        remac_agents.make("REMAC", iterations=-1)


def test_a_run_in_which_nothing_succeeded_leaves_an_empty_plan() -> None:
    assert without_detours((), FACTS, ()) == ()
