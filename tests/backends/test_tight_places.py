"""Where there is little room: a neighbour that stands off its own slot, and a wall that is grazed between two looks."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import skills

import remac_env
from remac_env.backends.physics.controllers.scripted import paths, place
from remac_env.backends.physics.controllers.scripted.paths import Planner
from remac_env.backends.physics.controllers.scripted.verdicts import FREE, Free, Hit
from remac_env.robots import bodies

CHAINS = {chain["name"]: chain for chain in tomllib.loads(skills.CHAINS.read_text("utf-8"))["chain"]}


class Wall:
    """A collision checker of an arm whose second joint meets a thin wall."""

    def __init__(self) -> None:
        self.robot = SimpleNamespace(kinematics=None, body=bodies.get())
        self._wide = False

    @contextmanager
    def clearance(self, margin: float) -> Iterator[None]:
        self._wide = True
        yield
        self._wide = False

    def free(self, q: np.ndarray, joints: object = None) -> Free | Hit:
        return Hit("arm", "wall") if self._wide or 1.01 < q[5] < 1.03 else FREE


def between() -> list[np.ndarray] | Hit:
    """The way of the arm over the wall, which usual looks 0.05 rad apart miss."""
    planner = Planner(cast(Any, Wall()), np.random.default_rng(0))
    start, end = np.zeros(11), np.zeros(11)
    start[5], end[5] = 0.005, 2.0
    assert planner.edge(start, end)
    return planner.path(start, end, via=False, tree=False)


def test_a_tight_way_is_looked_at_closely(monkeypatch: pytest.MonkeyPatch) -> None:
    assert between() == Hit("arm", "wall")
    monkeypatch.setattr(paths, "_DENSE", 0.05)
    assert isinstance(between(), list)


@pytest.mark.long
def test_a_bowl_is_set_down_beside_a_plate_that_stands_near(monkeypatch: pytest.MonkeyPatch) -> None:
    def placed() -> list[str]:
        trials = skills.run_chain(CHAINS["sink"], 151026, style=None, layout=None, perception_noise=0.0)
        outcomes = [trial.outcome for trial in trials if trial.label == "place bowl to counter"]
        return [str(outcome.reason) for outcome in outcomes if outcome is not None]

    assert placed() == ["None"]
    monkeypatch.setattr(place, "_ASIDE", ())
    assert placed() == ["blocked"]


@pytest.mark.long
def test_a_hand_that_reaches_into_a_basin_does_not_land_on_its_wall() -> None:
    env = remac_env.parallel_env("DefrostInBowl", robots=1, starts="mixed")
    env.reset(seed=151227)
    for text in ("navigate to bell pepper", "turn on faucet", "pick up bell pepper"):
        *_, infos = env.step({"robot_0": env.vocabulary.encode(text)})
        assert infos["robot_0"]["outcome"]["status"] == "success", text
    env.close()
