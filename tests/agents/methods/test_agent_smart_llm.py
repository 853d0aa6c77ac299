"""SMART-LLM: what its stages are asked and answered, what is refused, and how subtasks become rows."""

from __future__ import annotations

import json
import random
from dataclasses import replace
from typing import Any

import pytest
from agent_kitchens import play, suite_kitchen
from made_up_tasks import towels, washings

import remac_agents
from remac_agents.plan import Commands, Plan, PlanError
from remac_agents.planners.dividing import allocated, decomposed
from remac_agents.planners.literal import LiteralPlanner
from remac_agents.planning.coalitions import Task, lay_out, read_allocation, read_decomposition, skills_of
from remac_agents.roles import PlanRequest
from remac_env.rules.subtasks import WAIT

COMMANDS = Commands(towels().commands)
ALL = skills_of(COMMANDS.values())
ROBOTS = ("robot_0", "robot_1", "robot_2")
SKILLS = dict.fromkeys(ROBOTS, ALL)
OPEN = ["navigate to dryer", "open dryer door", "navigate aside"]
FETCH = ["navigate to towel", "pick up towel", "navigate to dryer", "place to dryer"]


def entry(name: object, steps: object, after: object = (), skills: object = ()) -> dict[str, Any]:
    return {"id": name, "steps": steps, "skills": skills, "after": list(after) if isinstance(after, tuple) else after}


def decomposition(*entries: Any) -> Any:
    return read_decomposition({"subtasks": list(entries)}, COMMANDS, SKILLS)


GOOD = decomposition(entry("a", OPEN), entry("b", FETCH, ("a",)))


def problems(answer: object) -> str:
    assert isinstance(answer, PlanError), answer
    return answer.told


class Staged:
    """A planner that answers by the question, and keeps its requests."""

    def __init__(self, **answers: list[Any]) -> None:
        self.answers, self.requests = answers, list[PlanRequest]()

    def plan(self, request: PlanRequest) -> Any:
        self.requests.append(request)
        return self.answers[request.question].pop(0)


RIGHT = [
    "navigate to cabinet", "open cabinet door", "navigate aside",
    "navigate to vegetable", "pick up vegetable", "navigate to cabinet", "place to cabinet",
]  # fmt: skip
PARTS = json.dumps([{"id": 1, "steps": RIGHT[:3]}, {"id": 2, "steps": RIGHT[3:], "skills": ["pick up"], "after": []}])


@pytest.mark.parametrize("robots", [1, 2])
@pytest.mark.parametrize("form", ["text", "values", "thoughts"])
def test_two_questions_and_then_the_plan_is_run(robots: int, form: str) -> None:
    told = {"text": PARTS, "values": json.loads(PARTS), "thoughts": f"<think>[[</think>Here:\n```json\n{PARTS}\n```"}
    last = f"robot_{robots - 1}"
    planner = Staged(decompose=[told[form]], allocate=[{"1": ["robot_0"], "2": {"robots": [last], "reason": "x"}}])
    report = play(suite_kitchen("OpenCabinetPnP", robots=robots), remac_agents.make("SMART-LLM", planner=planner))
    assert report.success and report.errors == () and report.pre_checks == ()
    assert report.initial_plan_length == (4 if robots == 2 else 7)
    first, second = planner.requests
    assert (first.question, second.question) == ("decompose", "allocate")
    assert first.robots == tuple(first.skills) and "pick up" in first.skills["robot_0"]
    assert [subtask["id"] for subtask in second.subtasks] == ["1", "2"]
    assert "open door" in second.subtasks[0]["skills"] and second.subtasks[1]["after"] == []


