"""What things look like: each a few coloured meshes in the frame of its colliders. No simulator needed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType

from remac_env.errors import check_choice
from remac_env.kitchen.objects import food, tableware
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
"""Makers of drawn shapes by name."""


@lru_cache(maxsize=64)
def shape(name: str) -> tuple[DrawnPart, ...]:
    """The parts of a drawn shape, made once a process. UnknownNameError lists the names."""
    check_choice("drawn shape", name, SHAPES)
    return SHAPES[name]()
