"""Trials of what was learnt: what comes before them is scripted, and a vessel that fell over was not put down."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from remac_bench.learning import evaluate as trials
from remac_bench.learning.cells import cells
from remac_bench.learning.evaluate import evaluate

from remac_env.backends.physics.controllers.learned.network import Network
from remac_env.backends.physics.controllers.learned.seen import entries
from remac_env.backends.physics.controllers.learned.weights import About, Weights
from remac_env.lowlevel import starts
from remac_env.lowlevel.starts import get_ready
from remac_env.rules.skills import SKILLS

LAID, PUT = "vessel on basin", "food in vessel on basin"


def still(*cases: str) -> Weights:
    """What was shown these cases of putting things down, and stands still in them."""
    inputs, zeros = len(entries(SKILLS["place to"])), np.zeros((8, 12), np.float32)
    layer = (np.zeros((4, inputs), np.float32), *[np.zeros(4, np.float32)] * 3)
    last = (np.zeros((96, 4), np.float32), np.zeros(96, np.float32))
    network = Network(np.zeros(inputs, np.float32), np.ones(inputs, np.float32), (layer,), last, zeros, zeros + 1.0)
    about = About(skill="place to", targets=(), execute=8, cases=tuple(f"place to {case}" for case in cases))
    return Weights(about=about, network=network, sample=np.ones((1, inputs), np.float32))


@pytest.mark.long
def test_what_cannot_lay_a_vessel_is_tried_with_one_that_the_script_has_laid(monkeypatch: pytest.MonkeyPatch) -> None:
    laid = []

    def ready(*args: Any, **options: Any) -> Any:
        found, backend = get_ready(*args, **options)
        laid.extend(step.text for step in found.before if SKILLS[step.skill].puts)
        return found, backend

    monkeypatch.setattr(trials, "get_ready", ready)
    monkeypatch.setattr(starts, "_TRIES", 2)  # were the vessel laid by what stands still, no start would be found
    (trial,) = evaluate("place to", still(PUT, LAID), range(50_000, 50_001), cells("table", ())[0])
    assert trial.case == PUT and laid == ["place to sink"]
    assert not trial.outcome.success, "and then what was learnt has its turn"


def test_a_vessel_on_its_side_does_not_stand_and_food_may_lie_as_it_likes() -> None:
    def stands(name: str, up: float) -> bool:
        body = SimpleNamespace(xmat=np.array([0.0] * 8 + [up]))
        backend: Any = SimpleNamespace(data=SimpleNamespace(body={"pan": body, "fish": body}.__getitem__))
        kinds = {"pan": SimpleNamespace(vessel=True), "salmon": SimpleNamespace(vessel=False)}
        ready: Any = SimpleNamespace(
            worlds=SimpleNamespace(categories=kinds), start=SimpleNamespace(categories={"pan": "pan", "fish": "salmon"})
        )
        return trials._stands(backend, ready, name)

    assert stands("pan", 1.0) and stands("pan", 0.81)
    assert not stands("pan", 0.6) and not stands("pan", -1.0)
    assert stands("fish", 0.0)
