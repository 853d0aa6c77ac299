"""When rounds begin in a video, though most moments are left out of it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

import remac_env
from remac_env.pictures import Moment, Pictures
from remac_env.rendering.video import STILLS


def pictures() -> Pictures:
    made = Pictures(cast(Any, SimpleNamespace()))
    made.record()
    return made


def test_every_round_begins_somewhere_and_in_order() -> None:
    made = pictures()
    for number in range(5):
        for _ in range(997):
            made.film(lambda number=number: Moment(cast(Any, None), cast(Any, None), None, number))  # type: ignore[misc]
    begins = made.begins(6)
    assert begins == sorted(begins) and len(begins) == 6 and begins[0] == 0.0
    assert begins[1:5] == pytest.approx([each * begins[4] / 4 for each in (1, 2, 3, 4)], abs=2 / STILLS)


def test_nothing_recorded_begins_nowhere() -> None:
    assert pictures().begins(3) == []


def test_the_symbolic_kitchen_tells_its_rounds_and_shows_the_last_world() -> None:
    env = remac_env.parallel_env("HeatOnStove", robots=1, backend="symbolic")
    env.start_recording()
    env.reset(seed=3)
    for command in ("navigate to pan", "pick up pan", "wait"):
        env.step({"robot_0": env.vocabulary.encode(command)})
    assert env.recorded_rounds() == [0.0, round(2 / STILLS, 3), round(4 / STILLS, 3)]
    assert env._pictures._tape is not None and env._pictures._tape.frames[-1].world == env.world
    env.close()
