"""The reflection database survives what happens to files, and stays within bounds."""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path

from agent_kitchens import play, suite_kitchen

import remac_agents
from remac_agents.memory import Memory, Run

APPENDIX = {
    "task_description",
    "task_goal",
    "initial_plan",
    "action_list",
    "pre_check_results",
    "post_check_results",
    "success",
    "reflection",
}


def run(task: str = "Tidy", *, success: bool = True, lessons: tuple[str, ...] = (), robots: int = 1) -> Run:
    plan = {f"robot_{index}": ["wait"] for index in range(robots)}
    return Run(task, "tidy up", plan, [], [{"verdict": not lessons}], [], success, list(lessons))


def test_the_eight_fields_and_no_truth() -> None:
    assert {field.name for field in fields(Run)} == APPENDIX
    agent = remac_agents.make("RE")
    play(suite_kitchen("DefrostInBowl", robots=1), agent)
    (kept,) = agent.memory.runs("DefrostInBowl")
    assert kept.success
    assert kept.adjusted
    assert kept.reflection
    assert all("truth" not in check for check in kept.pre_check_results + kept.post_check_results)


def test_a_torn_last_line_costs_that_line_alone(tmp_path: Path) -> None:
    path = tmp_path / "memory.jsonl"
    Memory(path).append(run(lessons=("one",)))
    with path.open("a") as file:
        file.write('{"task_description": "Tidy", "task_go')
    torn = Memory(path)
    assert len(torn) == 1
    torn.append(run(lessons=("two",)))
    assert Memory(path).lessons("Tidy") == ("one", "two")
    assert len(path.read_text().splitlines()) == 3


def test_foreign_lines_are_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "memory.jsonl"
    path.write_text('7\n{"reflection": []}\n\n' + json.dumps(dict.fromkeys(APPENDIX, 1)) + "\n")
    assert len(Memory(path)) == 0


def test_lessons_are_told_once_newest_last_and_bounded() -> None:
    memory = Memory()
    memory.append(run(lessons=("a", "b")))
    memory.append(run(lessons=("c", "a")))
    memory.append(run("Other", lessons=("z",)))
    assert memory.lessons("Tidy") == ("b", "c", "a")
    assert memory.lessons("Tidy", most=2) == ("c", "a")
    assert memory.lessons("Tidy", characters=1) == ("a",)


def test_an_agent_goes_on_from_a_file(tmp_path: Path) -> None:
    env, path = suite_kitchen("HeatOnStove"), tmp_path / "deep" / "memory.jsonl"
    lengths = [play(env, remac_agents.make("REMAC", memory=path)).initial_plan_length for _ in range(3)]
    assert lengths == [5, 9, 7]
