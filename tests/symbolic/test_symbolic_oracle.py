"""The oracle: exact lengths, an admissible bound, no command forgotten, plans that can be carried out."""

from __future__ import annotations

from collections import deque
from typing import Any

import pytest

import remac_env
from remac_env.oracle import _rounds_at_least, relevant_commands, search_plan, solve
from remac_env.rounds import transition
from remac_env.state import FLOOR, Scene, WorldState
from remac_env.subtasks import WAIT, Subtask
from remac_env.tasks.goals import All, Goal, Inside

TASKS = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove")


def problem(task: str, seed: int, *, robots: int, starts: str) -> tuple[Any, Scene, WorldState, Goal]:
    env = remac_env.parallel_env(task, robots=robots, backend="symbolic", starts=starts)
    env.reset(seed=seed)
    return env, env.start.scene, env.world, env.goal


def all_commands(env: Any, scene: Scene) -> list[Subtask]:
    texts = env.vocabulary.commands(scene)
    return [env.vocabulary.parse(text) for text in texts if text not in ("wait", "done")]


@pytest.mark.parametrize(
    ("task", "robots", "length"),
    [*zip(TASKS, (1,) * 4, (6, 6, 9, 9), strict=True), *zip(TASKS, (2,) * 4, (4, 4, 6, 6), strict=True)],
)
def test_shortest_plans_from_paper_starts(task: str, robots: int, length: int) -> None:
    for seed in range(10):
        _, scene, world, goal = problem(task, seed, robots=robots, starts="paper")
        plan = solve(scene, world, goal)
        assert plan is not None and plan.length == length, seed


def breadth_first(scene: Scene, world: WorldState, goal: Goal, commands: list[Subtask]) -> int | None:
    """Written anew for one robot, without anything of the oracle's: every command, rounds run by the table."""
    (robot,) = scene.robots
    queue, seen = deque([(world, 0)]), {world}
    while queue:
        state, depth = queue.popleft()
        if goal.holds(scene, state):
            return depth
        for subtask in commands:
            after, outcomes = transition(scene, state, {robot: subtask})
            if outcomes[robot].success and after not in seen:
                seen.add(after)
                queue.append((after, depth + 1))
    return None


@pytest.mark.parametrize("task", TASKS[:2])
def test_breadth_first_search_over_all_commands_finds_nothing_shorter(task: str) -> None:
    for seed in range(4):
        env, scene, world, goal = problem(task, seed, robots=1, starts="mixed")
        plan = solve(scene, world, goal)
        commands = [c for c in all_commands(env, scene) if c.skill != "season"]
        assert plan is not None and plan.length == breadth_first(scene, world, goal, commands), seed


@pytest.mark.parametrize("task", TASKS)
def test_the_relevant_commands_are_enough(task: str) -> None:
    _check_relevant(task, range(3), max_states=6_000)


@pytest.mark.long
@pytest.mark.parametrize("task", TASKS)
def test_the_relevant_commands_are_enough_over_many_seeds(task: str) -> None:
    _check_relevant(task, range(60), max_states=30_000)


def _check_relevant(task: str, seeds: range, *, max_states: int) -> None:
    """With every command of the kitchen the plan is not shorter, as far as the search gets."""
    finished = 0
    for seed in seeds:
        env, scene, world, goal = problem(task, seed, robots=1, starts="mixed")
        plan = solve(scene, world, goal)
        assert plan is not None
        full = search_plan(
            scene,
            world,
            lambda state, scene=scene, goal=goal: goal.holds(scene, state),
            commands=all_commands(env, scene),
            bound=lambda state, scene=scene, goal=goal: _rounds_at_least(scene, state, goal),
            max_rounds=plan.length,
            max_states=max_states,
        )
        assert full is None or full.length == plan.length, seed
        finished += full is not None
    assert finished, "no search with all commands was finished, so nothing was compared"


@pytest.mark.parametrize("robots", [1, 2])
@pytest.mark.parametrize("task", TASKS)
def test_the_bound_never_cuts_off_a_shorter_plan(task: str, robots: int) -> None:
    """Breadth-first (bound 0) over the same commands is as long; and the bound never sinks by more than one a round."""
    for seed in range(4 if robots == 1 else 1):
        _, scene, world, goal = problem(task, seed, robots=robots, starts="mixed")
        plan = solve(scene, world, goal)
        assert plan is not None
        plain = search_plan(
            scene,
            world,
            lambda state, scene=scene, goal=goal: goal.holds(scene, state),
            commands=relevant_commands(scene, world, goal),
            max_rounds=plan.length,
            max_states=2_500,
        )
        assert plain is None or plain.length == plan.length, seed
        state, bounds = world, [_rounds_at_least(scene, world, goal)]
        for joint in plan.rounds:
            state, outcomes = transition(scene, state, dict(joint))
            assert all(outcome.success for outcome in outcomes.values())
            bounds.append(_rounds_at_least(scene, state, goal))
        assert goal.holds(scene, state) and bounds[-1] == 0
        assert all(bound <= plan.length - number for number, bound in enumerate(bounds)), bounds
        assert all(before - after <= 1 for before, after in zip(bounds, bounds[1:], strict=False)), bounds


def test_two_robots_never_need_more_rounds_than_one() -> None:
    for task in TASKS:
        for seed in (1,):
            lengths = []
            for robots in (1, 2):
                _, scene, world, goal = problem(task, seed, robots=robots, starts="mixed")
                plan = solve(scene, world, goal)
                assert plan is not None
                lengths.append(plan.length)
            assert lengths[1] <= lengths[0], (task, seed)


def test_what_is_lost_has_no_plan() -> None:
    _, scene, world, goal = problem("HeatOnStove", 0, robots=1, starts="paper")
    assert solve(scene, world.with_object("pan", place=FLOOR), goal) is None
    assert solve(scene, world, goal, max_rounds=8) is None
    nowhere = All(Inside("vegetable", "fridge"))
    assert solve(scene, world, nowhere, max_rounds=5) is None


def test_a_goal_that_holds_needs_no_round() -> None:
    _, scene, world, _ = problem("HeatOnStove", 0, robots=1, starts="paper")
    plan = solve(scene, world, All(Inside("pan", "counter")))
    assert plan is not None and plan.length == 0 and plan.as_text() == {}


def test_plans_as_text_leave_out_waiting_at_the_end() -> None:
    _, scene, world, goal = problem("OpenCabinetPnP", 0, robots=2, starts="paper")
    plan = solve(scene, world, goal)
    assert plan is not None
    texts = plan.as_text()
    assert set(texts) == {"robot_0", "robot_1"}
    assert all(not commands or commands[-1] != WAIT.text for commands in texts.values())
    assert max(len(commands) for commands in texts.values()) == plan.length
