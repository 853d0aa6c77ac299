"""What is true in a kitchen at rest: the only thing that goals, checks, text and planners read.

`Scene` holds what cannot change during an episode (which things there are), `WorldState` what can. Both are immutable
and hashable; equal states are equal and hash equal, and no clock is in them.
"""

from __future__ import annotations

from collections.abc import ItemsView, Iterator, KeysView, Mapping, ValuesView
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, TypeVar

Key = TypeVar("Key", bound=str)
Value = TypeVar("Value")

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


class FrozenMap(Mapping[str, Value]):
    """An immutable, hashable mapping from names; equality ignores order."""

    __slots__ = ("_data", "_hash")

    def __init__(self, data: Mapping[str, Value]) -> None:
        self._data = dict(data)
        self._hash: int | None = None

    def __getitem__(self, key: str) -> Value:
        return self._data[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._data)

    def __len__(self) -> int:
        return len(self._data)

    # The views of the dict itself: those of Mapping are written in Python, and searches spend their time in them.

    def __contains__(self, key: object) -> bool:
        return key in self._data

    def keys(self) -> KeysView[str]:
        """The names."""
        return self._data.keys()

    def values(self) -> ValuesView[Value]:
        """The values."""
        return self._data.values()

    def items(self) -> ItemsView[str, Value]:
        """The pairs."""
        return self._data.items()

    def __reduce__(self) -> tuple[object, ...]:
        # Hashes of strings differ from process to process: the kept one must not travel.
        return FrozenMap, (self._data,)

    def __hash__(self) -> int:
        if self._hash is None:
            self._hash = hash(frozenset(self._data.items()))
        return self._hash

    def __eq__(self, other: object) -> bool:
        if isinstance(other, FrozenMap):
            return self._data == other._data
        return NotImplemented

    def __repr__(self) -> str:
        return repr(self._data)

    def with_(self, key: str, value: Value) -> FrozenMap[Value]:
        """A copy in which `key` has `value`."""
        return FrozenMap({**self._data, key: value})


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

    `needs_vessel_in`, `vessel_in`, `too_big_for` name fixture kinds: meat needs a vessel in a sink, a bowl is one, and
    a plate leaves no room for a hand in a microwave. `holds`: how many things fit on or in it; `seasons`: a shaker;
    `small`: it fits into a vessel; `washable`: water leaves it washed.
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
    def _fixtures_at(self) -> dict[str, tuple[str, ...]]:
        at: dict[str, list[str]] = {name: [] for name in self.stations}
        for name, facts in self.fixtures.items():
            for station in {self.slots[slot].station for slot in facts.slots} or {facts.station}:
                at[station].append(name)
        return {station: tuple(names) for station, names in at.items()}

    def used_from(self, station: str) -> tuple[str, ...]:
        """The fixtures that can be used from a station."""
        return self._fixtures_at.get(station, ())

    def conflicting(self, first: str, second: str) -> bool:
        """True when two robots cannot stand at these stations at the same time."""
        return ASIDE not in (first, second) and (first == second or frozenset((first, second)) in self.conflicts)


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

    def with_robot(self, name: str, **changes: object) -> WorldState:
        """A copy in which robot `name` has other `station` or `holding`."""
        robot = replace(self.robots[name], **changes)  # type: ignore[arg-type]
        return WorldState(self.robots.with_(name, robot), self.objects, self.fixtures)

    def with_object(self, name: str, **changes: object) -> WorldState:
        """A copy in which object `name` has another `place` or `marks`."""
        item = replace(self.objects[name], **changes)  # type: ignore[arg-type]
        return WorldState(self.robots, self.objects.with_(name, item), self.fixtures)

    def with_fixture(self, name: str, **changes: object) -> WorldState:
        """A copy in which fixture `name` has another `door` or `on`."""
        fixture = replace(self.fixtures[name], **changes)  # type: ignore[arg-type]
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


def contents(world: WorldState, vessel: str) -> list[str]:
    """The objects directly on or in `vessel`."""
    return [name for name, item in world.objects.items() if item.place == Place("vessel", vessel)]


def occupant(world: WorldState, slot: str) -> str | None:
    """The object that stands in `slot` itself, or None."""
    place = Place("slot", slot)
    return next((name for name, item in world.objects.items() if item.place == place), None)


def door_state(angle: float) -> Door:
    """Closed, ajar or open, from a door's angle in rad."""
    if angle <= CLOSED_MAX:
        return "closed"
    return "open" if angle >= OPEN_MIN else "ajar"
