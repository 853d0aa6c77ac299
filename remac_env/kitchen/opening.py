"""What comes out of a fixture low down when it is opened stands where hands and bases go: nobody else works there."""

from __future__ import annotations

from remac_env.errors import KitchenFileError
from remac_env.kitchen.fixtures.base import COUNTER_Z, Fixture
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.layout_checks import WORK_HALF

OUT = 0.15
"""How far, m, something low may come out of the fronts without being in the way."""


def check_opening(layout: Layout, file: str) -> None:
    """Raise KitchenFileError where an open drawer or oven is in front of a fixture that robots work at.

    The skill table does not know of it: by its rules an open drawer keeps no hand out of the cabinet above. What opens
    above the worktops, where `_check_sweep` of layout_checks keeps it clear of other fixtures, is not meant.
    """
    for fixture in layout.fixtures.values():
        low = [x for x, y, z in fixture.swept_points if y < -OUT and z < COUNTER_Z]
        if not low:
            continue
        for station in layout.stations.values():
            worked = [other.name for other in layout.fixtures.values() if _worked(other, station, fixture)]
            x, _ = layout.frame(fixture.name).local(station.x, station.y)
            if worked and station.wall == fixture.wall and min(low) < x + WORK_HALF and max(low) > x - WORK_HALF:
                key, at = f"fixtures.{fixture.name}", f"x [{min(low):.3f}, {max(low):.3f}]"
                raise KitchenFileError(
                    file,
                    key,
                    f"opens at {at} before station {station.name}, where robots work at {', '.join(worked)}",
                    f"more than {WORK_HALF} m to the side of x {x:.3f}",
                )


def _worked(other: Fixture, station: Station, fixture: Fixture) -> bool:
    handled = other.door or bool(other.switches) or bool(other.slots)
    return other is not fixture and handled and station.name in other.stations
