"""Parking places for teams: where the file has too few, a row with room for all; places without room are refused."""

from __future__ import annotations

from itertools import combinations

import pytest

from remac_env.errors import KitchenFileError
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.layout_checks import check_team
from remac_env.kitchen.parking import LEAST_APART, for_robots

NAME = "one_wall_large"
TEXT = (layouts.FOLDER / f"{NAME}.toml").read_text(encoding="utf-8")


def parse(team: str) -> layouts.Layout:
    return layouts.parse(f"{TEXT}\n[team_asides]\n{team}\n", name="own", file="own.toml")


@pytest.mark.parametrize("name", layouts.names())
def test_every_shipped_layout_has_room_for_four(name: str) -> None:
    layout = layouts.load(name)
    assert for_robots(layout, 1) is for_robots(layout, 2) is layout
    for robots in (3, 4):
        made = for_robots(layout, robots)
        assert len(made.asides) == robots and made is for_robots(layout, robots)
        assert all(one.distance(other) >= LEAST_APART - 1e-3 for one, other in combinations(made.asides, 2))
        check_team(made, name)


def test_a_file_may_say_the_places_of_a_team() -> None:
    places = "\n".join(f"p{i} = {{ at = [{-1.8 + 1.2 * i}, -6.0], yaw = 1.57 }}" for i in range(4))
    layout = parse(places)
    assert [place.name for place in for_robots(layout, 3).asides] == ["p0", "p1", "p2"]
    assert [place.name for place in for_robots(layout, 2).asides] == ["aside_left", "aside_right"]


def test_places_in_which_a_team_shuts_itself_in_are_refused() -> None:
    """Two before the mouth of a kitchen, and a third behind them."""
    layout = layouts.load("u_shaped_small")
    y = layout.asides[-1].y
    text = (layouts.FOLDER / "u_shaped_small.toml").read_text(encoding="utf-8")
    row = "\n".join(f"p{i} = {{ at = [{x}, {y}], yaw = 1.57 }}" for i, x in enumerate((-0.6, 0.6)))
    behind = f"p2 = {{ at = [0.0, {y - 1.2}], yaw = 1.57 }}"
    with pytest.raises(KitchenFileError, match=r"team_asides\.p.*cannot be reached from there past robots at p"):
        layouts.parse(f"{text}\n[team_asides]\n{row}\n{behind}\n", name="own", file="own.toml")


def test_a_room_without_space_in_front_says_so() -> None:
    wide = layouts.load("galley")
    with pytest.raises(KitchenFileError, match=r"galley\.toml.*no row of 9 parking places"):
        for_robots(wide, 9)
