"""WorldStates as plain JSON values, for the records, and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from remac_env.state import FixtureState, FrozenMap, ObjectState, Place, RobotState, WorldState


def as_values(world: WorldState) -> dict[str, Any]:
    """A world as {"robots": {name: {"station", "holding"}}, "objects": {name: {"place": [relation, where], "marks"}},
    "fixtures": {name: {"door", "on"}}}; sets become sorted lists, so that equal worlds have equal values."""
    return {
        "robots": {n: {"station": robot.station, "holding": robot.holding} for n, robot in world.robots.items()},
        "objects": {
            name: {"place": [item.place.relation, item.place.where], "marks": sorted(item.marks)}
            for name, item in world.objects.items()
        },
        "fixtures": {n: {"door": fixture.door, "on": sorted(fixture.on)} for n, fixture in world.fixtures.items()},
    }


def from_values(values: Mapping[str, Any]) -> WorldState:
    """The world that `as_values` made these values of.

    Raises:
        KeyError, TypeError, ValueError: for values of another form.
    """
    robots = {name: RobotState(robot["station"], robot["holding"]) for name, robot in values["robots"].items()}
    objects = {}
    for name, item in values["objects"].items():
        relation, where = item["place"]
        objects[name] = ObjectState(Place(relation, where), frozenset(item["marks"]))
    fixtures = {name: FixtureState(each["door"], frozenset(each["on"])) for name, each in values["fixtures"].items()}
    return WorldState(FrozenMap(robots), FrozenMap(objects), FrozenMap(fixtures))


def fallen(worlds: Sequence[Mapping[str, Any]]) -> int:
    """How many objects lie on the floor in the last of these worlds (as values) that did not in the first."""
    if not worlds:
        return 0
    first, last = worlds[0]["objects"], worlds[-1]["objects"]
    return sum(last[name]["place"][0] == "floor" != first[name]["place"][0] for name in last)
