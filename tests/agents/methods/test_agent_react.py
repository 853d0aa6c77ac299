"""ReAct: each robot is asked when it is ready, and for itself; its thoughts are counted as its own."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import pytest

import remac_agents
import remac_env
from remac_agents.roles import PlanRequest

A, B = "robot_0", "robot_1"


@dataclass
class Asked:
    """A planner that gives robots their rows one command at a time, and notes what it was asked."""

    rows: dict[str, list[str]]
    heard: list[PlanRequest] = field(default_factory=list)
    thinking_seconds: float = 0.0

    def plan(self, request: PlanRequest) -> str:
        self.heard.append(request)
        row = self.rows[request.lead]
        return f"Thought: next.\nPlan: [{row.pop(0) if row else 'done'}]"


def play(planner: Any, *, clock: str = "events", task: str = "OpenMicrowavePnP", **options: Any) -> tuple[Any, Any]:
    env = remac_env.parallel_env(task, backend="symbolic", clock=clock, **options)
    agent = remac_agents.make("REACT", planner=planner)
    observations, infos = env.reset(seed=1)
    agent.reset(observations, infos)
    asked = []
    while env.agents:
        tokens = agent.act(observations, infos)
        asked.append({robot for robot, info in infos.items() if info.get("ready", True)})
        for robot, thought in agent.thoughts().items() if clock == "events" else ():
            env.note_thought(robot, thought)
        observations, _, _, _, infos = env.step(tokens)
    agent.close_episode(observations, infos)
    return agent, infos[A]


def rows() -> dict[str, list[str]]:
    return {
        A: ["navigate to vegetable", "pick up vegetable", "wait", "navigate to microwave", "place to microwave"],
        B: ["navigate to microwave", "open microwave door", "navigate aside"],
    }


def test_each_robot_is_asked_for_itself_when_it_is_ready() -> None:
    planner = Asked(rows())
    agent, info = play(planner)
    assert info["success"] and info["seconds"] == 30.0
    assert all(request.question == "act" and request.robots == (request.lead,) for request in planner.heard)
    second = [request for request in planner.heard if request.lead == B][1]
    assert [attempt.subtask.text for attempt in second.history] == ["navigate to microwave"]
    assert second.history[0].succeeded is True
    first = planner.heard[0]
    assert first.teammates == {} and planner.heard[1].teammates == {A: "navigate to vegetable"}
    later = next(request for request in planner.heard if request.lead == A and len(request.history) == 2)
    assert later.teammates == {B: "open microwave door"}, "it is told what the other one is at"
    report = agent.report()
    assert report.success and [step.subtask for step in report.executed if step.robot == B] == rows()[B]
    assert all(step.done for step in report.executed)


def test_a_failure_is_told() -> None:
    planner = Asked({A: ["pick up vegetable", "navigate to vegetable"], B: []})
    _, info = play(planner)
    told = [request.history for request in planner.heard if request.lead == A]
    assert info["end"] == "done" and told[1][0].succeeded is False and told[2][1].succeeded is True


def test_with_rounds_all_are_asked_in_every_round() -> None:
    planner = Asked(rows())
    agent, info = play(planner, clock="rounds")
    assert info["success"] and info["round"] == 5
    assert len(planner.heard) == 5 + 4, "five commands of one, three and a `done` of the other"


def test_thinking_counts_for_the_robot_that_thought() -> None:
    patient = rows()
    patient[A].insert(2, "wait")
    _, info = play(Asked({robot: list(row) for robot, row in patient.items()}, thinking_seconds=2.0), think="tokens:10")
    assert info["success"] and info["seconds"] == 46.0
    _, free = play(Asked(patient, thinking_seconds=2.0), think="off")
    assert free["success"] and free["seconds"] == 36.0


def test_who_gives_no_answer_has_finished() -> None:
    class Mute:
        def plan(self, request: PlanRequest) -> str:
            return "no idea"

    agent, info = play(Mute())
    assert info["end"] == "done" and len(agent.report().errors) == 6


@pytest.mark.parametrize("task", ["OpenMicrowavePnP", pytest.param("WashPnPHeat", marks=pytest.mark.long)])
def test_the_oracle_acts_as_one_of_a_team(task: str) -> None:
    for clock in ("rounds", "events"):
        agent, info = play("oracle", clock=clock, task=task)
        assert info["success"] and "planner" in agent.report().truth_readers
