"""What is true in a kitchen at rest: the only thing that goals, checks, text and planners read.

`rules.facts.Rules` holds what cannot change during an episode, `WorldState` what can. Both are immutable and hashable;
equal states are equal and hash equal, and no clock is in them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from remac_env.frozen import FrozenMap
from remac_env.rules.facts import ASIDE, Rules

STATE_VERSION = 1
"""Raised whenever the meaning of WorldState changes."""

CLOSED_MAX = 0.05
"""A door at most this far open is closed, rad (paper/facts: a door is within 0.02 rad at reset)."""

OPEN_MIN = 0.90
"""A door at least this far open is open, rad (released threshold)."""

Relation = Literal["slot", "vessel", "held", "floor"]
"""How an object is where it is."""

Door = Literal["closed", "ajar", "open"]
"""How far a door is open: see CLOSED_MAX and OPEN_MIN."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where an object is by its `relation`: in a slot, on or in a vessel, held by a robot (`where` names it), or on the
    floor."""

    relation: Relation
    where: str = ""


FLOOR = Place("floor")
"""The one place without a name."""

HAND = "hand"
"""The hand of a robot that has one."""


@dataclass(frozen=True, slots=True)
class RobotState:
    """A robot's `station` (`aside` when away from all) and what its gripper holds: `holding`, None for nothing."""

    station: str = ASIDE
    holding: str | None = None

    @property
    def hands(self) -> Mapping[str, str | None]:
        """Hand -> what it holds. Skills work with one hand so far, so that this says what `holding` does."""
        return {HAND: self.holding}


@dataclass(frozen=True, slots=True)
class ObjectState:
    """An object's `place`, and the `marks` of what has happened to it that its place does not show."""

    place: Place
    marks: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class FixtureState:
    """A fixture's `door` (None where it has none) and the switches that are `on`."""

    door: Door | None = None
    on: frozenset[str] = frozenset()


_KEPT = "(what it holds)"
"""Says that a robot goes on holding what it holds; compared by identity, so that no name can mean it."""


@dataclass(frozen=True)
class WorldState:
    """The changeable part of a kitchen at rest: the states of its `robots`, `objects` and `fixtures`, by name."""

    robots: FrozenMap[RobotState]
    objects: FrozenMap[ObjectState]
    fixtures: FrozenMap[FixtureState]

    @cached_property
    def _key(self) -> int:
        return hash((self.robots, self.objects, self.fixtures))

    def __hash__(self) -> int:
        return self._key

    def __reduce__(self) -> tuple[object, ...]:
        # As in FrozenMap: the hash that is kept must not travel to another process.
        return WorldState, (self.robots, self.objects, self.fixtures)

    def with_robot(self, name: str, *, station: str | None = None, holding: str | None = _KEPT) -> WorldState:
        """A copy in which robot `name` has another station (None keeps it), or holds something else (None: nothing)."""
        old = self.robots[name]
        robot = RobotState(old.station if station is None else station, old.holding if holding is _KEPT else holding)
        return WorldState(self.robots.with_(name, robot), self.objects, self.fixtures)

    def with_object(self, name: str, *, place: Place | None = None, marks: frozenset[str] | None = None) -> WorldState:
        """A copy in which object `name` has another place or other marks; None keeps what it has."""
        old = self.objects[name]
        item = ObjectState(old.place if place is None else place, old.marks if marks is None else marks)
        return WorldState(self.robots, self.objects.with_(name, item), self.fixtures)

    def with_fixture(self, name: str, *, door: Door | None = None, on: frozenset[str] | None = None) -> WorldState:
        """A copy in which fixture `name` has its door otherwise or other switches on; None keeps what it has."""
        old = self.fixtures[name]
        fixture = FixtureState(old.door if door is None else door, old.on if on is None else on)
        return WorldState(self.robots, self.objects, self.fixtures.with_(name, fixture))


def supports(scene: Rules, world: WorldState, name: str) -> list[str]:
    """Everything that object `name` is on or in, nearest first: vessels, then the slot and its fixture."""
    found: list[str] = []
    place = world.objects[name].place
    while place.relation == "vessel":
        found.append(place.where)
        place = world.objects[place.where].place
    if place.relation == "slot":
        found += [place.where, scene.slots[place.where].fixture]
    return found


def inside(scene: Rules, world: WorldState, name: str, container: str) -> bool:
    """True when the object is on or in `container` (a vessel, slot or fixture), directly or in a vessel there."""
    return container in supports(scene, world, name)


def switches_on(world: WorldState) -> frozenset[str]:
    """The switches of all fixtures that are on."""
    return frozenset().union(*(state.on for state in world.fixtures.values()))


def base_place(world: WorldState, name: str) -> Place:
    """The place of the lowest object under object `name`: a slot, a robot's hand or the floor."""
    place = world.objects[name].place
    while place.relation == "vessel":
        place = world.objects[place.where].place
    return place


# Fields are compared one by one below, where making a Place to compare with would take most of the time.


def contents(world: WorldState, vessel: str) -> list[str]:
    """The objects directly on or in `vessel`."""
    objects = world.objects.items()
    return [name for name, item in objects if item.place.where == vessel and item.place.relation == "vessel"]


def occupant(world: WorldState, slot: str) -> str | None:
    """The object that stands in `slot` itself, or None."""
    for name, item in world.objects.items():
        if item.place.where == slot and item.place.relation == "slot":
            return name
    return None


def door_state(angle: float) -> Door:
    """Closed, ajar or open, from a door's angle in rad."""
    if angle <= CLOSED_MAX:
        return "closed"
    return "open" if angle >= OPEN_MIN else "ajar"
