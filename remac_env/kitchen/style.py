"""Styles: how a kitchen looks, as data. A style gives each role (floor, base door, handle …) its finish.

`finishes.toml` holds the finish of every role; `styles/<name>.toml` changes some of them. Both are plain tables, one a
role, with the keys of `Finish`. Colours are written "#rrggbb". Importable without the simulator.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from remac_env.errors import KitchenFileError, check_choice
from remac_env.files import read_text
from remac_env.kitchen.fixtures import models
from remac_env.kitchen.textures import PATTERNS, Color
from remac_env.state import FrozenMap

_FOLDER = Path(__file__).parent / "styles"
_COMMON = Path(__file__).parent / "finishes.toml"
PANELS = ("shaker", "slab", "raised", "beaded")
"""How fronts are made: a frame around a flat panel, one plain board, a frame around a raised field or around boards."""

PULLS = ("bar", "knob", "edge")
"""What fronts are drawn open by: a bar on two posts, a knob, or a strip along their edge."""

_HEX = re.compile(r"#[0-9a-fA-F]{6}")


@dataclass(frozen=True)
class Finish:
    """What a surface looks like.

    color, accent: red, green, blue in 0..1; the accent is the second colour of the pattern (grain, veins, grout).
    pattern: a name of `textures.PATTERNS`, or "" for plain colour. tint: factor on a pattern's brightness.
    opacity, specular, shininess, reflectance: 0..1. emission: light given off, as a factor on the colour.
    """

    color: Color
    accent: Color = (0.5, 0.5, 0.5)
    pattern: str = ""
    tint: float = 1.0
    opacity: float = 1.0
    specular: float = 0.2
    shininess: float = 0.4
    reflectance: float = 0.0
    emission: float = 0.0


@dataclass(frozen=True, eq=False)
class Style:
    """A look: a finish for every role, the colour of the lamps (red, green, blue in 0..1), the variant of the fronts.

    panel: a name of PANELS, how doors and drawers are made; pull: a name of PULLS, how they are drawn open. models:
    kind of fixture -> its variant, a name in fixtures/models.toml; the default one where a kind is missing.
    """

    name: str
    title: str
    lamp: Color
    finishes: Mapping[str, Finish]
    panel: str = PANELS[0]
    pull: str = PULLS[0]
    models: Mapping[str, str] = FrozenMap({})

    def __getitem__(self, role: str) -> Finish:
        """The finish of a role; UnknownNameError lists the roles."""
        check_choice("material role", role, self.finishes)
        return self.finishes[role]


@lru_cache(maxsize=1)
def names() -> tuple[str, ...]:
    """The names of the styles at hand, sorted."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))


@lru_cache(maxsize=64)
def load(name: str) -> Style:
    """The style of that name. Raises UnknownNameError listing the styles, or KitchenFileError for a malformed file."""
    check_choice("style", name, names())
    return read(_FOLDER / f"{name}.toml")


def roles() -> tuple[str, ...]:
    """The roles that surfaces can have."""
    return tuple(_common())


def read(path: Path) -> Style:
    """Read one style file. Raises KitchenFileError naming the file, the key and the valid values."""
    table = _table(path)
    title, lamp = table.pop("title", path.stem), table.pop("lamp", "#ffffff")
    panel, pull = _one_of(path, table, "panel", PANELS), _one_of(path, table, "pull", PULLS)
    models = _models(path, table.pop("models", {}))
    if not isinstance(title, str):
        raise KitchenFileError(path, "title", f"expected a text, got {title!r}")
    finishes = dict(_common())
    for role, given in table.items():
        if role not in finishes:
            raise KitchenFileError(path, role, "is not a role", ["title", "lamp", "panel", "pull", "models", *finishes])
        finishes[role] = _finish(path, role, given, finishes[role])
    return Style(path.stem, title, hex_color(path, "lamp", lamp), MappingProxyType(finishes), panel, pull, models)


def _models(path: Path, given: object) -> Mapping[str, str]:
    if not isinstance(given, dict):
        raise KitchenFileError(path, "models", f"expected a table, got {given!r}", models.kinds())
    for kind, name in given.items():
        if kind not in models.kinds():
            raise KitchenFileError(path, f"models.{kind}", "is no kind of fixture with variants", models.kinds())
        if name not in models.names(kind):
            raise KitchenFileError(path, f"models.{kind}", f"got {name!r}", models.names(kind))
    return FrozenMap({str(kind): str(name) for kind, name in given.items()})


def _one_of(path: Path, table: dict[str, Any], key: str, valid: tuple[str, ...]) -> str:
    """Take a name out of the table; the first of the valid ones where it is missing."""
    name = table.pop(key, valid[0])
    if name not in valid:
        raise KitchenFileError(path, key, f"got {name!r}", valid)
    return str(name)


@lru_cache(maxsize=1)
def _common() -> Mapping[str, Finish]:
    plain = Finish(color=(0.8, 0.8, 0.8))
    return {role: _finish(_COMMON, role, given, plain) for role, given in _table(_COMMON).items()}


def _table(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(read_text(path))
    except OSError as error:
        raise KitchenFileError(path, "file", f"cannot be read: {error.strerror}") from error
    except (ValueError, RecursionError) as error:  # not TOML, not UTF-8, too many digits, too deep
        raise KitchenFileError(path, "file", f"is not TOML: {error}") from error


def _finish(path: Path, role: str, given: object, base: Finish) -> Finish:
    """`base` with the keys of one table changed."""
    known = [field.name for field in fields(Finish)]
    if not isinstance(given, dict):
        raise KitchenFileError(path, role, f"expected a table, got {given!r}", known)
    changes: dict[str, Any] = {}
    for key, value in given.items():
        where = f"{role}.{key}"
        if key not in known:
            raise KitchenFileError(path, where, "is not a key of a finish", known)
        if key in ("color", "accent"):
            changes[key] = hex_color(path, where, value)
        elif key == "pattern":
            if not isinstance(value, str) or (value != "" and value not in PATTERNS):
                raise KitchenFileError(path, where, f"unknown pattern {value!r}", ['""', *sorted(PATTERNS)])
            changes[key] = value
        else:
            changes[key] = _number(path, where, value, highest=4.0 if key == "emission" else 1.0)
    return replace(base, **changes)


def _number(path: Path, where: str, value: object, *, highest: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= highest:
        raise KitchenFileError(path, where, f"expected a number, got {value!r}", f"0 to {highest:g}")
    return float(value)


def hex_color(path: object, where: str, value: object) -> Color:
    """The colour, red, green, blue in 0..1, that "#rrggbb" stands for; `path` and `where` are named in the error."""
    if not isinstance(value, str) or not _HEX.fullmatch(value):
        raise KitchenFileError(path, where, f"expected a colour, got {value!r}", '"#rrggbb"')
    red, green, blue = (int(value[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return red, green, blue
