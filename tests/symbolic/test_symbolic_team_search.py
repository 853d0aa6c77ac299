"""The search for three robots and more looks once at what differs in robots' names alone, and loses nothing by it."""

from __future__ import annotations

import pytest

import remac_env
from remac_env.oracle import certify, moves, relevant_commands, search
from remac_env.oracle.moves import alike, joint_moves
from remac_env.oracle.search import most_states


def problem(task: str, seed: int, *, robots: int = 3, starts: str = "mixed"):
    env = remac_env.parallel_env(task, robots=robots, backend="symbolic", starts=starts)
    env.reset(seed=seed)
    return env.start.scene, env.world, env.goal


@pytest.mark.long
@pytest.mark.parametrize("task", ["OpenCabinetPnP", "OpenMicrowavePnP"])
def test_plans_are_as_short_as_those_of_a_search_over_all_names(task: str, monkeypatch: pytest.MonkeyPatch) -> None:
    scene, world, goal = problem(task, 2, starts="paper")
    quick = certify(scene, world, goal)
    monkeypatch.setattr(moves, "SEVERAL", 9)
    plain = certify(scene, world, goal, max_states=2_000)
    assert quick.proof == plain.proof == "search"
    assert quick.optimum == plain.optimum and quick.expanded < plain.expanded


def test_the_rounds_are_all_rounds_but_for_the_names(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, world, goal = problem("HeatOnStove", 2)
    commands = relevant_commands(scene, world, goal)
    few = {alike(scene, after): price for _, after, price in joint_moves(scene, world, commands)}
    monkeypatch.setattr(moves, "SEVERAL", 9)
    every = list(joint_moves(scene, world, commands))
    monkeypatch.undo()
    assert few == {alike(scene, after): price for _, after, price in every} and len(few) < len(every) / 3


def test_worlds_that_differ_in_names_alone_are_one() -> None:
    scene, world, _ = problem("HeatOnStove", 2)
    one, other = (world.with_robot(name, station="sink") for name in ("robot_0", "robot_2"))
    assert one != other and alike(scene, one) == alike(scene, other) != alike(scene, world)
    held = one.with_robot("robot_0", holding="vegetable")
    assert alike(scene, held) != alike(scene, one)


def test_larger_teams_give_up_sooner_and_say_so() -> None:
    bounds = [most_states(problem("HeatOnStove", 2, robots=robots)[0]) for robots in (1, 2, 3, 4)]
    assert bounds[0] == bounds[1] > bounds[2] > bounds[3]
    scene, world, goal = problem("SeasonedMicrowave", 5)
    found = certify(scene, world, goal, max_states=20)
    assert found.unknown and found.optimum is None and found.lower is not None
    commands = relevant_commands(scene, world, goal)
    assert search(scene, world, lambda state: False, commands=commands, max_states=3).gave_up
