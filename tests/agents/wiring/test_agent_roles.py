"""Roles and agents: names, bounds, noise, truth, crashes."""

from __future__ import annotations

from typing import Any

import pytest
from agent_kitchens import Spy, play, suite_kitchen

import remac_agents
from remac_agents.roles import ANSWERS, View
from remac_env.errors import LifecycleError, OptionError, UnknownNameError

TASK = "DefrostInBowl"


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"name": "REMACK"}, "BASE, CC, RE, REMAC"),
        ({"name": "CC", "planner": "genius"}, "literal"),
        ({"name": "CC", "checker": "oracle"}, "noisy"),
        ({"name": "CC", "planner": "no.such.module:Name"}, "no.such.module"),
    ],
)
def test_unknown_names_list_the_valid_ones(arguments: dict[str, Any], told: str) -> None:
    with pytest.raises(UnknownNameError, match=told):
        remac_agents.make(**arguments)


def test_options_and_objects_that_do_not_fit_are_refused() -> None:
    with pytest.raises(OptionError, match="check"):
        remac_agents.make("CC", checker=object())
    with pytest.raises(OptionError, match="false_alarm"):
        remac_agents.make("CC", checker={"name": "noisy", "false_alarm": 2.0})
    with pytest.raises(OptionError, match="colour"):
        remac_agents.make("CC", checker={"name": "noisy", "colour": "red"})
    with pytest.raises(OptionError, match="retries"):
        remac_agents.make("CC", retries=-1)


def test_a_role_may_be_given_by_its_address() -> None:
    agent = remac_agents.make("CC", planner="remac_agents.planners.noop:NoopPlanner")
    assert play(suite_kitchen(TASK), agent).initial_plan_length == 0


def test_calls_out_of_order() -> None:
    agent = remac_agents.make("CC")
    with pytest.raises(LifecycleError):
        agent.act({}, {})
    obs, infos = suite_kitchen(TASK).reset(seed=1)
    agent.reset(obs, infos)
    agent.close_episode(obs, infos)
    agent.close_episode(obs, infos)
    with pytest.raises(LifecycleError):
        agent.act(obs, infos)


@pytest.mark.few(45)
@pytest.mark.parametrize("method", remac_agents.methods())
@pytest.mark.parametrize("checker", [{"name": "noisy", "false_alarm": 0.4, "miss": 0.4}, "none", "truth"])
@pytest.mark.parametrize("planner", ["literal", "random", "noop"])
def test_every_method_ends(method: str, checker: Any, planner: str) -> None:
    env = suite_kitchen(TASK, failure_rate=0.3, max_rounds=1000)
    agent = remac_agents.make(method, checker=checker, planner=planner)
    for seed in range(2):
        play(env, agent, seed=seed, most=70)


def test_noise_is_seeded_and_hurts() -> None:
    def reports(false_alarm: float) -> list[remac_agents.EpisodeReport]:
        noisy = {"name": "noisy", "false_alarm": false_alarm, "miss": 0.0}
        return [
            play(suite_kitchen(TASK, robots=1), remac_agents.make("CC", checker=noisy), seed=seed) for seed in range(8)
        ]

    noisy, plain = reports(0.2), reports(0.0)
    assert noisy == reports(0.2)
    assert sum(r.final_plan_length for r in noisy) > sum(r.final_plan_length for r in plain)
    wrong = [check for report in noisy for check in report.pre_checks if check.verdict != check.truth]
    assert wrong
    assert all(check.truth for check in wrong)


def test_slips_are_retried_and_teach_nothing() -> None:
    env = suite_kitchen("OpenCabinetPnP", robots=1, failure_rate=0.25)
    clean = play(suite_kitchen("OpenCabinetPnP", robots=1), remac_agents.make("RE"))
    retried = 0
    for seed in range(10):
        report = play(env, remac_agents.make("RE"), seed=seed)
        retried += report.retries
        assert set(report.reflections) <= set(clean.reflections)
    assert retried


