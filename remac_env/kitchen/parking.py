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
from remac_env.kitchen.layout_checks import FREE_FRONT, check_places, check_team, floor
from remac_env.robots import bodies
from remac_env.robots.bodies import STANDARD
from remac_env.robots.footprints import radius

LEAST_APART, MOST_APART = 1.1, 1.4
"""Between the axes of two robots in a row, m."""

_CLEAR = 1.1  # m from the axis of a robot in a row to fixtures: it turns and drives off past its neighbours
_OFF = 0.13  # m by which robots may stand off their places
_STEP = 0.1  # m between rows that are looked at


@cache
def for_robots(layout: Layout, robots: int, body: str = STANDARD) -> Layout:
    """The layout with a parking place for each of so many robots of a body; the same one where it has them.

    Raises:
        KitchenFileError: where its file has too few, and there is no room for a row of them; or where robots of another
            body than the standard one, for which layouts are checked when they are read, have no room in it.
    """
    if robots <= len(layout.asides):
        if body != STANDARD:
            check_places(layout, _file(layout, body), body)
        return layout
    if robots <= len(layout.team_asides):
        made = replace(layout, asides=layout.team_asides[:robots])
        if body != STANDARD:
            check_team(made, _file(layout, body), body)
        return made
    problem = f"none, and no row of {robots} parking places has room in front of the room"
    for places in _rows(layout, robots, body):
        made = replace(layout, asides=places)
        try:
            check_team(made, _file(layout, body), body)
        except KitchenFileError as error:
            problem = str(error)
        else:
            return made
    raise KitchenFileError(_file(layout, body), "team_asides", problem)


def _file(layout: Layout, body: str) -> str:
    """What errors call the layout's file; with the body, unless that is the standard one."""
    return f"{layout.name}.toml" + (f" (body {body!r})" if body != STANDARD else "")


def _rows(layout: Layout, robots: int, body: str) -> Iterator[tuple[Station, ...]]:
    """Rows of robots side by side that face the back wall, nearest first."""
    (left, right), front = layout.room.x, layout.room.front
    room = right - left - 2 * (radius(bodies.get(body).footprint) + _OFF)
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
