"""REFLECT, CAPE and the best-of controls: what each asks, what it is told, and where it ends."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from agent_kitchens import Spy, play, suite_kitchen
from remac_bench.playing import agents as bench_agents
from remac_bench.playing.job_lists import make_jobs
from remac_bench.playing.runner import Settings, run_jobs
from remac_bench.store import Store

import remac_agents
from remac_agents.methods import METHODS
from remac_agents.planners.literal import LiteralPlanner
from remac_agents.roles import Advice, ExplainRequest, Explanation, PlanRequest, SeenStep, Summary
from remac_env.errors import OptionError, UnknownNameError
from remac_env.rules.conditions import condition

TASKS = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove")
CAPES = ("CAPE", "CAPE-IMPLICIT", "CAPE-SUCCESS", "CAPE-RESAMPLE")


class Listening(LiteralPlanner):
    """The literal planner, which keeps its requests."""

    def __init__(self) -> None:
        super().__init__(mends=True)
        self.requests: list[PlanRequest] = []

    def plan(self, request: PlanRequest) -> Any:
        """A literal plan."""
        self.requests.append(request)
        return super().plan(request)


def solo(task: str, **options: Any) -> Any:
    return suite_kitchen(task, robots=1, **options)


def test_methods_say_how_they_are_played() -> None:
    robots = {name: method.robots for name, method in METHODS.items() if method.robots != 1}
    assert robots == {"REMAC": 2, "SMART-LLM": 2, "REACT": 2}
    assert [name for name, m in METHODS.items() if m.iterates] == ["RE", "REMAC", "BASE-BEST", "CC-BEST"]
    assert [name for name, m in METHODS.items() if not m.plans_ahead] == [*CAPES, "REACT"]
    assert [name for name, m in METHODS.items() if m.by_events] == ["REMAC", "REACT"]
    assert all(bench_agents.default_robots(name) == method.robots for name, method in METHODS.items())
    assert bench_agents.default_iterations("CC-BEST") == bench_agents.default_iterations("RE") == 2
    assert bench_agents.default_iterations("REFLECT") == 0


# -- REFLECT -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("task", TASKS)
def test_reflect_corrects_a_failed_plan_once_from_where_it_stands(task: str) -> None:
    planner = Listening()
    agent = remac_agents.make("REFLECT", planner=planner)
    report = play(solo(task), agent)
    assert report.success and report.adjusted
    first, second = planner.requests
    assert not first.explanation and not first.history and not first.executed
    assert "not true that" in second.explanation
    assert second.previous_plan == report.initial_plan
    assert second.executed["robot_0"] == report.initial_plan["robot_0"]
    assert len(second.events) == len(second.history) == report.initial_plan_length
    assert sum(bool(attempt.false) for attempt in second.history) == 1
    assert second.world is None and report.truth_readers == ("checker",)
    assert report.final_plan_length > report.initial_plan_length
    assert len(agent.memory) == 0 and report.reflections == () and all(c.asked for c in report.pre_checks)


def test_reflect_with_checks_needs_its_hindsight_only_where_they_fail() -> None:
    checked, plain = Listening(), Listening()
    assert play(solo("HeatOnStove"), remac_agents.make("REFLECT+CC", planner=checked)).success
    assert len(checked.requests) == 1
    report = play(solo("HeatOnStove"), remac_agents.make("REFLECT+CC", planner=plain, adjuster=_no_advice))
    assert report.success and len(plain.requests) == 2


def _no_advice(request: Any) -> Any:
    return Advice("", row=request.plan.row(request.robot))


def test_a_question_is_noted_once_a_moment_and_again_in_the_next_round() -> None:
    asked = condition("door_open", "cabinet")

    def asks_twice(request: Any) -> Any:
        assert request.ask(asked) is request.ask(asked) is False
        return _no_advice(request)

    planner = Spy(["pick up vegetable"] * 2)
    report = play(solo("OpenCabinetPnP"), remac_agents.make("CC", planner=planner, adjuster=asks_twice))
    rounds = [check.round for check in report.pre_checks if check.asked and check.condition == asked.sentence]
    assert rounds == sorted(set(rounds)) and len(rounds) >= 2
    every = [(check.round, check.robot, check.subtask, check.condition) for check in report.pre_checks]
    assert len(every) == len(set(every))


def test_a_slip_is_told_from_a_wrong_plan_and_done_again() -> None:
    wording = {"wording": 1, "failure_rate": 0.12}
    told, won, base = [], 0, 0
    for seed in range(20):
        planner = Listening()
        won += play(solo("OpenCabinetPnP", **wording), remac_agents.make("REFLECT", planner=planner), seed=seed).success
        base += play(solo("OpenCabinetPnP", **wording), remac_agents.make("BASE"), seed=seed).success
        told += [request.explanation for request in planner.requests if request.explanation]
    assert won > base
    assert any("slipped" in text for text in told)


def test_a_summariser_of_ones_own() -> None:
    class Mine:
        def summarise(self, goal: str, steps: Any) -> Summary:
            assert all(isinstance(step, SeenStep) and step.after.world is None for step in steps)
            return Summary(("something happened",), ())

        def explain(self, request: ExplainRequest) -> Explanation:
            assert request.reached == (True, True, True, False)
            assert [c.predicate for c in request.false_before(3)] == ["accessible"]
            return Explanation("who knows")

    planner = Spy(["navigate to vegetable", "pick up vegetable", "navigate to cabinet", "place to cabinet"])
    report = play(solo("OpenCabinetPnP"), remac_agents.make("REFLECT", planner=planner, summariser=Mine()))
    assert planner.requests[1].explanation == "who knows" and planner.requests[1].events == ("something happened",)
    assert not report.success and len(planner.requests) == 2


def test_reflect_of_nothing_done_asks_once_more_and_ends() -> None:
    planner = Spy([], [])
    report = play(solo("OpenCabinetPnP"), remac_agents.make("REFLECT", planner=planner))
    assert len(planner.requests) == 2 and report.final_plan_length == 0
    short = remac_agents.make("REFLECT", planner=(late := Listening()), max_rounds=3)
    assert play(solo("OpenCabinetPnP"), short).final_plan_length == 4 and len(late.requests) == 1


# -- CAPE --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("task", TASKS)
def test_cape_corrects_step_by_step(task: str) -> None:
    planner = Listening()
    report = play(solo(task), remac_agents.make("CAPE", planner=planner))
    assert report.success and report.initial_plan_length is None and report.initial_plan == {}
    assert report.final_plan_length == report.subtasks_done == len(report.executed)
    assert report.post_checks == () and report.retries == 0
    refused = [r for r in planner.requests if r.failure]
    assert len(planner.requests) == len(report.executed) + len(refused)
    assert all(r.failure.endswith("A correct step would be to") and "not true" in r.failure for r in refused)
    assert all(r.single_step for r in planner.requests)


@pytest.mark.parametrize(
    ("method", "told"),
    [
        ("CAPE", "Error: I cannot pick up vegetable: not_at_station (not true: robot_0 stands at the vegetable)."),
        ("CAPE-IMPLICIT", "Error: I cannot pick up vegetable."),
        ("CAPE-SUCCESS", "Error: the task failed."),
        ("CAPE-RESAMPLE", ""),
    ],
)
def test_what_each_preset_says_of_a_refused_step(method: str, told: str) -> None:
    planner = Spy(["pick up vegetable"], ["navigate to vegetable", "pick up vegetable"], "done")
    report = play(solo("OpenCabinetPnP"), remac_agents.make(method, planner=planner))
    assert planner.requests[1].failure == (f"{told} A correct step would be to" if told else "")
    assert planner.requests[2].failure == ""
    refused = [attempt for attempt in planner.requests[1].history if not attempt.ran]
    assert len(refused) == (method != "CAPE-RESAMPLE") and bool(refused and refused[0].false) == (method == "CAPE")
    assert report.final_plan == {"robot_0": ("navigate to vegetable",)} and len(planner.requests) == 3


@pytest.mark.parametrize("method", CAPES)
def test_cape_ends_however_its_planner_insists(method: str) -> None:
    class Stubborn(Spy):
        def plan(self, request: PlanRequest) -> Any:
            super().plan(request)
            return "fly" if len(self.requests) % 2 else ["pick up vegetable"]

    planner = Stubborn()
    report = play(solo("OpenCabinetPnP"), remac_agents.make(method, planner=planner, max_rounds=10))
    assert len(planner.requests) == 20 and report.final_plan_length == 0
    assert len(report.errors) == 10 and "fly" in report.errors[0]


# -- best of k+1 ------------------------------------------------------------------------------------------------------

GOOD = ["navigate to cabinet", "open cabinet door", "navigate to vegetable", "pick up vegetable",
        "navigate to cabinet", "place to cabinet", "navigate aside"]  # fmt: skip


def test_the_first_try_that_succeeds_is_played_again() -> None:
    planner, env = Spy(["navigate aside"], GOOD), solo("OpenCabinetPnP")
    agent = remac_agents.make("BASE-BEST", planner=planner)
    reports = [play(env, agent) for _ in range(4)]
    assert [report.success for report in reports] == [False, True, True, True]
    assert len(planner.requests) == 2 and not any(r.reflections or r.previous_plan for r in planner.requests)
    for report in reports[2:]:
        assert report == replace(reports[1], iteration=report.iteration)
    assert reports[1].final_plan_length == 7  # the step that was not needed any more counts, as in BASE


def test_tries_of_another_start_are_their_own() -> None:
    planner, env = Spy(GOOD, ["wait", "navigate aside"]), solo("OpenCabinetPnP")
    agent = remac_agents.make("BASE-BEST", planner=planner)
    assert [play(env, agent, seed=seed).success for seed in (1, 2, 1)] == [True, False, True]


def test_slips_and_retries_are_played_again_as_they_were() -> None:
    for seed in range(12):
        env, agent = solo("HeatOnStove", failure_rate=0.2), remac_agents.make("CC-BEST")
        reports = [play(env, agent, seed=seed) for _ in range(3)]
        first = next((index for index, report in enumerate(reports) if report.success), 2)
        for report in reports[first + 1 :]:
            same = replace(reports[first], iteration=report.iteration, pre_checks=(), post_checks=())
            assert report == same


def test_the_scored_record_succeeds_where_any_record_does(tmp_path: Path) -> None:
    jobs = make_jobs(
        tasks=["DefrostInBowl"],
        methods=["CC", "CC-BEST"],
        seeds=range(8),
        kitchen={"backend": "symbolic", "starts": "mixed"},
        agent={"checker": "noisy,false_alarm=0.25,miss=0.25"},
    )
    run_jobs(jobs, tmp_path, Settings(workers=0))
    records = [record for record in Store(tmp_path).read() if record.method == "CC-BEST"]
    scored = {record.job: record.success for record in records if record.scored}
    assert len(scored) == 8 and len(records) == 24
    assert scored == {job: any(r.success for r in records if r.job == job) for job in scored}
    alone = [record.success for record in Store(tmp_path).read() if record.method == "CC"]
    assert sum(scored.values()) > sum(alone)


def test_methods_from_outside_need_a_name_of_their_own() -> None:
    before = remac_agents.methods()
    for name, told in (("CC", "'CC' exists already"), ("", "letters"), ("A,b=c", "letters")):
        with pytest.raises(OptionError, match=told):
            remac_agents.register_method(name)
    with pytest.raises(UnknownNameError, match="unknown fact of a method 'robot'; valid: robots, remembers"):
        remac_agents.register_method("MINE", robot=2)
    assert remac_agents.methods() == before