def test_truth_reaches_only_those_who_need_it() -> None:
    spy = Spy(["navigate aside"])
    report = play(suite_kitchen(TASK), remac_agents.make("RE", planner=spy))
    assert spy.requests[0].world is None
    assert report.truth_readers == ("checker",)
    spy.needs_truth = True  # type: ignore[attr-defined]
    report = play(suite_kitchen(TASK), remac_agents.make("BASE", planner=spy, checker="none"))
    assert spy.requests[-1].world is not None
    assert report.truth_readers == ("planner",)


def test_reasons_are_seen_only_with_that_feedback() -> None:
    seen: dict[str, set[str | None]] = {}

    class Watching:
        def check(self, conditions: Any, view: View) -> Any:
            reasons = {report.reason for report in view.reports.values() if report is not None}
            seen.setdefault(feedback, set()).update(reasons)
            return remac_agents.wiring.catalogue.make_role("checker", "none").check(conditions, view)

    for feedback in ("status", "reason"):
        env = suite_kitchen("OpenCabinetPnP", feedback=feedback)
        play(env, remac_agents.make("CC", checker=Watching()))
    assert seen["status"] == {None}
    assert "door_closed" in seen["reason"]


def test_a_reply_that_is_no_plan_is_sent_back_twice() -> None:
    spy = Spy("fly to the moon", {"robot_9": ["navigate asides"]}, ["navigate aside"])
    report = play(suite_kitchen(TASK), remac_agents.make("CC", planner=spy))
    first, second, third = spy.requests
    assert not first.failure and not first.repairs
    assert "fly to the moon" in second.failure and second.repairs[0].answer == "fly to the moon"
    assert third.repairs[0] == second.repairs[0]
    assert third.repairs[1].answer == '{"robot_9": ["navigate asides"]}'
    assert "robot_9" in third.repairs[1].problems[0] and "'navigate aside'" in third.repairs[1].problems[1]
    assert third.failure == "; ".join(third.repairs[1].problems)
    assert report.initial_plan_length == 1
    assert len(report.errors) == 2
    stubborn = Spy(7, 7, 7, ["navigate aside"])
    assert play(suite_kitchen(TASK), remac_agents.make("CC", planner=stubborn)).initial_plan_length == 0
    assert len(stubborn.requests) == 3 == ANSWERS and stubborn.requests[2].repairs[0].answer == "7"


def test_robots_that_a_method_does_not_use_step_aside_then_wait() -> None:
    env, agent = suite_kitchen(TASK), remac_agents.make("REMAC", lead="robot_1")
    obs, infos = env.reset(seed=1)
    agent.reset(obs, infos)
    said = []
    for _ in range(3):
        tokens = agent.act(obs, infos)
        said.append(env.vocabulary.decode(tokens["robot_0"]))
        obs, _, _, _, infos = env.step(tokens)
    assert said == ["navigate aside", "wait", "wait"]


def test_an_episode_cut_short_is_remembered_as_a_failure() -> None:
    env, agent = suite_kitchen(TASK), remac_agents.make("RE")
    obs, infos = env.reset(seed=1)
    agent.reset(obs, infos)
    for _ in range(5):
        obs, _, _, _, infos = env.step(agent.act(obs, infos))
    agent.close_episode({}, {})
    obs, infos = env.reset(seed=1)
    agent.reset(obs, infos)
    agent.act(obs, infos)
    agent.reset(obs, infos)
    first, second = agent.memory.runs(TASK)
    assert not first.success
    assert not second.success
    assert first.reflection
    assert first.action_list


def test_an_option_that_a_role_does_not_take_is_answered_with_those_that_it_takes() -> None:
    with pytest.raises(OptionError, match=r"checker 'noisy' does not take .*'fp'.*; valid: false_alarm, miss"):
        remac_agents.make("CC", checker="noisy,fp=0.1")
    with pytest.raises(OptionError, match=r"does not take .*depth.*; valid: "):
        remac_agents.make("CC", planner="oracle,depth=1")
