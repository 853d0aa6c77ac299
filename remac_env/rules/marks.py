"""What happens to objects and cannot be seen from where they are."""

from __future__ import annotations

from remac_env.rules.facts import Rules
from remac_env.state import WorldState, supports

WASHED = "washed"
"""The mark of an object on which water has run."""

SEASONED = "seasoned"
"""The mark of an object over which a shaker was shaken."""


FILLED = "filled"
"""The mark of a vessel into which water has run until it was full."""

HEATED, COOLED, DRIED = "heated", "cooled", "dried"
"""Marks that fixtures give (`FixtureFacts.gives`) in kitchens whose tasks ask for them."""


def too_early(first: str, then: str) -> str:
    """The mark of an object to which `then` has happened, and `first` had not."""
    return f"{then} before {first}"


def washed(rules: Rules, world: WorldState) -> WorldState:
    """The world with the mark `washed` on whatever washable object stands under running water, unless it takes time."""
    if WASHED in rules.slow:
        return world
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


def given(rules: Rules, world: WorldState) -> WorldState:
    """The world with the marks on whatever is in fixtures that give one and are at work.

    One with switches works while it is on, a burner for itself; one with a door alone while it is shut; any other
    always. What needs a vessel there is not marked without one.
    """
    for facts in rules.givers:
        state = world.fixtures[facts.name]
        if facts.gives in rules.slow:
            continue
        if not (state.on if facts.switches else state.door in (None, "closed")):
            continue
        for obj, item in world.objects.items():
            if facts.gives in item.marks or item.place.relation in ("held", "floor"):
                continue
            if item.place.relation == "slot" and item.place.where not in facts.slots:
                continue
            around = supports(rules, world, obj)
            bare = len(around) == 2 and facts.kind in rules.objects[obj].needs_vessel_in
            lit = not facts.switch_per_slot or any(slot in state.on for slot in around)
            if facts.name in around and lit and not bare:
                world = world.with_object(obj, marks=item.marks | {facts.gives})
    return world


def ordered(rules: Rules, world: WorldState) -> WorldState:
    """The world with a mark on whatever was marked in the wrong order."""
    for first, then in rules.orders:
        early = too_early(first, then)
        for obj, item in world.objects.items():
            if then in item.marks and first not in item.marks and early not in item.marks:
                world = world.with_object(obj, marks=item.marks | {early})
    return world
