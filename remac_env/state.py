"""What is true in a kitchen at rest: the only thing that goals, checks, text and planners read.

`Scene` holds what cannot change during an episode (which things there are), `WorldState` what can. Both are immutable
and hashable; equal states are equal and hash equal, and no clock is in them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from remac_env.frozen import FrozenMap

STATE_VERSION = 1
"""Raised whenever the meaning of WorldState changes."""

ASIDE = "aside"
"""The station away from everything. Any number of robots may stand there."""

CLOSED_MAX = 0.05
"""A door at most this far open is closed, rad (paper/facts: a door is within 0.02 rad at reset)."""

OPEN_MIN = 0.90
"""A door at least this far open is open, rad (released threshold)."""

Relation = Literal["slot", "vessel", "held", "floor"]
Door = Literal["closed", "ajar", "open"]


@dataclass(frozen=True, slots=True)
class SlotFacts:
    """A place on a surface that can hold one thing."""

    name: str
    fixture: str
    station: str


@dataclass(frozen=True, slots=True)
class FixtureFacts:
    """A thing that stays where it is. `switches` are what `turn on` and `turn off` act on.

    A fixture that has one switch per slot (a stove) lists its slots. `shut_to_run`: it can only be switched on with its
    door closed. `wets`: where its water runs.
    """

    name: str
    kind: str
    station: str
    door: bool = False
    switches: tuple[str, ...] = ()
    slots: tuple[str, ...] = ()
    shut_to_run: bool = False
    wets: tuple[str, ...] = ()

    @property
    def switch_per_slot(self) -> bool:
        """True where each slot has a switch of its own, as the burners of a stove."""
        return bool(self.switches) and self.switches == self.slots


@dataclass(frozen=True, slots=True)
class ObjectFacts:
    """A thing that can be carried.

    `needs_vessel_in`, `vessel_in`, `too_big_for`, `too_deep_in` name fixture kinds: meat needs a vessel in a sink, a
    bowl is one, a plate leaves no room for a hand in a microwave, and no hand reaches into a bowl in a cabinet.
    `holds`: how many things fit on or in it; `seasons`: a shaker; `small`: it fits into a vessel; `washable`: water
    leaves it washed.
    """

    name: str
    category: str
    needs_vessel_in: frozenset[str] = frozenset()
    vessel_in: frozenset[str] = frozenset()
    holds: int = 0
    seasons: bool = False
    small: bool = True
    washable: bool = False
    too_big_for: frozenset[str] = frozenset()
    too_deep_in: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Scene:
    """Everything about a kitchen that an episode cannot change.

    `conflicts` are pairs of stations that two robots cannot use at the same time.
    """

    robots: tuple[str, ...]
    fixtures: FrozenMap[FixtureFacts]
    slots: FrozenMap[SlotFacts]
    objects: FrozenMap[ObjectFacts]
    conflicts: frozenset[frozenset[str]] = frozenset()

    @cached_property
    def stations(self) -> tuple[str, ...]:
        """All stations, in the order of the fixtures and then of the slots, without `aside`."""
        names = [fixture.station for fixture in self.fixtures.values()]
        names += [slot.station for slot in self.slots.values()]
        return tuple(dict.fromkeys(names))

    @cached_property
    def taps(self) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """The fixtures that give water, each with those into which it runs."""
        return tuple((name, facts.wets) for name, facts in self.fixtures.items() if facts.wets)

    @cached_property
    def washables(self) -> tuple[str, ...]:
        """The objects that running water leaves washed."""
        return tuple(name for name, facts in self.objects.items() if facts.washable)

    @cached_property
    def _stations_of(self) -> dict[str, tuple[str, ...]]:
        of = {name: [self.slots[slot].station for slot in facts.slots] for name, facts in self.fixtures.items()}
        return {name: tuple(dict.fromkeys(at or [self.fixtures[name].station])) for name, at in of.items()}

    @cached_property
    def _fixtures_at(self) -> dict[str, tuple[str, ...]]:
        at = self._stations_of
        return {station: tuple(name for name in at if station in at[name]) for station in self.stations}

    def stations_of(self, fixture: str) -> tuple[str, ...]:
        """The stations from which a fixture can be used: those of its slots, in their order, else its own."""
        return self._stations_of[fixture]

    def used_from(self, station: str) -> tuple[str, ...]:
        """The fixtures that can be used from a station."""
        return self._fixtures_at.get(station, ())

    def conflicting(self, first: str, second: str) -> bool:
        """True when two robots cannot stand at these stations at the same time."""
        if first == second:
            return first != ASIDE
        return frozenset((first, second)) in self.conflicts and ASIDE not in (first, second)


@dataclass(frozen=True, slots=True)
class Place:
    """Where an object is: in a slot, on or in a vessel, held by a robot (`where` names it), or on the floor."""

    relation: Relation
    where: str = ""


FLOOR = Place("floor")


@dataclass(frozen=True, slots=True)
class RobotState:
    """A robot's station (`aside` when away from all) and what its gripper holds."""

    station: str = ASIDE
    holding: str | None = None


@dataclass(frozen=True, slots=True)
class ObjectState:
    """An object's place, and the marks of what has happened to it that its place does not show."""

    place: Place
    marks: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class FixtureState:
    """A fixture's door (None where it has none) and the switches that are on."""

    door: Door | None = None
    on: frozenset[str] = frozenset()


_KEPT = "(what it holds)"
"""Says that a robot goes on holding what it holds; compared by identity, so that no name can mean it."""


@dataclass(frozen=True)
class WorldState:
    """The changeable part of a kitchen at rest."""

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


def supports(scene: Scene, world: WorldState, name: str) -> list[str]:
    """Everything that object `name` is on or in, nearest first: vessels, then the slot and its fixture."""
    found: list[str] = []
    place = world.objects[name].place
    while place.relation == "vessel":
        found.append(place.where)
        place = world.objects[place.where].place
    if place.relation == "slot":
        found += [place.where, scene.slots[place.where].fixture]
    return found


def inside(scene: Scene, world: WorldState, name: str, container: str) -> bool:
    """True when the object is on or in `container` (a vessel, slot or fixture), directly or in a vessel there."""
    return container in supports(scene, world, name)


def base_place(world: WorldState, name: str) -> Place:
    """The place of the lowest thing under object `name`: a slot, a robot's hand or the floor."""
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
