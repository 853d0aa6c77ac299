"""Changes to a start that make planning, not memory, count: `starts="mixed"`.

Derived from the goal alone: doors ajar or open, a vessel in place, occupied or behind a door, its place taken, a switch
already on, the target in its vessel or behind another door. Each change is drawn for itself, so several come together:
the shortest plans for one robot have from 2 to 16 rounds. Figures are probabilities.
"""

from __future__ import annotations

import numpy as np

from remac_env.kitchen.draft import Draft
from remac_env.kitchen.fixtures.door import OPEN_TO
from remac_env.rules.facts import Rules
from remac_env.rules.places import has_room
from remac_env.state import ObjectState, Place, base_place, door_state, occupant
from remac_env.tasks.goals import Goal, Inside, SwitchedOn

DOOR_ODDS = {"closed": 0.45, "ajar": 0.20, "open": 0.35}
AJAR = (0.20, 0.60)
"""Angles of a door that stands ajar, rad."""
IN_PLACE = 0.35
OCCUPIED = 0.20
PUT_AWAY = 0.15
"""Of a vessel that is not in place: behind a door, if it goes in there."""
TAKEN = 0.20
"""Of the only place in a fixture of the goal: something else is there, or in the vessel that belongs there."""
SWITCHED = 0.30
BEHIND_DOOR = 0.20
IN_VESSEL = 0.15
"""Of a target that is not behind a door: in the vessel that the goal wants it in."""


def vary(draft: Draft, goal: Goal, target: str, rng: np.random.Generator) -> None:
    """Change the draft's world and doors in place; `target` is the noun of the task's first role."""
    scene, wanted = draft.scene, (target, *goal.names())
    for name, facts in scene.fixtures.items():
        if facts.door:
            _set_door(draft, name, str(rng.choice(list(DOOR_ODDS), p=list(DOOR_ODDS.values()))), rng)
    inside = [atom for atom in goal.atoms() if isinstance(atom, Inside)]
    places = [atom for atom in inside if atom.container in scene.fixtures]
    for vessel, container in ((a.name, a.container) for a in places if scene.objects[a.name].holds):
        draws = rng.random(3)
        slots = scene.fixtures[container].slots
        if draws[0] < IN_PLACE and slots and occupant(draft.world, slots[0]) is None:
            _move(draft, vessel, Place("slot", slots[0]))
        elif draws[2] < PUT_AWAY:
            _hide(draft, goal, vessel, rng)
        if draws[1] < OCCUPIED:
            _fill(draft, vessel, wanted, rng)
    for atom in places:
        if rng.random() < TAKEN:
            _take_place(draft, atom.container, wanted, rng)
    for switch in (a for a in goal.atoms() if isinstance(a, SwitchedOn)):
        if rng.random() < SWITCHED:
            _switch_on(draft, switch)
    draws = rng.random(2)
    if draws[0] < BEHIND_DOOR:
        _hide(draft, goal, target, rng)
    elif draws[1] < IN_VESSEL:
        for vessel in (atom.container for atom in inside if atom.name == target and atom.container in scene.objects):
            if has_room(scene, draft.world, vessel):
                _move(draft, target, Place("vessel", vessel))


def _set_door(draft: Draft, fixture: str, state: str, rng: np.random.Generator) -> None:
    if state != "closed":
        draft.doors[fixture] = float(rng.uniform(*AJAR)) if state == "ajar" else OPEN_TO
    draft.world = draft.world.with_fixture(fixture, door=door_state(draft.doors[fixture]))


def _move(draft: Draft, noun: str, place: Place) -> None:
    draft.world = draft.world.with_object(noun, place=place)


def _take_place(draft: Draft, container: str, wanted: tuple[str, ...], rng: np.random.Generator) -> None:
    """Something else is in the only slot of a fixture, or in the vessel that stands there."""
    slots = draft.scene.fixtures[container].slots
    if len(slots) != 1:
        return
    there = occupant(draft.world, slots[0])
    if there is None:
        _add(draft, Place("slot", slots[0]), wanted, rng)
    elif draft.scene.objects[there].holds:
        _fill(draft, there, wanted, rng)


def _fill(draft: Draft, vessel: str, wanted: tuple[str, ...], rng: np.random.Generator) -> None:
    """Something small that the goal does not speak of lies in the vessel."""
    if has_room(draft.scene, draft.world, vessel):
        _add(draft, Place("vessel", vessel), (vessel, *wanted), rng)


def _add(draft: Draft, place: Place, wanted: tuple[str, ...], rng: np.random.Generator) -> None:
    """Move something loose, but nothing wanted, from where it lies to a place."""
    scene, world = draft.scene, draft.world
    slot = place.where if place.relation == "slot" else base_place(world, place.where).where
    fixture = scene.fixtures[scene.slots[slot].fixture]
    # Behind doors and in basins hands take hold of fruit and vegetables as surely as of the task's objects, but not of
    # all that is flat or soft.
    sure = place.relation == "vessel" and not fixture.door
    loose = [n for n, state in world.objects.items() if _is_loose(scene, n, state) and n not in wanted]
    loose = [n for n in loose if fixture.kind not in scene.objects[n].too_big_for]
    loose = [n for n in loose if sure or scene.objects[n].washable]
    if loose:
        _move(draft, loose[int(rng.integers(len(loose)))], place)


def _is_loose(scene: Rules, noun: str, state: ObjectState) -> bool:
    return state.place.relation == "slot" and scene.objects[noun].small


def _switch_on(draft: Draft, goal: SwitchedOn) -> None:
    facts = draft.scene.fixtures[goal.fixture]
    if facts.shut_to_run and draft.world.fixtures[goal.fixture].door != "closed":
        return
    switch = facts.switches[0]
    if goal.under and (slot := draft.world.objects[goal.under].place.where) in facts.switches:
        switch = slot
    draft.world = draft.world.with_fixture(goal.fixture, on=frozenset({switch}))


def _hide(draft: Draft, goal: Goal, noun: str, rng: np.random.Generator) -> None:
    """An object stands behind a door that the goal does not speak of."""
    scene, world = draft.scene, draft.world
    spots = [
        slot
        for name, facts in scene.fixtures.items()
        if facts.door and name not in goal.names() and facts.kind not in scene.objects[noun].too_big_for
        for slot in facts.slots
        if occupant(world, slot) is None
    ]
    if spots:
        _move(draft, noun, Place("slot", spots[int(rng.integers(len(spots)))]))
