"""A floor plan as plain facts: fixtures, slots, stations, lanes, read from layouts/<name>.toml. No simulator needed."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from math import hypot
from pathlib import Path

from remac_env.errors import KitchenFileError, check_choice
from remac_env.kitchen.fixtures import KINDS, Block, Fixture, Room, Slot
from remac_env.kitchen.fixtures.base import Point
from remac_env.kitchen.fixtures.table import Table
from remac_env.state import FrozenMap

FOLDER = Path(__file__).parent / "layouts"

STATION_GAP = 0.84
"""Least distance between two stations of a layout file, m: two bases 0.48 m wide, two swinging elbows and a margin."""

CONFLICT_GAP = 0.80
"""Two stations nearer than this, m, cannot be used at the same time."""

_TOUCH = 0.001  # fixtures that reach this little, m, into one another merely touch
_BASE_HALF = 0.24  # half width of a robot's base, m
_BASE_FRONT = 0.15  # how far the base reaches ahead of the arm's axis, m


@dataclass(frozen=True)
class Station:
    """Where a robot stands: the vertical axis of its arm, m, and its heading, rad, world frame."""

    name: str
    x: float
    y: float
    yaw: float

    def distance(self, other: Station) -> float:
        """Distance between two stations, m."""
        return hypot(self.x - other.x, self.y - other.y)


@dataclass(frozen=True)
class Lanes:
    """y of the lanes for robots that move to +x and to -x, m."""

    rightward: float
    leftward: float


@dataclass(frozen=True)
class Layout:
    """A floor plan. All mappings are read-only and keep the order of the file."""

    name: str
    version: int
    room: Room
    fixtures: Mapping[str, Fixture]
    slots: Mapping[str, Slot]
    stations: Mapping[str, Station]
    asides: tuple[Station, ...]
    lanes: Lanes

    def conflicts(self) -> frozenset[frozenset[str]]:
        """Return the pairs of stations that cannot be used at the same time."""
        return frozenset(
            frozenset((first.name, second.name))
            for first, second in combinations(self.stations.values(), 2)
            if first.distance(second) < CONFLICT_GAP
        )

    def switch_owner(self, switch: str) -> Fixture:
        """Return the fixture that a switch belongs to; raises UnknownNameError."""
        owners = {name: fixture for fixture in self.fixtures.values() for name in fixture.switches}
        check_choice("switch", switch, owners)
        return owners[switch]


def names() -> tuple[str, ...]:
    """Return the names of the layouts that come with the package, sorted."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.toml")))


@cache
def load(name: str) -> Layout:
    """Return a layout by name; raises UnknownNameError, or KitchenFileError where its file is malformed."""
    check_choice("layout", name, names())
    return read(FOLDER / f"{name}.toml")


