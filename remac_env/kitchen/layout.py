"""A floor plan as plain facts: walls, fixtures, slots, stations, read from layouts/<name>.toml. No simulator needed.

Fixtures and slots are given in the frame of their wall, stations and parking places in the frame of the room.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import combinations
from math import hypot, pi
from pathlib import Path

from remac_env.errors import KitchenFileError, check_choice
from remac_env.files import read_text, unmarked
from remac_env.kitchen.fixtures import KINDS, Fixture, Room, Slot
from remac_env.kitchen.fixtures import models as fixture_models
from remac_env.kitchen.fixtures.base import Point
from remac_env.kitchen.fixtures.room import Opening
from remac_env.kitchen.fixtures.table import Table
from remac_env.kitchen.frame import WORLD, Frame
from remac_env.state import FrozenMap

FOLDER = Path(__file__).parent / "layouts"

CONFLICT_GAP = 0.80
"""Two stations nearer than this, m, cannot be used at the same time."""

HEADINGS = (0, 90, 180, 270)
"""How walls may be turned, degrees."""


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
    """A floor plan, equal to itself alone. All mappings are read-only and keep the order of the file."""

    name: str
    version: int
    room: Room
    walls: Mapping[str, Wall]
    fixtures: Mapping[str, Fixture]
    slots: Mapping[str, Slot]
    stations: Mapping[str, Station]
    asides: tuple[Station, ...]

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


@cache
def names() -> tuple[str, ...]:
    """Return the names of the layouts that come with the package, sorted."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.toml")))


Models = Mapping[str, str]
"""Kind of fixture -> the make that a style has of it; the default make where a kind is missing."""

NO_MODELS: Models = FrozenMap({})


@cache
def load(name: str, models: Models = NO_MODELS) -> Layout:
    """Return a layout by name; raises UnknownNameError, or KitchenFileError where its file is malformed."""
    check_choice("layout", name, names())
    return read(FOLDER / f"{name}.toml", models)


@cache
def read(path: Path, models: Models = NO_MODELS) -> Layout:
    """Read a layout file from anywhere; the layout is named like the file. Raises KitchenFileError."""
    try:
        text = read_text(path)
    except (OSError, UnicodeDecodeError) as error:
        raise KitchenFileError(path.name, "file", f"cannot be read ({error})") from error
    return parse(text, name=path.stem, file=path.name, models=models)


def parse(text: str, *, name: str, file: str, models: Models = NO_MODELS, certified: bool = True) -> Layout:
    """Build a layout from TOML text; `file` is what errors call it. Raises KitchenFileError.

    certified: whether it must be put together from certified makes only, each with its station where it was proven.
    """
    from remac_env.kitchen.fixtures import certificates
    from remac_env.kitchen.layout_checks import check

    try:
        table = Table(tomllib.loads(unmarked(text)), file=file)
    except (ValueError, RecursionError) as error:  # not TOML, too many digits, too deep
        raise KitchenFileError(file, "file", f"not valid TOML ({error})") from error
    version, room = table.whole("version"), Room.parse(table.table("room"))
    walls = {key: _wall(key, entry, room) for key, entry in table.tables("walls").items()}
    if not walls:
        raise table.error("walls", "a kitchen needs at least one")
    stations = {key: _station(key, entry, walls) for key, entry in table.tables("stations").items()}
    fixtures = {key: _fixture(key, entry, walls, models) for key, entry in table.tables("fixtures").items()}
    layout = Layout(
        name=name,
        version=version,
        room=room,
        walls=FrozenMap(walls),
        fixtures=FrozenMap(fixtures),
        slots=FrozenMap({slot.name: slot for fixture in fixtures.values() for slot in fixture.slots}),
        stations=FrozenMap(stations),
        asides=tuple(_aside(key, entry) for key, entry in table.tables("asides").items()),
    )
    table.close()
    check(layout, file)
    if certified:
        certificates.check(layout, file)
    return layout


def _wall(name: str, table: Table, room: Room) -> Wall:
    """Along a side of the room, or free-standing with its own place and heading."""
    if table.has("side"):
        side: str | None = table.text("side", choices=room.sides)
        frame = room.sides[str(side)][0]
    elif not table.has("at"):
        raise table.error("side", "missing", (*room.sides, "or instead of it at and heading"))
    else:
        side, (x, y), heading = None, table.pair("at"), table.number("heading")
        if heading not in HEADINGS:
            raise table.error("heading", f"{heading:g} is not a quarter turn", HEADINGS)
        frame = Frame(x, y, int(heading) // 90)
    tiles = (table.span("tiles_x"), table.span("tiles_z")) if table.has("tiles_x") else None
    table.close()
    return Wall(name, frame, side, tiles)


def _station(name: str, table: Table, walls: Mapping[str, Wall]) -> Station:
    """A robot that faces its wall, its place given in the wall's frame."""
    x, y = table.pair("at")
    wall = table.text("wall", choices=walls, default=next(iter(walls)))
    table.close()
    frame = walls[wall].frame
    yaw = 0.5 * pi + 0.5 * pi * ((frame.quarters + 1) % 4 - 1)
    return Station(name, *frame.point(x, y), yaw, wall)


def _aside(name: str, table: Table) -> Station:
    x, y = table.pair("at")
    station = Station(name, x, y, table.number("yaw"))
    table.close()
    return station


def _fixture(name: str, table: Table, walls: Mapping[str, Wall], models: Models) -> Fixture:
    kind = table.text("kind", choices=sorted(KINDS))
    wall = table.text("wall", choices=walls, default=next(iter(walls)))
    makes = fixture_models.names(kind)
    if makes:
        model = table.text("model", choices=makes, default=models.get(kind, makes[0]))
        measures = fixture_models.measures(kind, model)
        fixture = KINDS[kind].parse(name, table, measures)
        measures.close()
        fixture = replace(fixture, make=model)
    else:
        fixture = KINDS[kind].parse(name, table, table)
    table.close()
    return replace(fixture, wall=wall)
