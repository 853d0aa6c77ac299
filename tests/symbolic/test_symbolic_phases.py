"""Tasks with more than one thing to do: water leaves its mark, and phases count in their order."""

from __future__ import annotations

from typing import Any

import remac_env
from remac_env.rules.marks import WASHED, washed

OPEN = ("navigate to microwave", "open microwave door")
FETCH = ("navigate to vegetable", "pick up vegetable")
SEASON = ("navigate to seasoning", "pick up seasoning", "navigate to vegetable", "season vegetable")


def play(task: str, *commands: str) -> dict[str, Any]:
    """What one robot is told after a row of commands, every one of which has to succeed."""
    env = remac_env.parallel_env(task, robots=1, backend="symbolic")
    _, infos = env.reset(seed=0)
    (robot,) = env.agents
    for command in commands:
        _, _, _, _, infos = env.step({robot: env.vocabulary.encode(command)})
        assert infos[robot]["outcome"]["status"] == "success", command
    return dict(infos[robot])


def done(*commands: str) -> list[bool]:
    """Which of the four phases are done."""
    return list(play("SeasonedMicrowave", *commands)["phases"].values())


def test_phases_count_in_their_order() -> None:
    assert done("navigate aside") == [False] * 4  # the door is closed, but it was not opened before
    assert done(*SEASON) == [False] * 4  # seasoned too early to count yet
    assert done(*OPEN) == [True, False, False, False]
    put_in = (*OPEN, *FETCH, "navigate to microwave", "place to microwave")
    assert done(*put_in) == [True, True, False, False]
    assert done(*put_in, "close microwave door") == [True, True, False, False]
    everything = (*put_in, *SEASON, "navigate to counter", "place to counter", "navigate to microwave")
    assert done(*everything) == [True, True, True, False]
    told = play("SeasonedMicrowave", *everything, "close microwave door")
    assert all(told["phases"].values()) and told["success"]


def test_what_was_seasoned_before_counts_once_it_is_in() -> None:
    first = (*SEASON, "navigate to counter", "place to counter", *OPEN, *FETCH)
    assert done(*first, "navigate to microwave", "place to microwave") == [True, True, True, False]


def test_water_washes_what_is_in_the_sink_and_the_mark_stays() -> None:
    dry = (*FETCH, "navigate to sink", "place to sink")
    assert play("WashPnPHeat", *dry)["world"].objects["vegetable"].marks == set()
    wet = (*dry, "turn on faucet")
    assert play("WashPnPHeat", *wet)["world"].objects["vegetable"].marks == {WASHED}
    taken = play("WashPnPHeat", *wet, "pick up vegetable")
    assert taken["world"].objects["vegetable"].marks == {WASHED}
    assert washed(taken["scene"], taken["world"]) == taken["world"]


def test_water_does_not_wash_what_is_elsewhere_or_in_the_hand() -> None:
    held = play("WashPnPHeat", "navigate to faucet", "turn on faucet", *FETCH, "navigate to sink")
    assert held["world"].objects["vegetable"].marks == set()
