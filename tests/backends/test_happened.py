"""What happened counts, not what a controller says: buttons by their travel, seasoning by a shaker that was shaken."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from physics_kit import ROBOT, command, kitchen, run

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.scripted import dispatch, season
from remac_env.backends.physics.controllers.scripted.skill import Steps
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.happened import Happened
from remac_env.rules.marks import SEASONED
from remac_env.state import WorldState

MEAT = {"meat": "counter", "seasoning": "counter"}
BEFORE_SEASONING = ["navigate to seasoning", "pick up seasoning", "navigate to meat"]


def idle(here: Workspace, *args: object, **options: object) -> Steps:
    """A motion that does nothing and says that all went well."""
    for _ in range(20):
        yield here.robot.command


def runs(world: WorldState) -> bool:
    return bool(world.fixtures["microwave"].on)


def test_a_microwave_whose_button_nobody_pressed_stays_off(monkeypatch: pytest.MonkeyPatch) -> None:
    backend, _, worlds = kitchen({"mug": "counter"}, 120600)
    assert run(backend, worlds, ["navigate to microwave"]) == [None]
    with monkeypatch.context() as patch:
        patch.setattr(dispatch, "work", idle)
        assert run(backend, worlds, ["turn on microwave"]) == ["slipped"]
        assert not runs(backend.world)
    assert run(backend, worlds, ["turn on microwave"]) == [None] and runs(backend.world)
    with monkeypatch.context() as patch:
        patch.setattr(dispatch, "work", idle)
        assert run(backend, worlds, ["turn off microwave"]) == ["slipped"]
        assert runs(backend.world), "and it goes on running"
    assert run(backend, worlds, ["turn off microwave"]) == [None] and not runs(backend.world)


def test_a_door_that_opens_stops_it() -> None:
    backend, _, worlds = kitchen({"mug": "counter"}, 120601)
    assert run(backend, worlds, ["navigate to microwave", "turn on microwave"]) == [None, None]
    assert runs(backend.world)
    assert run(backend, worlds, ["open microwave door"]) == [None]
    assert not runs(backend.world)
    assert run(backend, worlds, ["turn on microwave"]) == ["blocked"]
    assert not runs(backend.world), "pressed while its door stood open"


@pytest.fixture
def button() -> Iterator[tuple[PhysicsBackend, Happened]]:
    backend, _, _ = kitchen({"mug": "counter"}, 120602)
    yield backend, backend._begun()._truth.happened


def press(backend: PhysicsBackend, happened: Happened, travel: float, periods: int = 4) -> None:
    """Hold the button in by so much (m), then let go."""
    address = int(backend.model.joint("microwave/button").qposadr[0])
    for depth in (travel, 0.0):
        for _ in range(periods):
            backend.data.qpos[address] = depth
            happened.update()


def test_only_its_travel_counts(button: tuple[PhysicsBackend, Happened]) -> None:
    backend, happened = button
    press(backend, happened, 0.004)
    assert not happened.running, "touched, not pressed"
    press(backend, happened, 0.010)
    assert happened.running == {"microwave"}
    press(backend, happened, 0.010)
    assert not happened.running, "the button that starts it stops it"
    press(backend, happened, 0.010, periods=1)
    assert happened.running == {"microwave"}
    press(backend, happened, 0.010, periods=1)
    assert happened.running == {"microwave"}, "a button that bounces is pressed once"


def seasoned(world: WorldState) -> bool:
    return SEASONED in world.objects["meat"].marks


def test_only_a_shaken_shaker_seasons(monkeypatch: pytest.MonkeyPatch) -> None:
    backend, _, worlds = kitchen(MEAT, 120603)
    assert run(backend, worlds, BEFORE_SEASONING) == [None] * 3
    with monkeypatch.context() as patch:
        patch.setattr(dispatch, "season", idle)
        assert run(backend, worlds, ["season meat"]) == ["slipped"]
    with monkeypatch.context() as patch:
        patch.setattr(season, "_SHAKES", 0)
        assert run(backend, worlds, ["season meat"]) == ["slipped"], "held over it, but not shaken"
    assert not seasoned(backend.world)
    assert run(backend, worlds, ["season meat"]) == [None]
    assert seasoned(backend.world)


def test_grains_fall_where_the_shaker_is(monkeypatch: pytest.MonkeyPatch) -> None:
    backend, _, worlds = kitchen(MEAT, 120604)
    assert run(backend, worlds, BEFORE_SEASONING) == [None] * 3
    aside, over = np.array([0.32, 0.0, 0.0]), season._over
    monkeypatch.setattr(season, "_over", lambda here, at: over(here, at + aside))
    outcome = backend.run_round({ROBOT: command(worlds, "season meat")}).outcomes[ROBOT]
    assert outcome.reason == "slipped" and not seasoned(backend.world), outcome


def test_a_shaker_that_is_only_carried_seasons_nothing() -> None:
    backend, _, worlds = kitchen({"seasoning": "counter", "mug": "counter"}, 120605)
    assert run(backend, worlds, ["navigate to seasoning", "pick up seasoning", "navigate to mug"]) == [None] * 3
    assert not backend._begun()._truth.happened.marks
