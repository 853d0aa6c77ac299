"""The shortest makespan: exact on small episodes, and its plan takes as long as it says when it is carried out."""

from __future__ import annotations

from typing import Any

import pytest

import remac_env
from remac_env.events.makespan import Makespan, makespan
from remac_env.oracle import solve


def kitchen(task: str, robots: int, seed: int = 1) -> Any:
    env = remac_env.parallel_env(
        task, robots=robots, backend="symbolic", clock="events", layout="one_wall_large", max_seconds=600.0
    )
    env.reset(seed=seed)
    return env


def carried_out(env: Any, plan: Makespan) -> tuple[str, float]:
    """How an episode ends in which the plan is followed to the second, and when."""
    _, infos = env.reset(seed=env.start.seed)
    while env.agents:
        now = {(robot, at): subtask.text for at, robot, subtask in plan.plan}
        tokens = {
            robot: env.vocabulary.encode(now.get((robot, info["seconds"]), "wait") if info["ready"] else "continue")
            for robot, info in infos.items()
        }
        _, _, _, _, infos = env.step(tokens)
    info = next(iter(infos.values()))
    return info["end"], info["seconds"]


@pytest.mark.parametrize(
    ("task", "robots", "seconds"),
    [
        ("OpenCabinetPnP", 1, 44.0), ("OpenCabinetPnP", 2, 30.0), ("FillAndShelve", 1, 93.0),
        pytest.param("FallingDoor", 2, 30.0, marks=pytest.mark.long),
    ],
)  # fmt: skip
def test_the_shortest_makespan_is_what_its_plan_takes(task: str, robots: int, seconds: float) -> None:
    env = kitchen(task, robots)
    found = makespan(env.start, env.goal)
    assert (found.proof, found.seconds, found.lower) == ("search", seconds, seconds)
    assert carried_out(env, found) == ("success", seconds)


def test_it_is_no_longer_than_the_shortest_plan_in_rounds() -> None:
    for seed in (1, 2):
        env = kitchen("OpenMicrowavePnP", 1, seed)
        rounds = solve(env.start.scene, env.world, env.goal)
        found = makespan(env.start, env.goal)
        assert rounds is not None and found.optimum is not None
        assert found.optimum <= sum(max(s.row.seconds for s in joint.values()) for joint in rounds.rounds)


def test_a_door_that_falls_shut_is_too_much_for_one_robot() -> None:
    env = kitchen("FallingDoor", 1)
    found = makespan(env.start, env.goal)
    assert (found.proof, found.plan, found.lower, found.optimum) == ("exhausted", (), None, None)


def test_a_search_that_gives_up_says_so() -> None:
    env = kitchen("OpenCabinetPnP", 2)
    found = makespan(env.start, env.goal, max_states=3)
    assert found.proof == "bounds" and found.optimum is None
    assert found.lower is not None and 0 < found.lower <= 30.0


@pytest.mark.long
def test_no_bound_is_above_the_truth(monkeypatch: pytest.MonkeyPatch) -> None:
    """Held against a search without any bound."""
    env = kitchen("OpenCabinetPnP", 2)
    told = makespan(env.start, env.goal).seconds
    monkeypatch.setattr("remac_env.events.makespan._Bound.subtasks", lambda *_: 0.0)
    assert makespan(env.start, env.goal).seconds == told
