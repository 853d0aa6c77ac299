"""Where there is room for what a hand holds, as the robot sees it: nothing here asks the skill table.

What stands where is read from poses as seen, and whether an object lies in a dish from its colliders; whether the hand
gets there is then tried. Two rules are the robot's own, from the catalogue that it was certified with, and no matter of
geometry (`forbidden`): only food is put into dishes, and nothing is put where no hand is sure to take it up again.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from remac_env.backends.physics.controllers.scripted.skill import lowest
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.snapshot import slot_under, vessel_around
from remac_env.kitchen.fixtures import Slot
from remac_env.kitchen.objects.catalogue import DISH_ROOM, EDIBLE, Category
from remac_env.robots.rotation import Array, about_x, about_y

_AIR = 0.001  # m by which an object may be larger than a dish's room and still lie in it


@dataclass(frozen=True)
class Spot:
    """A place with room: the slot, the vessel in it (None where the slot itself is meant), and the point (3,) there.

    The point is in the robot's frame, m: where the lowest point of the object comes to be.
    """

    slot: Slot
    vessel: str | None
    point: Array


def forbidden(obj: Category, kind: str, dish: Category | None) -> str | None:
    """Why an object is not put on or into a fixture of this kind, or a dish there, as a rule; None where it may be.

    There may be room all the same, and a hand may find a way in; but it often cannot take out what it put in.
    """
    if kind in obj.too_big_for or (dish is not None and kind in dish.too_deep_in):
        return f"no hand is sure to take the {obj.name} out again"
    if dish is not None and obj.group not in EDIBLE:
        return f"the {obj.name} is no food"
    return None


def free_slot(here: Workspace, slots: Sequence[str], lit: Collection[str]) -> Slot | None:
    """The first of these slots on which nothing is seen, a lit one before others."""
    taken = seen_on_slots(here)
    free = sorted((name for name in slots if name not in taken), key=lambda name: name not in lit)
    return here.kitchen.layout.slots[free[0]] if free else None


def vessels_on(here: Workspace, slots: Sequence[str], kind: str) -> Iterator[tuple[Slot, str]]:
    """The vessels that are seen on these slots and belong on fixtures of this kind, each with its slot."""
    taken, known = seen_on_slots(here), here.kitchen
    for slot in slots:
        yield from ((known.layout.slots[slot], n) for n in taken.get(slot, ()) if kind in known.objects[n].vessel_in)


def spot_in(here: Workspace, slot: Slot, vessel: str | None, body: str) -> Spot | None:
    """The spot on a free slot or in a vessel there; None where that is full or the object would stand out of it."""
    if vessel is None:
        if not here.kitchen.fixture(slot.fixture).takes(here.kitchen.objects[body].size):
            return None
        opened = max(here.sensed.reading(slot.fixture).door_angles, default=0.0)
        center = np.array(slot.center) + here.kitchen.fixture(slot.fixture).shift(opened)
        return Spot(slot, None, here.sensed.located(slot.fixture, center))
    inner = [name for name in here.kitchen.objects if name != body and _around(here, name) == vessel]
    if len(inner) >= here.kitchen.objects[vessel].holds or not lies_in_dish(here, body):
        return None
    floor = np.array([0.0, 0.0, here.kitchen.objects[vessel].inside_height])
    return Spot(slot, vessel, here.sensed.pose(vessel).position + floor)


def lies_in_dish(here: Workspace, body: str) -> bool:
    """Whether the colliders of an object are small enough to lie in a dish without standing out of it."""
    turns = (about_y(0.5 * math.pi), about_x(0.5 * math.pi), np.eye(3))
    # What reaches below the frame of a mirrored object reaches above that of the object itself.
    halves = (0.5 * (lowest(here, body, turn) + lowest(here, body, -turn)) for turn in turns)
    return all(half <= room + _AIR for half, room in zip(halves, DISH_ROOM, strict=True))


def seen_on_slots(here: Workspace) -> dict[str, list[str]]:
    """Slot -> what is seen on it, with all that lies in a vessel there; no entry where nothing is seen."""
    layout, found = here.kitchen.layout, dict[str, list[str]]()
    for body, obj in here.kitchen.objects.items():
        if body == here.hand.body or body in here.hand.contents:
            continue
        bottom = here.sensed.in_room(body).position - [0.0, 0.0, obj.rest_height]
        slot = slot_under(layout, bottom, partial(_off, here))
        if slot is not None:
            found.setdefault(slot, []).append(body)
    return found


def _off(here: Workspace, slot: str) -> Array:
    """By how much (3,) a slot seems to be off, m, world frame."""
    off = here.sensed.off(here.kitchen.layout.slots[slot].fixture, np.array(here.kitchen.layout.middle(slot)))
    return off + here.sensed.senses.moved(slot)


def _around(here: Workspace, body: str) -> str | None:
    """The vessel in or on which an object is seen."""
    return vessel_around(here.sensed, here.kitchen.objects, body, here.sensed.pose(body).position)
