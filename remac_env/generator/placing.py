"""Where objects of a generated task are at the start, and how doors and switches stand."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from remac_env.errors import SamplingError
from remac_env.generator.templates import HIDDEN, Template
from remac_env.rules.facts import Rules
from remac_env.state import Door, Place

FREE = 2
"""Slots in the open that stay free, so that whatever is in the way can be put down."""

DOORS: dict[Door, float] = {"closed": 0.6, "ajar": 0.15, "open": 0.25}
"""How often a door stands so, where nothing is hidden behind it."""

ON = 0.15
"""How often a switch is on."""

STRAY = 0.25
"""How often an object that the task needs is somewhere else than where its template has it."""

ELSEWHERE = 0.4
"""How often any other object is not on a worktop: in a store, or where something else is to go."""


@dataclass
class Room:
    """The slots of a kitchen while they are filled.

    Attributes:
        open_slots: those of its worktops.
        too_big: object -> the kinds of fixtures that it does not go into, where fixtures have a shape.
    """

    scene: Rules
    open_slots: list[str]
    too_big: Mapping[str, Collection[str]] = field(default_factory=dict)
    taken: set[str] = field(default_factory=set)

    @property
    def left(self) -> int:
        """Free slots in the open beside those that stay free."""
        return sum(slot not in self.taken for slot in self.open_slots) - FREE

    def free(self, fixtures: Iterable[str], *, spare: int = 0, noun: str = "") -> list[str]:
        """The free slots of fixtures, of worktops none of those that stay free; of others all but so many each. None
        of those that are too small for the object of this name."""
        found: list[str] = []
        too_big = self.too_big.get(noun, ())
        for name in (name for name in fixtures if self.scene.fixtures[name].kind not in too_big):
            slots = [slot for slot in self.scene.fixtures[name].slots if slot not in self.taken]
            if set(slots) <= set(self.open_slots):
                found += slots if self.left > 0 else []
            else:
                found += slots[: max(0, len(slots) - spare)]
        return found

    def take(self, slots: Sequence[str], rng: np.random.Generator) -> Place:
        """One of these slots, which is taken then."""
        slot = slots[int(rng.integers(len(slots)))]
        self.taken.add(slot)
        return Place("slot", slot)


def place_members(
    template: Template,
    members: Mapping[str, Sequence[str]],
    room: Room,
    rng: np.random.Generator,
    *,
    away: Collection[str] = (),
) -> dict[str, Place]:
    """A place of its own for each object that the task needs.

    Args:
        away: those that are behind doors, as far as there is room, wherever the template has them.

    Raises:
        SamplingError: naming the object for which there is no room, and where.
    """
    fixtures = room.scene.fixtures
    closed = stores(room.scene, template)
    open_ones = [n for n, f in fixtures.items() if f.slots and not f.door and not f.switches and not f.gives]
    strays = [*closed, *(n for n in open_ones if n not in template.named and n in template.annexes)]
    places: dict[str, Place] = {}
    for group in template.groups:
        for noun in members[group.kind]:
            if noun in away and (free := room.free(closed, spare=1, noun=noun)):
                places[noun] = room.take(free, rng)
                continue
            at = str(rng.choice(list(group.at)))
            names = closed if at == HIDDEN else [at]
            if rng.random() < STRAY and (free := room.free(strays, spare=1, noun=noun)):
                places[noun] = room.take(free, rng)
                continue
            if not (free := room.free(names, noun=noun)):
                where = "behind a shut door" if at == HIDDEN else f"at the {at}"
                raise SamplingError(f"template {template.name!r}: no room {where} for the {noun}, after {len(places)}")
            places[noun] = room.take(free, rng)
    return places


def stores(scene: Rules, template: Template) -> list[str]:
    """Where things are put away: what has a door and room, no switch, and is not named by the goal."""
    found = ((name, facts) for name, facts in scene.fixtures.items() if name not in template.named)
    return [name for name, facts in found if facts.door and facts.slots and not facts.switches]


def place_others(others: Iterable[str], room: Room, rng: np.random.Generator) -> dict[str, Place]:
    """Places for objects that the task does not need, as far as there is room."""
    fixtures = room.scene.fixtures
    away = [name for name, facts in fixtures.items() if len(facts.slots) > 1 and not facts.switches]
    worktops = [name for name, facts in fixtures.items() if facts.slots and set(facts.slots) <= set(room.open_slots)]
    places: dict[str, Place] = {}
    for noun in others:
        names = away if rng.random() < ELSEWHERE else worktops
        if free := room.free(names, spare=2, noun=noun):
            places[noun] = room.take(free, rng)
    return places


def doors_and_switches(
    template: Template,
    scene: Rules,
    places: Mapping[str, Place],
    rng: np.random.Generator,
    *,
    away: Collection[str] = (),
) -> tuple[dict[str, Door], dict[str, tuple[str, ...]]]:
    """How doors stand that are not closed, and which switches are on. What is `away` is behind shut doors."""
    kinds = [group.kind for group in template.groups if HIDDEN in group.at]
    hiding = {scene.slots[place.where].fixture for place in places.values()} if kinds else set()
    hiding |= {scene.slots[places[noun].where].fixture for noun in away}
    odds = list(DOORS.values())
    doors: dict[str, Door] = {}
    for name in (name for name, facts in scene.fixtures.items() if facts.door):
        drawn = list(DOORS)[int(rng.choice(len(odds), p=odds))]
        stated = template.doors.get(name)
        doors[name] = stated or ("closed" if name in hiding else drawn)
    on: dict[str, tuple[str, ...]] = {name: (scene.fixtures[name].switches[0],) for name in template.on}
    for name, facts in scene.fixtures.items():
        if facts.switches and rng.random() < ON and not (facts.shut_to_run and doors.get(name) != "closed"):
            on[name] = (facts.switches[0],)
    return {name: door for name, door in doors.items() if door != "closed"}, on
