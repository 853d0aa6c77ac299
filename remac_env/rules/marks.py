"""What happens to objects and cannot be seen from where they are."""

from __future__ import annotations

from remac_env.rules.facts import Rules
from remac_env.state import WorldState, supports

WASHED = "washed"
"""The mark of an object on which water has run."""

SEASONED = "seasoned"
"""The mark of an object over which a shaker was shaken."""


def washed(rules: Rules, world: WorldState) -> WorldState:
    """The world with the mark `washed` on whatever washable object stands under running water."""
    for tap, basins in rules.taps:
        if not world.fixtures[tap].on:
            continue
        for obj in rules.washables:
            item = world.objects[obj]
            if WASHED in item.marks or item.place.relation in ("held", "floor"):
                continue
            around = supports(rules, world, obj)
            if any(basin in around for basin in basins):
                world = world.with_object(obj, marks=item.marks | {WASHED})
    return world
