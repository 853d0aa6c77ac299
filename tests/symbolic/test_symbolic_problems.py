"""Starts that differ only in looks and names are one problem; any other difference that can matter makes two."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest

import remac_env
from remac_env.oracle import problem_id

TASKS = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove")


def problems(task: str, seeds: Iterable[int], **options: Any) -> set[str]:
    env = remac_env.parallel_env(task, backend="symbolic", **options)
    found = set()
    for seed in seeds:
        env.reset(seed=seed)
        found.add(problem_id(env.start.scene, env.world, env.goal))
    return found


@pytest.mark.parametrize("task", TASKS)
def test_a_task_has_one_problem_on_paper_starts_and_many_on_mixed_ones(task: str) -> None:
    assert len(problems(task, range(12))) == 1
    assert problems(task, range(3), naming="category") == problems(task, range(3))
    assert problems(task, range(3), style="rustic", layout="galley") == problems(task, range(3))
    assert len(problems(task, range(20), starts="mixed")) >= 8


def test_what_can_matter_makes_another_problem() -> None:
    env = remac_env.parallel_env("HeatOnStove", robots=1, backend="symbolic")
    env.reset(seed=0)
    scene, world, goal = env.start.scene, env.world, env.goal
    (robot,) = scene.robots
    lit = world.with_fixture("stove", on=frozenset(scene.fixtures["stove"].switches[:1]))
    held = world.with_robot(robot, holding="pan")
    marked = world.with_object("vegetable", marks=frozenset({"washed"}))
    made = [problem_id(scene, start, goal) for start in (world, lit, held, marked)]
    assert len(set(made)) == 4
    other = next(name for name in scene.objects if name not in goal.names())
    assert problem_id(scene, world.with_object(other, marks=frozenset({"washed"})), goal) == made[0]
