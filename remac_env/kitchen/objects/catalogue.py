"""The catalogue of objects as facts: what they are, weigh and measure and how hands grasp them. No simulator needed."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, TypeGuard, get_args

from remac_env.errors import KitchenFileError, check_choice
from remac_env.files import read_text
from remac_env.kitchen.fixtures import KINDS, alike
from remac_env.kitchen.objects.forms import FORMS, OPTIONAL_MEASURES, VECTORS, Body
from remac_env.kitchen.style import hex_color
from remac_env.kitchen.textures import Color
from remac_env.state import FrozenMap

_FOLDER = Path(__file__).with_name("categories")

Group = Literal[
    "vegetable", "fruit", "fish", "meat", "bread", "dairy", "packaged", "drink", "condiment", "shaker", "vessel", "ware"
]
GraspMode = Literal["side", "rim", "handle"]
Attribute = Literal["washable", "microwavable", "cookable", "freezable"]

_NEEDED = ("group", "mass", "friction", "rest_height", "body", "grasp")
_FURTHER = (
    "roles", "attributes", "needs_vessel_in", "vessel_in", "too_big_for", "too_deep_in", "holds", "inside_height",
    "look", "color",
)  # fmt: skip
_GRASP_KEYS = ("mode", "height", "width", "reach", "lean", "any_yaw")
GROUPS_AS_NOUNS = ("vegetable", "fish", "meat")
"""Groups whose name is a noun that any object of the group may go by."""

EDIBLE = ("vegetable", "fruit", "fish", "meat", "bread", "dairy")
"""Groups of objects that lie in a dish, as far as they are low enough."""

DISH_ROOM = (0.085, 0.085, 0.0375)
"""Half extents up to which food lies in a bowl or pan without standing out of it, m."""

_HAND_OPENING = 0.08  # m, manufacturer's data of the Panda hand


@dataclass(frozen=True)
class Grasp:
    """How a two-finger hand takes an object. Lengths m in the object's frame, angles rad.

    mode: "side": the fingers close along the frame's y axis, the hand coming from above. "rim": they close across the
    rim. "handle": across a handle that points to -y. height: of the grip over the frame. width: between the fingers
    when they touch. reach: for a rim its radius; for a handle distances along it, the best first. lean: tilts of the
    hand worth trying, the best first. any_yaw: whether the hand may come from any side.
    """

    mode: GraspMode
    height: float
    width: float
    reach: tuple[float, ...] = ()
    lean: tuple[float, ...] = (0.0,)
    any_yaw: bool = False


@dataclass(frozen=True)
class Category:
    """A kind of object.

    mass: kg. friction: sliding, torsional (m), rolling (m). rest_height: height of the body's frame over the surface
    it rests on, m. roles: nouns that it may go by. needs_vessel_in, vessel_in: kinds of fixtures; too_big_for: those in
    which a hand has no room beside it, or no hold on it once it has toppled; too_deep_in: those in which no hand
    reaches into it. holds: how many it takes. inside_height: of its inner floor over its frame, m. look: name of
    the drawn shape, "" to draw the colliders in `color` (red, green, blue in 0..1).
    """

    name: str
    group: Group
    mass: float
    friction: tuple[float, float, float]
    rest_height: float
    body: Body
    grasp: Grasp
    roles: tuple[str, ...] = ()
    attributes: frozenset[str] = frozenset()
    needs_vessel_in: frozenset[str] = frozenset()
    vessel_in: frozenset[str] = frozenset()
    too_big_for: frozenset[str] = frozenset()
    too_deep_in: frozenset[str] = frozenset()
    holds: int = 0
    inside_height: float = 0.0
    look: str = ""
    color: Color = (0.7, 0.6, 0.5)

    @cached_property
    def size(self) -> tuple[float, float, float]:
        """Half extents (x, y, z) of the box around the body as it rests, m; the box's middle need not be the frame."""
        low, high = self.body.bounds
        return (high[0] - low[0]) / 2, (high[1] - low[1]) / 2, (high[2] - low[2]) / 2

    @property
    def seasons(self) -> bool:
        """Whether it is a shaker."""
        return self.group == "shaker"

    @property
    def vessel(self) -> bool:
        """Whether objects can be put in or on it."""
        return self.holds > 0

    @property
    def small(self) -> bool:
        """Whether it may lie in a bowl or pan."""
        return self.group in EDIBLE and all(half <= room for half, room in zip(self.size, DISH_ROOM, strict=True))

    def height_inside(self, vessel: Category) -> float:
        """Height of this object's frame over the frame of a vessel in which it lies, m."""
        return vessel.inside_height + self.rest_height


