"""What is handled where, in a few kinds: demonstrations are sorted by it, and a policy is played where it was shown."""

from __future__ import annotations

from collections.abc import Mapping

from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.objects.catalogue import Category
from remac_env.rules.facts import Rules
from remac_env.rules.places import landing
from remac_env.rules.subtasks import Subtask
from remac_env.state import Place, WorldState

NONE = ""
"""The case of a skill that moves nothing but doors and switches."""

IN_VESSEL = " in vessel on "
"""What stands in cases between an object in a vessel and the kind of place where that stands."""

EMPTY_HANDED, CARRYING = "empty-handed", "carrying"
"""The cases of drives."""


def case_of(
    subtask: Subtask, rules: Rules, layout: Layout, objects: Mapping[str, Category], world: WorldState, robot: str
) -> str:
    """The case of a subtask that begins in this world, as "food on surface", "food in vessel on cavity".

    "food" fits into a dish, "object" is neither food nor vessel; the place is told by the kind of its slot.
    """
    row = subtask.row
    if row.moves:
        return EMPTY_HANDED if world.robots[robot].holding is None else CARRYING
    if not (row.takes or row.puts):
        return NONE
    handled = subtask.target if row.takes else world.robots[robot].holding
    if handled is None:
        return NONE
    place = world.objects[handled].place if row.takes else landing(rules, world, robot, subtask.target)
    between, kind = " on ", objects[handled]
    while place is not None and place.relation == "vessel":
        between, place = IN_VESSEL, world.objects[place.where].place
    what = "vessel" if kind.vessel else "food" if kind.small else "object"
    return f"{what}{between}{_around(place, layout)}"


def _around(place: Place | None, layout: Layout) -> str:
    """The kind of a slot; "nothing" where there is none."""
    return layout.slots[place.where].kind if place is not None and place.where in layout.slots else "nothing"
