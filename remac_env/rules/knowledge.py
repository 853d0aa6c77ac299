"""What a team knows of a kitchen, with knowledge="seen": the objects that one of its robots has seen.

A robot sees what stands in the open, from wherever it is, and what is behind a door where it stands with that door
open. What one has seen it has told the others, and since nobody else moves anything, who has seen an object knows where
it is.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

from remac_env.frozen import FrozenMap
from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.state import WorldState, base_place

NONE_ENDED: Mapping[str, Outcome] = FrozenMap({})


def in_view(rules: Rules, world: WorldState) -> frozenset[str]:
    """The objects that some robot sees now."""
    return frozenset(name for name in world.objects if _visible(rules, world, name))


def _visible(rules: Rules, world: WorldState, name: str) -> bool:
    place = base_place(world, name)
    if place.relation != "slot":
        return True
    slot = rules.slots[place.where]
    door = world.fixtures[slot.fixture].door
    return door is None or (door == "open" and any(robot.station in slot.stations for robot in world.robots.values()))


def as_known(world: WorldState, seen: Collection[str]) -> WorldState:
    """The world without what nobody has seen."""
    if len(seen) >= len(world.objects):
        return world
    known = FrozenMap({name: item for name, item in world.objects.items() if name in seen})
    return WorldState(world.robots, known, world.fixtures)


def held_back(
    subtasks: Mapping[str, Subtask], unseen: Collection[str], others: Mapping[str, Outcome] = NONE_ENDED
) -> tuple[dict[str, Subtask], dict[str, Outcome]]:
    """Subtasks with `wait` in place of those about an object that nobody has seen, and how these end, beside others."""
    strange = {robot: subtask.target for robot, subtask in subtasks.items() if subtask.target in unseen}
    told = {r: failure("not_found", f"nobody has seen the {name} yet", refused=True) for r, name in strange.items()}
    return {robot: WAIT if robot in strange else subtask for robot, subtask in subtasks.items()}, {**others, **told}