def load() -> Mapping[str, Category]:
    """All categories by name. Raises KitchenFileError for a malformed catalogue."""
    return _load()


def get(name: str) -> Category:
    """The category of that name; UnknownNameError lists the names."""
    categories = load()
    check_choice("object category", name, categories)
    return categories[name]


def for_role(noun: str) -> tuple[str, ...]:
    """Names of the categories that may go by a noun, in the order of the catalogue; empty where there is none."""
    return tuple(name for name, category in load().items() if noun in category.roles)


def parse(name: str, table: object, *, source: object = "categories") -> Category:
    """A category from a table in the form of the catalogue. Raises KitchenFileError naming the source and the key."""
    return _Reader(source, name).category(table)


@lru_cache(maxsize=1)
def _load() -> Mapping[str, Category]:
    found: dict[str, Category] = {}
    for file in sorted(_FOLDER.glob("*.toml")):
        found.update(read(file))
    return MappingProxyType(found)


def read(file: Path) -> dict[str, Category]:
    """The categories of a file by name. Raises KitchenFileError for a malformed file."""
    try:
        tables = tomllib.loads(read_text(file))
    except (OSError, ValueError, RecursionError) as error:  # not TOML, not UTF-8, too many digits, too deep
        raise KitchenFileError(file, "file", f"cannot be read: {error}") from error
    return {name: parse(name, table, source=file) for name, table in tables.items()}


