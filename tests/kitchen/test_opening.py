"""What opens low down is in nobody's way: layouts where it would be are refused, and hands pass it in physics."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from test_oven import RICH, ROBOT, run

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.errors import KitchenFileError
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.fixtures.door import OPEN_TO
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.tasks.goals import Inside
from remac_env.tasks.spec import Role, TaskSpec

TEXT = (Path(__file__).resolve().parents[2] / "examples" / "drawer_kitchen.toml").read_text()
_WHOLE = '{ name = "left", x = [-2.15, -1.15], fronts = ["doors", "drawers"] }'
_HALVES = (
    '{ name = "left", x = [-2.15, -1.87], fronts = ["door"] }',
    '{ name = "by_stove", x = [-1.37, -1.15], fronts = ["door"] }',
)
CABINET = TEXT.replace(_WHOLE, ", ".join(_HALVES))
"""The example's kitchen with room for a drawer under the cabinet."""


def parse(text: str) -> layouts.Layout:
    return layouts.parse(text, name="broken", file="broken.toml", certified=False)


def test_a_drawer_under_a_cabinet_is_refused() -> None:
    """Whether it has the cabinet's station, or one beside it that is too near."""
    under = CABINET.replace('x = [3.25, 3.75]\nstation = "drawer"', 'x = [-1.87, -1.37]\nstation = "cabinet"')
    assert under.count("[-1.87, -1.37]") == 1
    with pytest.raises(KitchenFileError, match=r"fixtures.drawer: opens at .* before station cabinet, .* at cabinet"):
        parse(under)
    parse(TEXT)
    parse(CABINET)


def test_a_drawer_that_reaches_before_the_next_station_is_refused() -> None:
    beside = TEXT.replace("drawer = { at = [3.50, -0.85] }", "drawer = { at = [3.46, -0.85] }")
    beside = beside.replace("x = [1.20, 3.25]", "x = [1.20, 3.02]").replace("x = [3.25, 3.75]", "x = [3.02, 3.75]")
    with pytest.raises(KitchenFileError, match=r"before station microwave, where robots work at microwave"):
        parse(beside)


@pytest.mark.parametrize("name", RICH)
def test_whoever_opens_something_low_has_a_station_of_its_own(name: str) -> None:
    layout = layouts.load(name)
    for fixture in (layout.fixtures["drawer"], layout.fixtures["oven"]):
        sharing = [f.name for f in layout.fixtures.values() if set(f.stations) & set(fixture.stations)]
        assert sharing == [fixture.name]


@pytest.mark.long
@pytest.mark.parametrize("opened", ["drawer", "oven"])
@pytest.mark.parametrize("name", RICH)
def test_with_something_low_open_all_else_can_be_worked(name: str, opened: str) -> None:
    """Cabinets and microwave, each with a tomato: they are opened, filled, emptied and shut."""
    roles = (Role("tomato", ("tomato",)),)
    spec = TaskSpec("Chain", ("", "", ""), Inside("{tomato}", "fridge"), roles, (), distractors=(0, 0))
    worlds = TaskWorlds(spec, name)
    start, _ = worlds.start(120820, style=None, layout=name, starts="paper", robots=(ROBOT,), perception_noise=0.0)
    backend, angles = PhysicsBackend(worlds), {**start.doors, opened: OPEN_TO}
    backend.reset(replace(start, world=start.world.with_fixture(opened, door="open"), doors=angles))
    for fixture in ("cabinet", "cupboard", "microwave"):
        texts = [f"navigate to {fixture}", f"open {fixture} door", "navigate to tomato", "pick up tomato"]
        texts += [f"navigate to {fixture}", f"place to {fixture}", "pick up tomato", "navigate to counter"]
        texts += ["place to counter", f"navigate to {fixture}", f"close {fixture} door"]
        assert run(backend, worlds, texts) == [None] * len(texts), fixture
