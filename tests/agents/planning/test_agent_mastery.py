"""When a task counts as mastered by one robot, with which plan, and that false alarms do not put it off for ever."""

from __future__ import annotations

from typing import Any

import pytest
from agent_kitchens import play, suite_kitchen
from made_up_tasks import towels

import remac_agents
import remac_env
from remac_agents.memory import Run
from remac_agents.plan import Commands
from remac_agents.planning.mastery import late_plan, proven_plan, unaided_plan, unkept_plan, without_detours
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


def late(*runs: Run) -> tuple[str, ...] | None:
    found = late_plan(runs, COMMANDS)
    return None if found is None else tuple(step.text for step in found)


def cut(*played: str, **changes: Any) -> Run:
    """A run of the plan at whose end the time was up."""
    return run(PLAN, played, success=False, **{"pre_check_results": [], **changes})


def test_a_plan_that_is_cut_short_by_the_time_alone_is_late() -> None:
    team = {"initial_plan": {"a": list(OPENED), "b": list(FETCHED)}, "pre_check_results": []}
    assert late(cut(*PLAN[:4])) == late(cut(*PLAN[:4], f"{PLAN[4]}!")) == PLAN
    assert late(cut(*PLAN[:4]), run(OPENED, OPENED, **team)) == PLAN
    assert late(cut(*PLAN[:4]), run(OPENED, OPENED, success=False, **team)) is None
    assert late() is None and late(run(PLAN, PLAN)) is None
    assert late(cut(*PLAN)) is None, "it was carried out, and is wrong"
    assert late(cut(*PLAN[:2], f"{PLAN[2]}!", *PLAN[2:4])) is None, "a step failed"
    assert late(cut(*PLAN[:2], PLAN[3])) is None, "it is another plan"
    assert late(cut(*PLAN[:4], pre_check_results=[{"verdict": False}])) is None


def test_a_plan_that_comes_undone_by_itself_is_told_from_one_that_is_wrong() -> None:
    again = (*OPENED, *FETCHED[:3], *OPENED, FETCHED[3])

    def unkept(*runs: Run) -> list[str] | None:
        found = unkept_plan(runs, COMMANDS)
        assert found is None or tuple(step.text for step in found[0]) == PLAN
        return None if found is None else [step.text for step in found[1]]

    fell = run(PLAN, again, success=False)
    team = {"initial_plan": {"a": list(OPENED), "b": list(FETCHED)}}
    assert unkept(fell) == ["open dryer door"]
    assert unkept(run(PLAN, (*OPENED, OPENED[1], *FETCHED), success=False)) is None, "it was only done twice"
    assert unkept(run(PLAN, again)) is None, "it went well all the same"
    assert unkept(run(PLAN, (*PLAN[:5], "open dryer door!"), success=False)) is None
    assert unkept(run(PLAN, (*OPENED, "close dryer door", *OPENED), success=False)) is None, "it shut the door itself"
    assert unkept(fell, run(OPENED, OPENED, success=False, **team)) is None
    assert unkept(fell, run(OPENED, OPENED, **team)) == ["open dryer door"]


def test_what_never_came_about_is_told_from_what_did_once() -> None:
    lit = (*PLAN, "turn on dryer")

    def unaided(*played: str, **changes: Any) -> list[str] | None:
        found = unaided_plan([run(lit, played, success=False, **changes)], COMMANDS)
        return None if found is None else [step.text for step in found[1]]

    assert unaided(*PLAN, "turn on dryer!", "turn on dryer!") == ["turn on dryer"]
    assert unaided(*PLAN, "turn on dryer!", "turn on dryer") is None, "it did at the second try"
    assert unaided(*PLAN) is None, "it was not tried"
    assert unaided(OPENED[0], "open dryer door!", "pick up towel!") is None, "of switches alone"
    assert unaided_plan([run(lit, (*PLAN, "turn on dryer!"))], COMMANDS) is None, "it went well all the same"


def test_what_one_robot_cannot_keep_open_is_held_by_the_helper() -> None:
    env = suite_kitchen("FallingDoor", robots=2, layout="one_wall_large", clock="events")
    agent = remac_agents.make("REMAC", planner="timely")
    reports = [play(env, agent, seed=2, most=500) for _ in range(2)]
    assert [report.success for report in reports] == [False, True]
    assert "open cabinet door" in reports[1].initial_plan["robot_1"]
    assert max(span.ended for span in env.timeline) == 30.0, "the shortest makespan"


@pytest.mark.long
def test_what_one_robot_is_too_slow_for_is_shared() -> None:
    env = suite_kitchen("SupperInTime", robots=2, layout="one_wall_large", clock="events")
    agent = remac_agents.make("REMAC", planner="timely")
    assert [play(env, agent, seed=1).success for _ in range(3)] == [False, True, True]


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


@pytest.mark.parametrize("template", ["fruit through the falling door", "grill for two"])
def test_what_no_robot_can_do_alone_two_try_in_the_last_iteration(template: str) -> None:
    spec = remac_env.generate(1, 20200, template=template, robots=2)
    env = remac_env.parallel_env(spec, robots=2, backend="symbolic")
    roles = {"planner": "literal,explores=true", "handover": "reflections,careful=true"}
    agent = remac_agents.make("REMAC", iterations=2, **roles)
    assert [play(env, agent, seed=0).success for _ in range(3)] == [False, False, True]
