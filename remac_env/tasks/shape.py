"""What the fields of a declared value have to be: refused where it is made, by the name of the field that is wrong."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from remac_env.errors import OptionError
from remac_env.quoting import quoted


@dataclass(frozen=True)
class Shape:
    """What a field takes: `fits` tells, and `said` says it."""

    said: str
    fits: Callable[[Any], bool]


TEXT = Shape("a text of printable characters", lambda value: isinstance(value, str) and value.isprintable())
NAME = Shape("a name", lambda value: TEXT.fits(value) and bool(value.strip()))
SWITCH = Shape("True or False", lambda value: isinstance(value, bool))
WHOLE = Shape("a whole number from 0", lambda value: type(value) is int and 0 <= value < 2**31)
SECONDS = Shape("seconds, above 0", lambda value: type(value) in (int, float) and 0 < value < math.inf)


def several(part: Shape, *, least: int = 0, most: float = math.inf) -> Shape:
    """A tuple, or list, of these."""
    count = "" if not least else "one or more: " if most == math.inf else f"{least}: "
    return Shape(
        f"a tuple of {count}{part.said}",
        lambda value: isinstance(value, tuple | list) and least <= len(value) <= most and all(map(part.fits, value)),
    )


def pair(first: Shape, second: Shape) -> Shape:
    """Two values."""
    def fits(value: Any) -> bool:
        return isinstance(value, tuple | list) and len(value) == 2 and first.fits(value[0]) and second.fits(value[1])

    return Shape(f"({first.said}, {second.said})", fits)


def table(part: Shape) -> Shape:
    """Texts, and what each stands for."""
    def fits(value: Any) -> bool:
        return isinstance(value, Mapping) and all(TEXT.fits(key) and part.fits(each) for key, each in value.items())

    return Shape(f"a mapping from texts to {part.said}", fits)


def optional(part: Shape) -> Shape:
    """None too."""
    return Shape(f"{part.said}, or None", lambda value: value is None or part.fits(value))


def one_of(kind: type | tuple[type, ...], said: str) -> Shape:
    """Values of a class."""
    return Shape(said, lambda value: isinstance(value, kind))


ANY = Shape("anything", lambda value: True)


def check_fields(made: object, shapes: Mapping[str, Shape], where: str) -> None:
    """Refuse a value with a field that is not what it has to be.

    Raises:
        OptionError: naming where, the field, what it was given and what is valid.
    """
    for name, shape in shapes.items():
        if not shape.fits(value := getattr(made, name)):
            raise OptionError(f"{where}: {name} {quoted(value)} is not valid; valid: {shape.said}")
