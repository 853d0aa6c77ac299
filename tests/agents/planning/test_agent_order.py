"""What of a plan in rounds comes before what, and teams that go on by that order under the event clock."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

import remac_agents
import remac_env
from remac_agents.plan import Commands, Plan
from remac_agents.planning.order import in_order
from remac_agents.roles import HandoverRequest, PlanRequest
from remac_env.rules.scene import public_scene
from remac_env.rules.subtasks import WAIT

A, B = "robot_0", "robot_1"
ALONE = (
    *("navigate to microwave", "open microwave door", "navigate to vegetable"),
    *("pick up vegetable", "navigate to microwave", "place to microwave"),
)
MEANWHILE = ("wait", "wait", "navigate to cabinet", "open cabinet door")
BRINGS = ("navigate to vegetable", "pick up vegetable", "wait", "navigate to microwave", "place to microwave")
OPENS = ("navigate to microwave", "open microwave door", "navigate aside")


def ordered(rows: Mapping[str, tuple[str, ...]]) -> Any:
    env = remac_env.parallel_env("OpenMicrowavePnP", backend="symbolic")
    _, infos = env.reset(seed=1)
    commands = Commands(infos[A]["commands"])
    plan = Plan.of({robot: [commands[text] for text in row] for robot, row in rows.items()})
    return in_order(plan, public_scene(env.start.scene))


def test_what_a_helper_prepares_comes_before_what_needs_it() -> None:
    row = ordered({A: BRINGS, B: OPENS})
    lead, helper = ([item.step.text for item in row[robot]] for robot in (A, B))
    assert lead == [text for text in BRINGS if text != "wait"] and helper == list(OPENS)
    numbers = {item.step.text: item.number for item in row[B]}
    drive, place = row[A][2:]
    assert drive.after == {numbers["navigate aside"]} and not drive.beside
    assert place.after == {numbers["open microwave door"]}
    assert all(not item.after for item in (*row[A][:2], *row[B]))


def test_who_changes_places_in_one_round_begins_together() -> None:
    row = ordered({A: (*BRINGS[:2], *BRINGS[3:]), B: OPENS})
    assert row[A][2].beside == {row[B][2].number} and not row[A][2].after


def test_a_wait_that_no_other_robot_explains_stays_and_lasts_its_round() -> None:
    row = ordered({A: ALONE, B: MEANWHILE})
    assert [item.step == WAIT for item in row[B]] == [True, True, False, False]
    assert [item.seconds for item in row[B][:2]] == [6.0, 9.0]
    assert row[B][1].after == {row[A][1].number} and not row[B][1].is_step


class Told:
    """A planner that knows a plan for one, and a hand-over that knows one for two."""

    needs_truth = False

    def __init__(self, rows: Mapping[str, tuple[str, ...]]) -> None:
        self._rows = rows

    def plan(self, request: PlanRequest) -> Any:
        return {request.lead: list(ALONE)}

    def share(self, request: HandoverRequest) -> Plan:
        commands = Commands(request.commands)
        return Plan.of({robot: [commands[text] for text in row] for robot, row in self._rows.items()})


def play(rows: Mapping[str, tuple[str, ...]], **options: Any) -> tuple[Any, Any, Any]:
    env = remac_env.parallel_env("OpenMicrowavePnP", backend="symbolic", **options)
    told = Told(rows)
    agent = remac_agents.make("REMAC", planner=told, handover=told)
    for _ in range(2):
        observations, infos = env.reset(seed=1)
        agent.reset(observations, infos)
        while env.agents:
            observations, _, _, _, infos = env.step(agent.act(observations, infos))
        agent.close_episode(observations, infos)
    return env, agent, infos[A]


def test_nobody_waits_for_the_end_of_a_round() -> None:
    _, _, info = play({A: ALONE, B: MEANWHILE})
    assert info["success"] and info["seconds"] == 45.0
    env, agent, info = play({A: ALONE, B: MEANWHILE}, clock="events")
    assert info["success"] and info["seconds"] == 44.0
    report = agent.report()
    assert report.initial_plan[B] == MEANWHILE and report.final_plan[A] == ALONE
    ended = {span.what: span.ended for span in env.timeline if span.who == B and span.kind == "subtask"}
    assert ended == {"navigate to cabinet": 21.0, "open cabinet door": 30.0}


def test_a_helper_that_is_done_is_an_event() -> None:
    env, _, info = play({A: BRINGS, B: OPENS}, clock="events")
    assert info["success"] and info["seconds"] == 36.0
    began = {span.what: span.began for span in env.timeline if span.kind == "subtask"}
    assert began["navigate to microwave"] == 21.0  # when the helper has left
    env, _, info = play({A: (*BRINGS[:2], *BRINGS[3:]), B: OPENS}, clock="events")
    assert info["success"] and info["seconds"] == 30.0


@pytest.mark.long
def test_what_takes_its_time_is_waited_for_and_shared() -> None:
    env = remac_env.parallel_env("HeatBoth", robots=2, backend="symbolic", clock="events")
    agent = remac_agents.make("REMAC", planner="timely")
    seconds = []
    for _ in range(2):
        observations, infos = env.reset(seed=0)
        agent.reset(observations, infos)
        while env.agents:
            observations, _, _, _, infos = env.step(agent.act(observations, infos))
        agent.close_episode(observations, infos)
        assert infos[A]["success"]
        seconds.append(infos[A]["seconds"])
    assert seconds[-1] == 117.0 < seconds[0]
