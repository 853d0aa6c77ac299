"""A floor plan as plain facts: walls, fixtures, slots, stations. No simulator needed.

Fixtures and slots are given in the frame of their wall, stations and parking places in the frame of the room.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from math import hypot

from remac_env.errors import check_choice
from remac_env.kitchen.blocks import Point
from remac_env.kitchen.fixtures import Fixture, Room, Slot
from remac_env.kitchen.fixtures.room import Opening
from remac_env.kitchen.frame import WORLD, Frame
from remac_env.state import FrozenMap

CONFLICT_GAP = 0.80
"""Two stations nearer than this, m, cannot be used at the same time."""


@dataclass(frozen=True)
class Wall:
    """A row of fixtures. side: the side of the room along which it stands, None where it stands free (a peninsula)."""

    name: str
    frame: Frame
    side: str | None = None
    tiles: Opening | None = None


@dataclass(frozen=True)
class Station:
    """Where a robot stands: the vertical axis of its arm, m, and its heading, rad, world frame; facing which wall."""

    name: str
    x: float
    y: float
    yaw: float
    wall: str = ""

    def distance(self, other: Station) -> float:
        """Distance between two stations, m."""
        return hypot(self.x - other.x, self.y - other.y)

    def seen_from(self, frame: Frame) -> Station:
        """The same in another frame."""
        x, y = frame.local(self.x, self.y)
        return replace(self, x=x, y=y, yaw=self.yaw - frame.heading)


@dataclass(frozen=True, eq=False)
class Layout:
    """A floor plan, equal to itself alone. All mappings are read-only and keep the order of the file.

    asides: parking places. team_asides: those that more robots than that have instead; see `kitchen.parking`.
    """

    name: str
    version: int
    room: Room
    walls: Mapping[str, Wall]
    fixtures: Mapping[str, Fixture]
    slots: Mapping[str, Slot]
    stations: Mapping[str, Station]
    asides: tuple[Station, ...]
    team_asides: tuple[Station, ...] = ()

    def at_wall(self, wall: str) -> Iterator[Fixture]:
        """The fixtures of one wall."""
        return (fixture for fixture in self.fixtures.values() if fixture.wall == wall)

    def frame(self, fixture: str) -> Frame:
        """The frame in which a fixture's measures and slots are given."""
        return self.walls[self.fixtures[fixture].wall].frame

    def noun(self, slot: Slot) -> str:
        """What robots and planners call the fixture that a slot is in."""
        return self.fixtures[slot.fixture].noun

    def facing(self, station: Station) -> Frame:
        """The frame of the wall that a station faces; that of the room for parking places."""
        return self.walls[station.wall].frame if station.wall else WORLD

    @cached_property
    def middles(self) -> Mapping[str, Point]:
        """Slot -> its middle, m, world frame."""
        return FrozenMap({n: self.frame(slot.fixture).space(slot.center) for n, slot in self.slots.items()})

    def middle(self, slot: str) -> Point:
        """Middle of a slot, m, world frame."""
        return self.middles[slot]

    def conflicts(self) -> frozenset[frozenset[str]]:
        """Return the pairs of stations that cannot be used at the same time."""
        return frozenset(
            frozenset((first.name, second.name))
            for first, second in combinations(self.stations.values(), 2)
            if first.distance(second) < CONFLICT_GAP
        )

    def refuges(self, place: Station) -> tuple[Station, ...]:
        """Where a robot may withdraw to from a place: every other station and parking place."""
        return tuple(other for other in (*self.asides, *self.stations.values()) if other.name != place.name)

    def switch_owner(self, switch: str) -> Fixture:
        """Return the fixture that a switch belongs to; raises UnknownNameError."""
        owners = {name: fixture for fixture in self.fixtures.values() for name in fixture.switches}
        check_choice("switch", switch, owners)
        return owners[switch]