def test_what_is_wrong_is_told_at_once_and_asked_again_twice() -> None:
    bad = [{"id": "a", "steps": ["fly"], "after": ["z"]}, {"id": "a", "steps": RIGHT}]
    planner = Staged(decompose=[bad, "no idea", PARTS], allocate=[{}, {"1": "robot_9", "2": ["robot_1"]}, {"3": []}])
    report = play(suite_kitchen("OpenCabinetPnP"), remac_agents.make("SMART-LLM", planner=planner))
    assert not report.success and report.initial_plan_length == 0 and len(planner.requests) == 6
    second, third = planner.requests[1:3]
    assert all(word in second.failure for word in ("'fly'", "'z'", "twice"))
    assert len(third.repairs) == 2 and "a decomposition was asked for" in third.failure
    assert "'2' is given to no robot" in planner.requests[4].failure
    assert "robot_9" in planner.requests[5].failure
    assert [error.partition(":")[0] for error in report.errors] == ["decompose"] * 2 + ["allocate"] * 3


@pytest.mark.parametrize("planner", ["noop", "random", "oracle"])
def test_a_planner_that_only_plans_is_told_what_was_wanted(planner: str) -> None:
    report = play(suite_kitchen("OpenCabinetPnP"), remac_agents.make("SMART-LLM", planner=planner))
    assert not report.success and report.initial_plan_length == 0
    assert len(report.errors) == 3 and all("was asked for" in error for error in report.errors)


@pytest.mark.parametrize(
    ("entries", "told"),
    [
        ([], "0 subtasks"),
        ([entry("a", OPEN)] * 41, "41 subtasks"),
        ([entry(None, OPEN)], "no id"),
        ([entry(True, OPEN)], "no id"),
        ([entry("a", [])], "steps is no list"),
        ([entry("a", "navigate to dryer")], "steps is no list"),
        ([entry("a", ["navigate to dryer", 3])], "'3' is not a command"),
        ([entry("a", OPEN, after="b")], "no lists"),
        ([entry("a", OPEN, after=[["b"]])], "no lists"),
        ([entry("a", OPEN, skills=["sing"])], "unknown skill 'sing'"),
        ([entry("a", OPEN, ("b",)), entry("b", FETCH, ("a",))], "in a circle"),
        ([entry("a", OPEN, ("a",))], "in a circle"),
        ([entry("a", OPEN), entry(" a ", FETCH)], "stands twice"),
        ([3], "was asked for"),
    ],
)
def test_decompositions_that_are_refused(entries: list[Any], told: str) -> None:
    assert told in problems(decomposition(*entries))


@pytest.mark.parametrize("reply", ["", "Plan: [pick up towel]", "[1]", "{}", None, 3, Plan.of({}), {"robot_0": OPEN}])
def test_what_is_no_decomposition(reply: object) -> None:
    assert "a decomposition was asked for" in problems(read_decomposition(reply, COMMANDS, SKILLS))
    assert problems(read_decomposition("<think>{", COMMANDS, SKILLS))


@pytest.mark.parametrize(
    ("reply", "told"),
    [
        ({"a": ["robot_0"]}, "'b' is given to no robot"),
        ({"a": ["robot_0"], "b": ["robot_7"]}, "unknown robot 'robot_7'"),
        ({"a": ["robot_0"], "b": ["robot_1"], "c": ["robot_1"]}, "unknown subtask 'c'"),
        ({"a": ["robot_0"], "b": 3}, "'b' is given to no robot"),
        ({"robot_0": OPEN, "robot_1": FETCH}, "an allocation was asked for"),
        ([["robot_0"]], "an allocation was asked for"),
        ("no", "an allocation was asked for"),
    ],
)
def test_allocations_that_are_refused(reply: object, told: str) -> None:
    assert told in problems(read_allocation(reply, GOOD, ROBOTS, SKILLS, "robot_0"))


HANDS = {"robot_0": frozenset({"navigate to", "pick up", "place to"}),
         "robot_1": frozenset({"navigate to", "navigate aside", "open door"})}  # fmt: skip