def read(path: Path) -> Layout:
    """Read a layout file from anywhere; the layout is named like the file. Raises KitchenFileError."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise KitchenFileError(path.name, "file", f"cannot be read ({error})") from error
    return parse(text, name=path.stem, file=path.name)


def parse(text: str, *, name: str, file: str) -> Layout:
    """Build a layout from TOML text; `file` is what errors call it. Raises KitchenFileError."""
    try:
        table = Table(tomllib.loads(text), file=file)
    except tomllib.TOMLDecodeError as error:
        raise KitchenFileError(file, "file", f"not valid TOML ({error})") from error
    stations = {key: _station(key, entry) for key, entry in table.tables("stations").items()}
    fixtures = {key: _fixture(key, entry) for key, entry in table.tables("fixtures").items()}
    layout = Layout(
        name=name,
        version=table.whole("version"),
        room=Room.parse(table.table("room")),
        fixtures=FrozenMap(fixtures),
        slots=FrozenMap({slot.name: slot for fixture in fixtures.values() for slot in fixture.slots}),
        stations=FrozenMap(stations),
        asides=tuple(_station(key, entry) for key, entry in table.tables("asides").items()),
        lanes=_lanes(table.table("lanes")),
    )
    table.close()
    _check(layout, file)
    return layout


def _station(name: str, table: Table) -> Station:
    x, y = table.pair("at")
    station = Station(name, x, y, table.number("yaw"))
    table.close()
    return station


def _lanes(table: Table) -> Lanes:
    lanes = Lanes(table.number("rightward"), table.number("leftward"))
    table.close()
    return lanes


def _fixture(name: str, table: Table) -> Fixture:
    kind = table.text("kind", choices=sorted(KINDS))
    fixture = KINDS[kind].parse(name, table)
    table.close()
    return fixture


def _check(layout: Layout, file: str) -> None:
    """Raise KitchenFileError for whatever in the layout cannot be."""
    for fixture in layout.fixtures.values():
        _check_references(fixture, layout, file)
        _check_slots(fixture, file)
        _check_room(fixture, layout, file)
    for first, second in combinations(layout.fixtures.values(), 2):
        _check_apart(first, second, file)
    for fixture in layout.fixtures.values():
        _check_sweep(fixture, layout, file)
    _check_stations(layout, file)


def _check_references(fixture: Fixture, layout: Layout, file: str) -> None:
    for station in fixture.stations:
        if station not in layout.stations:
            raise KitchenFileError(
                file, f"fixtures.{fixture.name}.station", f"unknown station {station!r}", layout.stations
            )


def _check_slots(fixture: Fixture, file: str) -> None:
    """Slots lie on a surface of their fixture and apart from one another."""
    for slot in fixture.slots:
        key = f"fixtures.{fixture.name}.slots ({slot.name})"
        if min(slot.half) <= 0:
            raise KitchenFileError(file, key, f"half extents {slot.half} must be positive")
        if not any(
            _inside(_slot_span(slot, 0), surface.x) and _inside(_slot_span(slot, 1), surface.y)
            for surface in fixture.surfaces
        ):
            raise KitchenFileError(
                file,
                key,
                f"x {_shown(_slot_span(slot, 0))} y {_shown(_slot_span(slot, 1))} reaches off its surface",
                (f"x {_shown(surface.x)} y {_shown(surface.y)}" for surface in fixture.surfaces),
            )
    for first, second in combinations(fixture.slots, 2):
        if all(abs(first.center[i] - second.center[i]) < first.half[i] + second.half[i] - _TOUCH for i in (0, 1)):
            raise KitchenFileError(file, f"fixtures.{fixture.name}.slots", f"{first.name} overlaps {second.name}")


def _check_room(fixture: Fixture, layout: Layout, file: str) -> None:
    left, right = layout.room.x
    for block in fixture.blocks:
        if (
            block.low[0] < left - _TOUCH
            or block.high[0] > right + _TOUCH
            or block.high[2] > layout.room.height + _TOUCH
        ):
            raise KitchenFileError(
                file,
                f"fixtures.{fixture.name}",
                f"x {_shown((block.low[0], block.high[0]))} z {_shown((block.low[2], block.high[2]))} leaves the room",
                f"x {_shown(layout.room.x)} z {_shown((0.0, layout.room.height))}",
            )


def _check_apart(first: Fixture, second: Fixture, file: str) -> None:
    for one in first.blocks:
        for other in second.blocks:
            if one.overlap(other) > _TOUCH:
                raise KitchenFileError(
                    file,
                    f"fixtures.{second.name}",
                    f"overlaps fixture {first.name} by {one.overlap(other):.3f} m; "
                    f"{second.name}: {_shown_block(other)}; {first.name}: {_shown_block(one)}",
                )


def _check_sweep(fixture: Fixture, layout: Layout, file: str) -> None:
    for other in layout.fixtures.values():
        if other is not fixture and any(block.holds(p) for block in other.blocks for p in fixture.swept_points):
            raise KitchenFileError(file, f"fixtures.{fixture.name}", f"its door swings into fixture {other.name}")


def _check_stations(layout: Layout, file: str) -> None:
    """Stations lie apart, inside the room, and clear of what stands on the floor."""
    for first, second in combinations(layout.stations.values(), 2):
        if first.distance(second) < STATION_GAP - 1e-9:
            raise KitchenFileError(
                file,
                f"stations.{second.name}",
                f"{first.distance(second):.3f} m from station {first.name}",
                f"at least {STATION_GAP} m apart",
            )
    floor: list[tuple[str, Block]] = [
        (fixture.name, block) for fixture in layout.fixtures.values() for block in fixture.blocks if block.low[2] < 0.4
    ]
    left, right = layout.room.x
    for station in (*layout.stations.values(), *layout.asides):
        if not left + _BASE_HALF <= station.x <= right - _BASE_HALF:
            raise KitchenFileError(file, f"stations.{station.name}", f"x {station.x:g} is too near a side wall")
        corner: Point = (station.x, station.y + _BASE_FRONT, 0.2)
        for name, block in floor:
            if block.holds(corner) or corner[1] > block.low[1] and block.low[0] < station.x < block.high[0]:
                raise KitchenFileError(file, f"stations.{station.name}", f"a robot there would stand in fixture {name}")


def _slot_span(slot: Slot, axis: int) -> tuple[float, float]:
    return slot.center[axis] - slot.half[axis], slot.center[axis] + slot.half[axis]


def _inside(span: tuple[float, float], around: tuple[float, float]) -> bool:
    return around[0] - _TOUCH <= span[0] and span[1] <= around[1] + _TOUCH


def _shown(span: Iterable[float]) -> str:
    low, high = span
    return f"[{low:.3f}, {high:.3f}]"


def _shown_block(block: Block) -> str:
    spans = zip(block.low, block.high, strict=True)
    return " ".join(f"{axis} {_shown(span)}" for axis, span in zip("xyz", spans, strict=True))
