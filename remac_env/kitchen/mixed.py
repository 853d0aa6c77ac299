"""Changes to a start that make planning, not memory, count: `starts="mixed"`.

Derived from the goal alone: doors ajar or open, a vessel in place or occupied, a switch already on, the target behind
another door. Figures are probabilities, chosen so that about one start in ten is unchanged.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from remac_env.state import ObjectState, Place, Scene, door_state, occupant
from remac_env.tasks.goals import Goal, Inside, SwitchedOn

if TYPE_CHECKING:
    from remac_env.kitchen.starts import Draft

DOOR_ODDS = {"closed": 0.45, "ajar": 0.20, "open": 0.35}
AJAR = (0.20, 0.60)
"""Angles of a door that stands ajar, rad."""
OPENED = 1.45
"""Angle to which robots open doors, rad."""
IN_PLACE = 0.35
OCCUPIED = 0.20
SWITCHED = 0.30
BEHIND_DOOR = 0.20


def vary(draft: Draft, goal: Goal, target: str, rng: np.random.Generator) -> None:
    """Change the draft's world and doors in place; `target` is the noun of the task's first role."""
    scene = draft.scene
    for name, facts in scene.fixtures.items():
        if facts.door:
            _set_door(draft, name, str(rng.choice(list(DOOR_ODDS), p=list(DOOR_ODDS.values()))), rng)
    inside = [atom for atom in goal.atoms() if isinstance(atom, Inside)]
    for atom in (a for a in inside if a.container in scene.fixtures and scene.objects[a.name].holds):
        draws = rng.random(2)
        slots = scene.fixtures[atom.container].slots
        if draws[0] < IN_PLACE and slots and occupant(draft.world, slots[0]) is None:
            _move(draft, atom.name, Place("slot", slots[0]))
        if draws[1] < OCCUPIED:
            _occupy(draft, atom.name, (target, *goal.names()), rng)
    for switch in (a for a in goal.atoms() if isinstance(a, SwitchedOn)):
        if rng.random() < SWITCHED:
            _switch_on(draft, switch)
    if rng.random() < BEHIND_DOOR:
        _hide(draft, goal, target, rng)


def _set_door(draft: Draft, fixture: str, state: str, rng: np.random.Generator) -> None:
    if state != "closed":
        draft.doors[fixture] = float(rng.uniform(*AJAR)) if state == "ajar" else OPENED
    draft.world = draft.world.with_fixture(fixture, door=door_state(draft.doors[fixture]))


def _move(draft: Draft, noun: str, place: Place) -> None:
    draft.world = draft.world.with_object(noun, place=place)


def _occupy(draft: Draft, vessel: str, wanted: tuple[str, ...], rng: np.random.Generator) -> None:
    """Something small that the goal does not speak of lies in the vessel."""
    scene, world = draft.scene, draft.world
    loose = [n for n, state in world.objects.items() if _is_loose(scene, n, state) and n not in (vessel, *wanted)]
    if loose:
        _move(draft, loose[int(rng.integers(len(loose)))], Place("vessel", vessel))


def _is_loose(scene: Scene, noun: str, state: ObjectState) -> bool:
    return state.place.relation == "slot" and scene.objects[noun].small


def _switch_on(draft: Draft, goal: SwitchedOn) -> None:
    facts = draft.scene.fixtures[goal.fixture]
    if facts.shut_to_run and draft.world.fixtures[goal.fixture].door != "closed":
        return
    switch = facts.switches[0]
    if goal.under and (slot := draft.world.objects[goal.under].place.where) in facts.switches:
        switch = slot
    draft.world = draft.world.with_fixture(goal.fixture, on=frozenset({switch}))


def _hide(draft: Draft, goal: Goal, target: str, rng: np.random.Generator) -> None:
    """The target stands behind a door that the goal does not speak of."""
    scene, world = draft.scene, draft.world
    spots = [
        slot
        for name, facts in scene.fixtures.items()
        if facts.door and name not in goal.names()
        for slot in facts.slots
        if occupant(world, slot) is None
    ]
    if spots:
        _move(draft, target, Place("slot", spots[int(rng.integers(len(spots)))]))
