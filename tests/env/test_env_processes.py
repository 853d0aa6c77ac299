"""Things that take their time: rows, the queue, what comes of them in episodes, and the tasks that need them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import remac_env
from remac_env import testing
from remac_env.errors import KitchenFileError, OptionError, UnknownNameError
from remac_env.rules.processes import chosen, known, make_process
from remac_env.tasks import get
from remac_env.validate import validate

TIMED = tuple(remac_env.tasks("events")[len(remac_env.tasks()) :])
A, B = "robot_0", "robot_1"


def kitchen(task: str, **options: Any) -> Any:
    made = {"backend": "symbolic", "clock": "events", "layout": "one_wall_large"} | options
    return remac_env.parallel_env(task, **made)


def play(env: Any, *steps: tuple[str, str]) -> Any:
    """Give robots their commands as soon as they are ready, each row in order; the infos after the last."""
    rows = {robot: [step for who, step in steps if who == robot] for robot in env.possible_agents}
    _, infos = env.reset(seed=1)
    while env.agents and any(rows.values()):
        tokens = {}
        for robot in env.agents:
            ready = infos[robot]["ready"]
            command = (rows[robot].pop(0) if rows[robot] else "wait") if ready else "continue"
            tokens[robot] = env.vocabulary.encode(command)
        _, _, _, _, infos = env.step(tokens)
    return infos[A]


def row(robot: str, text: str) -> list[tuple[str, str]]:
    return [(robot, step.strip()) for step in text.split(";")]


FILL = "navigate to bowl; pick up bowl; navigate to sink; place to sink; turn on faucet"
SHELVE = "navigate to cabinet; open cabinet door; navigate to fish; pick up fish; navigate to cabinet; place to cabinet"


def test_a_basin_fills_while_another_thing_is_done() -> None:
    env = kitchen("FillAndShelve")
    info = play(env, *row(A, f"{FILL}; wait; wait; wait; wait; turn off faucet"), *row(B, SHELVE))
    assert env.start.scene.slow == {"filled", "overflowed"}
    while env.agents and not info["end"]:
        _, _, _, _, infos = env.step({r: env.vocabulary.encode("wait") for r in env.agents})
        info = infos[A]
    assert info["end"] == "success"
    filled = [span for span in env.timeline if span.kind == "process"]
    assert [(span.who, span.what, span.ended - span.began) for span in filled if span.status != "cut"] == [
        ("bowl", "filling", 25.0)
    ]


def test_what_is_forgotten_runs_over_and_is_lost() -> None:
    env = kitchen("FillAndShelve", robots=1)
    info = play(env, *row(A, FILL))
    assert info["processes"] == {"filling bowl": 0.0} and "The bowl is filling" in info["text"]
    wait = {A: env.vocabulary.encode("wait")}
    seen = []
    while env.agents:
        observations, _, _, _, infos = env.step(wait)
        seen.append((infos[A]["seconds"], dict(infos[A]["processes"]), infos[A]["end"]))
    assert seen[-1][2] == "lost" and seen[-1][0] == 36.0 + 25.0 + 20.0
    assert any("overflowing bowl" in running for _, running, _ in seen)
    assert observations[A]["observation"].max() <= 1.0


def test_what_is_turned_off_in_between_begins_anew() -> None:
    env = kitchen("FillAndShelve", robots=1)
    info = play(env, *row(A, f"{FILL}; wait; turn off faucet; turn on faucet; wait"))
    assert info["processes"] == {"filling bowl": 5.0} and info["seconds"] == 36.0 + 5.0 + 7.0 + 7.0 + 5.0


def test_a_door_falls_shut_where_nobody_stands() -> None:
    env = kitchen("FallingDoor")
    fetch = "navigate to vegetable; pick up vegetable; navigate to cabinet; place to cabinet"
    alone = play(kitchen("FallingDoor", robots=1), *row(A, f"navigate to cabinet; open cabinet door; {fetch}"))
    assert alone["outcome"]["reason"] == "door_closed", "it fell shut while the robot was away"
    later = fetch.replace("vegetable; navigate", "vegetable; wait; navigate")
    kept = play(env, *row(A, "navigate to cabinet; open cabinet door; navigate aside"), *row(B, later))
    assert kept["success"]


def test_water_that_takes_time_washes_nothing_at_once() -> None:
    env = kitchen("RinseAndStow", robots=1)
    wash = "navigate to vegetable; pick up vegetable; navigate to sink; place to sink; turn on faucet"
    info = play(env, *row(A, wash))
    assert "washed" not in info["world"].objects["vegetable"].marks
    info = play(env, *row(A, f"{wash}; wait; wait; wait; wait"))
    assert "washed" in info["world"].objects["vegetable"].marks and info["seconds"] == 36.0 + 20.0


def test_a_deadline_ends_the_episode() -> None:
    env = kitchen("SupperInTime", robots=1)
    info = play(env, *row(A, "; ".join(["wait"] * 40)))
    assert (info["end"], info["seconds"], info["max_seconds"]) == ("truncated", 110.0, 110.0)


@pytest.mark.parametrize("task", TIMED)
def test_tasks_that_take_their_time_keep_the_contract(task: str) -> None:
    def make() -> Any:
        return kitchen(task, layout=None)

    validate(get(task))
    testing.check_events(make, seeds=(0,), steps=40)
    testing.check_spaces(make, seeds=(1,), rounds=25)
    with pytest.raises(OptionError, match=r"clock='rounds'.*clock='events'"):
        kitchen(task, clock="rounds")
    sizes = {make().observation_space(A)["observation"].shape for _ in range(2)}
    assert len(sizes) == 1


def test_tasks_in_rounds_are_as_they_were() -> None:
    assert len(remac_env.tasks()) == 6 and len(TIMED) == 9 and not set(remac_env.tasks()) & set(TIMED)
    with pytest.raises(UnknownNameError, match="rounds, events"):
        remac_env.tasks("seconds")
    env = kitchen("HeatOnStove")
    _, infos = env.reset(seed=0)
    assert infos[A]["processes"] == {} and env.start.scene.processes == ()


def test_each_row_says_how_long_and_why() -> None:
    assert len(known()) == 8
    for name, process in known().items():
        assert process.name == name and process.seconds > 0 and process.told
        assert f"{process.seconds:g}" in process.told or not process.mark
    assert chosen([("melting", ("fish",))])[0].about == ("fish",)
    with pytest.raises(UnknownNameError, match="process 'rusting'.*heating"):
        chosen([("rusting", ())])


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"source": ""}, "lacks source"),
        ({"while": "raining"}, "raining.*on heat"),
        ({"does": "explode"}, "explode.*mark"),
        ({"seconds": -1}, "-1, which is no time"),
        ({"seconds": "long"}, "'long', which is no time"),
        ({"shows": "fireworks"}, "fireworks.*steam"),
        ({"mark": ""}, "there is one if it does mark"),
    ],
)
def test_a_row_that_makes_no_sense_is_refused(changes: dict[str, Any], told: str) -> None:
    fine = {"while": "on heat", "does": "mark", "mark": "dry", "seconds": 3.0, "source": "us", "text": "t", "told": "t"}
    assert make_process("drying", fine).seconds == 3.0
    with pytest.raises(KitchenFileError, match=told):
        make_process("drying", fine | changes)


def test_time_and_processes_are_seen_as_figures() -> None:
    env = kitchen("FillAndShelve", robots=1)
    seen, _ = env.reset(seed=1)
    size = len(kitchen("HeatOnStove", robots=1).reset(seed=1)[0][A]["observation"])
    start = seen[A]["observation"]
    assert np.count_nonzero(start[size:]) == 0, "nothing goes on yet"
    play(env, *row(A, f"{FILL}; wait"))
    now = env._vectors()[A][size:]
    assert np.count_nonzero(now) == 1 and now.max() == pytest.approx(5.0 / 25.0)