def test_a_coalition_covers_its_subtask() -> None:
    robots = tuple(HANDS)
    read = [read_allocation({"a": [a], "b": [b]}, GOOD, robots, HANDS, "robot_0")
            for a, b in (("robot_1", "robot_0"), ("robot_0", "robot_1"))]  # fmt: skip
    assert read[0] == {"a": ("robot_1",), "b": ("robot_0",)}
    assert "robot_0 cannot navigate aside, open door" in problems(read[1])
    assert "robot_1 cannot pick up, place to" in problems(read[1])
    (both,) = decomposition(entry("x", [*OPEN, *FETCH]))
    team = read_allocation({"x": robots}, (both,), robots, HANDS, "robot_0")
    assert not isinstance(team, PlanError)
    plan = lay_out((both,), team, robots, HANDS)
    assert plan.row("robot_1") == both.steps[:3] and plan.row("robot_0") == (WAIT,) * 3 + both.steps[3:]


def test_what_comes_after_something_waits_for_its_end() -> None:
    plan = lay_out(GOOD, {"a": ("robot_1",), "b": ("robot_0",)}, ROBOTS, SKILLS)
    assert plan.length == 7 and plan.row("robot_0")[:3] == (WAIT,) * 3 and plan.row("robot_2") == ()
    free = tuple(replace(task, after=()) for task in GOOD)
    assert lay_out(free, {"a": ("robot_1",), "b": ("robot_0",)}, ROBOTS, SKILLS).length == 4
    assert lay_out(free, {"a": ("robot_0",), "b": ("robot_0",)}, ROBOTS, SKILLS).length == 7


@pytest.mark.parametrize("seed", range(30))
def test_rows_keep_every_order_that_was_asked_for(seed: int) -> None:
    """Random subtasks, orders and coalitions of three robots: all steps, each once, nothing before its time."""
    chance = random.Random(seed)
    steps = list(COMMANDS.values())
    names = [str(number) for number in range(chance.randint(1, 8))]
    tasks = []
    for number, name in enumerate(names):
        after = tuple(chance.sample(names[:number], chance.randint(0, min(2, number))))
        tasks.append(Task(name, tuple(chance.choice(steps) for _ in range(chance.randint(1, 5))), ALL, after))
    chance.shuffle(tasks)
    team = {name: tuple(chance.sample(ROBOTS, chance.randint(1, 3))) for name in names}
    plan = lay_out(tuple(tasks), team, ROBOTS, SKILLS)
    assert sum(step != WAIT for row in plan.rows.values() for step in row) == sum(
        step != WAIT for task in tasks for step in task.steps
    )
    swapped = {"robot_0": "robot_1", "robot_1": "robot_0", "robot_2": "robot_2"}
    other = lay_out(tuple(tasks), {n: tuple(swapped[r] for r in row) for n, row in team.items()}, ROBOTS, SKILLS)
    assert all(plan.row(robot) == other.row(swapped[robot]) for robot in ROBOTS)


def test_the_literal_planner_divides_by_rules() -> None:
    kitchen = washings()
    _, infos = kitchen.reset()
    request = PlanRequest(kitchen.sentence, "", kitchen.scene, kitchen.robots, "robot_0", tuple(kitchen.commands),
                          verbs=kitchen.verbs, question="decompose")  # fmt: skip
    told = LiteralPlanner().plan(request)
    assert isinstance(told, dict) and infos
    assert {task["steps"][1] for task in told["subtasks"]} == {"pick up plum", "turn on tap"}
    skills = {robot: tuple(sorted(ALL)) for robot in kitchen.robots}
    team = allocated(replace(request, question="allocate", skills=skills, subtasks=tuple(told["subtasks"])))
    assert {robot for row in team.values() for robot in row} == set(kitchen.robots)
    covered = allocated(replace(request, skills={"robot_0": ("pick up",), "robot_1": ("place to",)},
                                subtasks=({"id": "x", "steps": [], "skills": ["pick up", "place to"]},)))  # fmt: skip
    assert sorted(covered["x"]) == ["robot_0", "robot_1"]
    assert decomposed([], request) == {"subtasks": []}


@pytest.mark.parametrize("method", ["BASE", "SMART-LLM"])
def test_a_switch_is_the_other_robots_work(method: str) -> None:
    rows = play(suite_kitchen("DefrostInBowl"), remac_agents.make(method)).initial_plan
    assert len(rows) == 2 and any("turn on faucet" in row and "pick up meat" not in row for row in rows.values())
