"""What objects look like: each a few coloured meshes in the frame of its colliders. No simulator needed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType

from remac_env.errors import check_choice
from remac_env.kitchen.objects import drawn, food, tableware
from remac_env.kitchen.objects.part import DrawnPart

Maker = Callable[[], tuple[DrawnPart, ...]]

SHAPES: Mapping[str, Maker] = MappingProxyType(
    {
        "carrot": food.carrot,
        "eggplant": food.eggplant,
        "corn": food.corn,
        "potato": food.potato,
        "tomato": food.tomato,
        "fish": food.fish,
        "steak": food.steak,
        "plate": tableware.plate,
        "bowl": tableware.bowl,
        "pan": tableware.pan,
        "mug": tableware.mug,
        "bottle": tableware.bottle,
        "seasoning": tableware.seasoning,
    }
)
"""Makers of drawn shapes that are code, by name; the others are data, see `drawn`."""


def names() -> tuple[str, ...]:
    """The names of all drawn shapes."""
    return (*SHAPES, *drawn.tables())


@lru_cache(maxsize=128)
def shape(name: str) -> tuple[DrawnPart, ...]:
    """The parts of a drawn shape, made once a process. UnknownNameError lists the names."""
    check_choice("drawn shape", name, names())
    return SHAPES[name]() if name in SHAPES else drawn.build(name)
