"""Vessels are carried level: leaning, a pan turns in the fingers, and what lies in a bowl slides out of it."""

from __future__ import annotations

import math

import pytest
from physics_kit import kitchen, run

from remac_env.backends.physics.controllers.scripted import reach


def leans(seed: int) -> float:
    """By how much (rad) a bowl leans at most while it is put into the sink."""
    backend, _, worlds = kitchen({"bowl": "counter"}, seed, style="transitional_1")
    assert run(backend, worlds, ["navigate to bowl", "pick up bowl", "navigate to sink"]) == [None] * 3
    upright: list[float] = []
    backend.watch = lambda: upright.append(float(backend.data.body("bowl").xmat[8]))
    assert run(backend, worlds, ["place to sink"]) == [None]
    return math.acos(min(upright))


def test_a_bowl_is_put_into_the_sink_without_leaning(monkeypatch: pytest.MonkeyPatch) -> None:
    assert leans(46030) < 0.25
    monkeypatch.setattr(reach, "_LEANS", math.pi)  # no matter how
    assert leans(46030) > 0.8
