"""Floor plans read from layouts/<name>.toml, and held to what a layout must be like. No simulator needed."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from math import pi
from pathlib import Path

from remac_env.errors import KitchenFileError, check_choice
from remac_env.files import read_text, unmarked
from remac_env.kitchen.fixtures import KINDS, Fixture, Room, certificates
from remac_env.kitchen.fixtures import models as fixture_models
from remac_env.kitchen.fixtures.table import Table
from remac_env.kitchen.floor_plan import Layout, Station, Wall
from remac_env.kitchen.frame import Frame
from remac_env.kitchen.layout_checks import check
from remac_env.kitchen.opening import check_opening
from remac_env.state import FrozenMap
from remac_env.vocabulary import Noun, make_noun

FOLDER = Path(__file__).parent / "layouts"

HEADINGS = (0, 90, 180, 270)
"""How walls may be turned, degrees."""


FAMILIES = ("", "rich", "built", "scullery")
"""The folders of layouts. Tasks and suites draw from the first one; those of others are had by name alone."""


@cache
def names(*families: str) -> tuple[str, ...]:
    """Return the names of the layouts that come with the package, sorted; with `families`, theirs."""
    return tuple(name for family in families or FAMILIES[:1] for name in sorted(_files(family)))


@cache
def nouns(name: str) -> tuple[Noun, ...]:
    """The words for what a layout of the package has beside the usual fixtures; none for others."""
    family = next((family for family in FAMILIES if name in _files(family)), "")
    path = FOLDER / "nouns" / f"{family}.toml"
    if not path.is_file():
        return ()
    return tuple(make_noun(entry, file=path.name) for entry in tomllib.loads(read_text(path))["noun"])


def _files(family: str) -> Mapping[str, Path]:
    return {path.stem: path for path in (FOLDER / family).glob("*.toml")}


Models = Mapping[str, str]
"""Kind of fixture -> the variant that a style has of it; the default variant where a kind is missing."""

NO_MODELS: Models = FrozenMap({})


@cache
def load(name: str, models: Models = NO_MODELS) -> Layout:
    """Return a layout by name; raises UnknownNameError, or KitchenFileError where its file is malformed."""
    check_choice("layout", name, names(*FAMILIES))
    return read(next(_files(family)[name] for family in FAMILIES if name in _files(family)), models)


@cache
def read(path: Path, models: Models = NO_MODELS) -> Layout:
    """Read a layout file from anywhere; the layout is named like the file. Raises KitchenFileError."""
    try:
        text = read_text(path)
    except (OSError, ValueError) as error:
        raise KitchenFileError(path.name, "file", f"cannot be read ({error})", "a path of a layout file") from error
    return parse(text, name=path.stem, file=path.name, models=models)


def parse(text: str, *, name: str, file: str, models: Models = NO_MODELS, certified: bool = True) -> Layout:
    """Build a layout from TOML text; `file` is what errors call it. Raises KitchenFileError.

    certified: whether it must be put together from certified variants only, each with its station where it was proven.
    """
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
        asides=_asides(table, "asides"),
        team_asides=_asides(table, "team_asides") if table.has("team_asides") else (),
    )
    table.close()
    check(layout, file)
    check_opening(layout, file)
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
    return Wall(name, replace(frame, name=f"wall {name}"), side, tiles)


def _station(name: str, table: Table, walls: Mapping[str, Wall]) -> Station:
    """A robot that faces its wall, its place given in the wall's frame."""
    x, y = table.pair("at")
    wall = table.text("wall", choices=walls, default=next(iter(walls)))
    table.close()
    frame = walls[wall].frame
    yaw = 0.5 * pi + 0.5 * pi * ((frame.quarters + 1) % 4 - 1)
    return Station(name, *frame.point(x, y), yaw, wall)


def _asides(table: Table, key: str) -> tuple[Station, ...]:
    return tuple(_aside(name, entry) for name, entry in table.tables(key).items())


def _aside(name: str, table: Table) -> Station:
    x, y = table.pair("at")
    station = Station(name, x, y, table.number("yaw"))
    table.close()
    return station


def _fixture(name: str, table: Table, walls: Mapping[str, Wall], models: Models) -> Fixture:
    kind = table.text("kind", choices=sorted(KINDS))
    wall = table.text("wall", choices=walls, default=next(iter(walls)))
    variants = fixture_models.names(kind)
    if variants:
        model = table.text("model", choices=variants, default=models.get(kind, variants[0]))
        measures = fixture_models.measures(kind, model)
        fixture = KINDS[kind].parse(name, table, measures)
        measures.close()
        fixture = replace(fixture, variant=model)
    else:
        fixture = KINDS[kind].parse(name, table, table)
    table.close()
    return replace(fixture, wall=wall)