@dataclass(frozen=True)
class _Reader:
    """Reads one category; every complaint names the source and the key."""

    source: object
    name: str

    def category(self, table: object) -> Category:
        given = self._keys("", table, _NEEDED, _FURTHER)
        group = self._choice("group", given["group"], get_args(Group))
        own = [group, self.name] if group in GROUPS_AS_NOUNS and group != self.name else [self.name]
        return Category(
            name=self.name,
            group=group,
            mass=self._number("mass", given["mass"], positive=True),
            friction=self._numbers("friction", given["friction"], count=3),
            rest_height=self._number("rest_height", given["rest_height"]),
            body=self._body(given["body"]),
            grasp=self._grasp(given["grasp"]),
            roles=self._words("roles", given.get("roles", own)),
            attributes=frozenset(self._words("attributes", given.get("attributes", []), get_args(Attribute))),
            needs_vessel_in=frozenset(self._words("needs_vessel_in", given.get("needs_vessel_in", []), KINDS)),
            vessel_in=frozenset(self._words("vessel_in", given.get("vessel_in", []), KINDS)),
            too_big_for=alike(self._words("too_big_for", given.get("too_big_for", []), KINDS)),
            too_deep_in=alike(self._words("too_deep_in", given.get("too_deep_in", []), KINDS)),
            holds=self._whole("holds", given.get("holds", 0)),
            inside_height=self._number("inside_height", given.get("inside_height", 0.0)),
            look=self._look(given.get("look", "")),
            color=hex_color(self.source, f"{self.name}.color", given.get("color", "#b39980")),
        )

    def _body(self, table: object) -> Body:
        if not isinstance(table, Mapping):
            raise self._error("body", f"expected a table, got {table!r}", FORMS)
        form = self._choice("body.form", table.get("form"), FORMS)
        given = self._keys("body", table, ("form", *FORMS[form]), OPTIONAL_MEASURES.get(form, ()))
        measures: dict[str, Any] = {}
        for key in sorted(given.keys() - {"form"}):  # points before radii, of which there is one less
            where = f"body.{key}"
            if key in VECTORS:
                measures[key] = self._numbers(where, given[key], count=3)
            elif key == "points":
                measures[key] = self._points(where, given[key])
            elif key == "radii":
                measures[key] = self._numbers(where, given[key], count=len(given.get("points", ())) - 1)
            else:
                measures[key] = self._number(where, given[key], positive=True)
        return Body(form, FrozenMap(measures))

    def _grasp(self, table: object) -> Grasp:
        given = self._keys("grasp", table, _GRASP_KEYS[:3], _GRASP_KEYS[3:])
        mode = self._choice("grasp.mode", given["mode"], get_args(GraspMode))
        reach = self._numbers("grasp.reach", given.get("reach", []))
        if (mode == "side") != (not reach):
            raise self._error(
                "grasp.reach", f"mode {mode!r} has {len(reach)} places", "none for side, else one or more"
            )
        width = self._number("grasp.width", given["width"], positive=True)
        if width >= _HAND_OPENING:
            raise self._error("grasp.width", f"{width} is wider than the hand opens", f"below {_HAND_OPENING}")
        any_yaw = given.get("any_yaw", False)
        if not isinstance(any_yaw, bool):
            raise self._error("grasp.any_yaw", f"got {any_yaw!r}", "true, false")
        lean = self._numbers("grasp.lean", given.get("lean", [0.0]))
        if not lean:
            raise self._error("grasp.lean", "is empty", "one tilt or more")
        return Grasp(mode, self._number("grasp.height", given["height"]), width, reach, lean, any_yaw)

    def _keys(self, where: str, table: object, needed: Sequence[str], further: Sequence[str]) -> Mapping[str, Any]:
        if not isinstance(table, Mapping):
            raise self._error(where, f"expected a table, got {table!r}", [*needed, *further])
        prefix = f"{where}." if where else ""
        for key in needed:
            if key not in table:
                raise self._error(prefix + key, "is missing")
        for key in table:
            if key not in needed and key not in further:
                raise self._error(f"{prefix}{key}", "is not a known key", [*needed, *further])
        return table

    def _choice(self, where: str, value: object, valid: Iterable[str]) -> Any:
        choices = list(valid)
        if value not in choices:
            raise self._error(where, f"got {value!r}", choices)
        return value

    def _words(self, where: str, value: object, valid: Iterable[str] | None = None) -> tuple[str, ...]:
        if not isinstance(value, Sequence) or isinstance(value, str) or not all(isinstance(v, str) for v in value):
            raise self._error(where, f"expected a list of words, got {value!r}")
        return tuple(value if valid is None else [self._choice(where, word, valid) for word in value])

    def _numbers(self, where: str, value: object, *, count: int | None = None) -> Any:
        if not isinstance(value, Sequence) or isinstance(value, str) or (count is not None and len(value) != count):
            raise self._error(where, f"expected {count or 'some'} numbers, got {value!r}")
        return tuple(self._number(where, item) for item in value)

    def _points(self, where: str, value: object) -> tuple[tuple[float, ...], ...]:
        """Two to five places, which may lie on either side of the frame."""
        if not isinstance(value, Sequence) or not 2 <= len(value) <= 5:
            raise self._error(where, f"got {value!r}", "2 to 5 points [x, y, z]")
        for point in value:
            if not isinstance(point, Sequence) or len(point) != 3 or not all(_finite(v) for v in point):
                raise self._error(where, f"got {point!r}", "points [x, y, z]")
        return tuple(tuple(float(v) for v in point) for point in value)

    def _number(self, where: str, value: object, *, positive: bool = False) -> float:
        if not _finite(value) or value < 0 or (positive and value == 0):
            raise self._error(where, f"got {value!r}", "numbers above 0" if positive else "numbers from 0 up")
        return float(value)

    def _whole(self, where: str, value: object) -> int:
        if isinstance(value, bool) or not isinstance(value, int) or value < 0:
            raise self._error(where, f"got {value!r}", "whole numbers from 0 up")
        return value

    def _look(self, value: object) -> str:
        # Which names there are, only drawing knows: facts alone need neither meshes nor pictures.
        if not isinstance(value, str):
            raise self._error("look", f"got {value!r}", "the name of a drawn shape")
        return value

    def _error(self, where: str, problem: str, valid: Iterable[object] | str = "") -> KitchenFileError:
        return KitchenFileError(self.source, f"{self.name}.{where}" if where else self.name, problem, valid)


def _finite(value: object) -> TypeGuard[float]:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and abs(value) <= sys.float_info.max  # type: ignore[arg-type] # false for NaN
