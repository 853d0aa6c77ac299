"""Where there is room for what a hand holds, as the robot sees it: nothing here asks the skill table.

What stands where is read from poses as seen, and whether a thing lies in a dish from its colliders; whether the hand
gets there is then tried. Two rules are the robot's own, from the catalogue that it was certified with, and no matter of
geometry (`forbidden`): only food is put into dishes, and nothing is put where no hand is sure to take it up again.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from remac_env.backends.physics.controllers.scripted.skill import Surroundings, lowest
from remac_env.backends.physics.snapshot import slot_under, vessel_around
from remac_env.kitchen.fixtures import Slot
from remac_env.kitchen.objects.catalogue import DISH_ROOM, EDIBLE, Category
from remac_env.robots.rotation import Array, about_x, about_y

_AIR = 0.001  # m by which a thing may be larger than a dish's room and still lie in it


@dataclass(frozen=True)
class Spot:
    """A place with room: the slot, the vessel in it (None where the slot itself is meant), and the point (3,) there.

    The point is in the robot's frame, m: where the lowest point of the thing comes to be.
    """

    slot: Slot
    vessel: str | None
    point: Array


def forbidden(thing: Category, kind: str, dish: Category | None) -> str | None:
    """Why a thing is not put on or into a fixture of this kind, or into a dish there, as a rule; None where it may be.

    There may be room all the same, and a hand may find a way in; but it often cannot take out what it put in.
    """
    if kind in thing.too_big_for or (dish is not None and kind in dish.too_deep_in):
        return f"no hand is sure to take the {thing.name} out again"
    if dish is not None and thing.group not in EDIBLE:
        return f"the {thing.name} is no food"
    return None


def free_slot(here: Surroundings, slots: Sequence[str], lit: Collection[str]) -> Slot | None:
    """The first of these slots on which nothing is seen, a lit one before others."""
    taken = seen_on_slots(here)
    free = sorted((name for name in slots if name not in taken), key=lambda name: name not in lit)
    return here.layout.slots[free[0]] if free else None


def vessels_on(here: Surroundings, slots: Sequence[str], kind: str) -> Iterator[tuple[Slot, str]]:
    """The vessels that are seen on these slots and belong on fixtures of this kind, each with its slot."""
    taken = seen_on_slots(here)
    for slot in slots:
        yield from ((here.layout.slots[slot], n) for n in taken.get(slot, ()) if kind in here.things[n].vessel_in)


def spot_in(here: Surroundings, slot: Slot, vessel: str | None, body: str) -> Spot | None:
    """The spot on a free slot or in a vessel there; None where that is full or the thing would stand out of it."""
    if vessel is None:
        if not here.fixture(slot.fixture).takes(here.things[body].size):
            return None
        opened = max(here.reading(slot.fixture).door_angles, default=0.0)
        center = np.array(slot.center) + here.fixture(slot.fixture).shift(opened)
        return Spot(slot, None, here.simulation.located(slot.fixture, center))
    inner = [name for name in here.things if name != body and _around(here, name) == vessel]
    if len(inner) >= here.things[vessel].holds or not lies_in_dish(here, body):
        return None
    floor = np.array([0.0, 0.0, here.things[vessel].inside_height])
    return Spot(slot, vessel, here.simulation.pose(vessel).position + floor)


def lies_in_dish(here: Surroundings, body: str) -> bool:
    """Whether the colliders of a thing are small enough to lie in a dish without standing out of it."""
    turns = (about_y(0.5 * math.pi), about_x(0.5 * math.pi), np.eye(3))
    # What reaches below the frame of a mirrored thing reaches above that of the thing itself.
    halves = (0.5 * (lowest(here, body, turn) + lowest(here, body, -turn)) for turn in turns)
    return all(half <= room + _AIR for half, room in zip(halves, DISH_ROOM, strict=True))


def seen_on_slots(here: Surroundings) -> dict[str, list[str]]:
    """Slot -> what is seen on it, with all that lies in a vessel there; no entry where nothing is seen."""
    layout, found = here.layout, dict[str, list[str]]()
    for body, thing in here.things.items():
        if body == here.hand.body or body in here.hand.contents:
            continue
        bottom = here.simulation.in_room(body).position - [0.0, 0.0, thing.rest_height]
        slot = slot_under(layout, bottom, partial(_off, here))
        if slot is not None:
            found.setdefault(slot, []).append(body)
    return found


def _off(here: Surroundings, slot: str) -> Array:
    """By how much (3,) a slot seems to be off, m, world frame."""
    off = here.simulation.off(here.layout.slots[slot].fixture, np.array(here.layout.middle(slot)))
    return off + here.simulation.senses.moved(slot)


def _around(here: Surroundings, body: str) -> str | None:
    """The vessel in or on which a thing is seen."""
    return vessel_around(here.simulation, here.things, body, here.simulation.pose(body).position)
