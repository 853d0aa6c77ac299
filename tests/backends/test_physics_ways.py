"""Ways of a base from one wall to another while somebody stands right behind it."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from remac_env.backends.physics.routes import Departure, candidates, sampled
from remac_env.kitchen import layout as layouts
from remac_env.robots import bodies

APART = 0.75
"""m from a robot at its station to the one behind it."""

CLEAR = 0.6
"""m between the middles of two bases, of about half a metre, that pass one another."""

FOOTPRINT = bodies.get().footprint


def nearest(departure: Departure, goal: str, other: np.ndarray) -> dict[str, float]:
    """How near (m) the middle of a base comes to ``other`` (2,) at the best way of each sort."""
    best: dict[str, float] = {}
    for course in candidates(departure, departure.layout.stations[goal]):
        way = np.array([q[:2] for q in sampled(course.corners, bodies.get())])
        distance = float(np.hypot(*(way - other).T).min())
        best[course.sort[1]] = max(best.get(course.sort[1], 0.0), distance)
    return best


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["l_shaped_large", "u_shaped_large", "g_shaped_large"])
def test_somebody_behind_a_robot_is_passed_along_the_wall(name: str) -> None:
    layout = layouts.load(name)
    passed = 0
    for place, goal in permutations(layout.stations.values(), 2):
        frame = layout.facing(place)
        x, y = frame.local(place.x, place.y)
        behind = np.array(frame.point(x, y - APART))
        if place.wall == goal.wall or np.hypot(goal.x - behind[0], goal.y - behind[1]) < 2.0 * APART:
            continue
        q = np.zeros(11)
        q[:3] = place.x, place.y, place.yaw
        alone = nearest(Departure(layout, place, q, footprint=FOOTPRINT), goal.name, behind)
        there = (np.array([*behind, 0.0]),)
        beside = nearest(Departure(layout, place, q, footprint=FOOTPRINT, standing=there), goal.name, behind)
        assert max(alone.values()) < CLEAR < beside["along the wall"], (place.name, goal.name)
        passed += 1
    assert passed > 0
