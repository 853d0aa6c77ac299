"""Parking places for teams of any size: those of a layout's file, else a row of them along the open front of the room.

Both are checked: `layout_checks.check_team` says what room they have. No simulator needed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from math import pi

from remac_env.errors import KitchenFileError
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.layout_checks import BASE_RADIUS, FREE_FRONT, check_team, floor

LEAST_APART, MOST_APART = 1.1, 1.4
"""Between the axes of two robots in a row, m."""

_CLEAR = 1.1  # m from the axis of a robot in a row to fixtures: it turns and drives off past its neighbours
_OFF = 0.13  # m by which robots may stand off their places
_STEP = 0.1  # m between rows that are looked at


@cache
def for_robots(layout: Layout, robots: int) -> Layout:
    """The layout with a parking place for each of so many robots; the same one where it has them.

    Raises:
        KitchenFileError: where its file has too few, and there is no room for a row of them.
    """
    if robots <= len(layout.asides):
        return layout
    if robots <= len(layout.team_asides):
        return replace(layout, asides=layout.team_asides[:robots])
    problem = f"none, and no row of {robots} parking places has room in front of the room"
    for places in _rows(layout, robots):
        made = replace(layout, asides=places)
        try:
            check_team(made, f"{layout.name}.toml")
        except KitchenFileError as error:
            problem = str(error)
        else:
            return made
    raise KitchenFileError(f"{layout.name}.toml", "team_asides", problem)


def _rows(layout: Layout, robots: int) -> Iterator[tuple[Station, ...]]:
    """Rows of robots side by side that face the back wall, nearest first."""
    (left, right), front = layout.room.x, layout.room.front
    room = right - left - 2 * (BASE_RADIUS + _OFF)
    apart = min(MOST_APART, room / (robots - 1)) if robots > 1 else MOST_APART
    if apart < LEAST_APART:
        return
    first = 0.5 * (left + right - apart * (robots - 1))
    clear = floor(layout, _CLEAR)
    for number in range(int(FREE_FRONT / _STEP)):
        y = round(front - number * _STEP, 3)
        row = tuple(Station(f"aside_{i}", round(first + i * apart, 3), y, 0.5 * pi) for i in range(robots))
        if all(clear.holds(clear.free, (place.x, y)) for place in row):
            yield row
