"""What follows from a base's footprint: for the standard one the numbers that were measured with, for others theirs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import remac_env
from remac_env.errors import KitchenFileError
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import layout_checks
from remac_env.kitchen.parking import for_robots
from remac_env.robots import bodies, footprints
from remac_env.robots.panda.body import Panda

STANDARD = bodies.get().footprint
LONG, ACROSS = ((-0.2, -0.3), (0.8, 0.3)), ((-0.3, -0.6), (0.3, 0.2))


@pytest.fixture
def wide() -> Iterator[Panda]:
    """A body whose base is 1.1 m wide and long."""
    body = Panda(name="wide panda")
    body.footprint = ((-0.55, -0.55), (0.55, 0.55))
    bodies.register_body(body)
    yield body
    bodies._BODIES.pop(body.name)


def test_the_standard_body_has_the_measures_that_skills_were_measured_with() -> None:
    middle, half = footprints.middle_and_half(STANDARD)
    assert middle.tolist() == [-0.135, 0.0] and half.tolist() == [0.285, 0.24]
    middles, radius = footprints.cores(STANDARD)
    assert middles.tolist() == [[-0.18, 0.0], [-0.09, 0.0]] and radius == 0.23
    assert footprints.radius(STANDARD) == 0.49 and layout_checks.station_gap() == 0.84


@pytest.mark.parametrize("footprint", [STANDARD, LONG, ACROSS])
def test_circles_lie_within_the_base_and_the_base_within_its_radius(footprint: footprints.Footprint) -> None:
    low, high = np.array(footprint)
    middles, radius = footprints.cores(footprint)
    assert radius > 0.2
    assert (middles - radius >= low).all() and (middles + radius <= high).all()
    corners = [(x, y) for x in (low[0], high[0]) for y in (low[1], high[1])]
    assert all(np.hypot(*corner) <= footprints.radius(footprint) for corner in corners)


def test_a_kitchen_without_room_for_a_wide_base_is_refused(wide: Panda) -> None:
    name = "one_wall_small"
    layout = layouts.load(name)
    assert for_robots(layout, 2) is layout
    with pytest.raises(KitchenFileError, match=r"one_wall_small\.toml \(body 'wide panda'\): stations"):
        for_robots(layout, 2, wide.name)
    env = remac_env.parallel_env("OpenCabinetPnP", backend="symbolic", body=wide.name, layout=name)
    with pytest.raises(KitchenFileError, match="wide panda"):
        env.reset(seed=1)
