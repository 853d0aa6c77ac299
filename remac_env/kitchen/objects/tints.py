"""Colours that tell objects of one kind apart, read from tints.toml: a "red mug" is drawn in red. No simulator."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from remac_env.files import read_text
from remac_env.kitchen.objects.part import DrawnPart
from remac_env.kitchen.style import Color, hex_color

FILE = Path(__file__).with_name("tints.toml")

_ALIKE = 0.15
"""Distance up to which two colours, each in 0..1, are shades of one."""


@cache
def load() -> Mapping[str, Color]:
    """Every colour by its word; raises KitchenFileError."""
    words = tomllib.loads(read_text(FILE))
    return {word: hex_color(FILE, word, value) for word, value in words.items()}


def tint_of(noun: str, category: str) -> Color | None:
    """The colour that a noun gives an object: that of its first word, where the rest is what it is."""
    word, _, rest = noun.partition(" ")
    return load().get(word) if rest == category else None


def tinted(parts: Sequence[DrawnPart], color: Color) -> tuple[DrawnPart, ...]:
    """The parts with this colour in place of the one that most of the first part has."""
    main = _main_color(parts[0])
    return tuple(_tinted(part, main, np.array(color)) for part in parts)


def _main_color(part: DrawnPart) -> np.ndarray:
    if part.picture is None:
        return np.array(part.finish.color)
    colors, counts = np.unique(part.picture.reshape(-1, 3), axis=0, return_counts=True)
    return colors[int(counts.argmax())] / 255.0


def _tinted(part: DrawnPart, main: np.ndarray, color: np.ndarray) -> DrawnPart:
    if part.picture is None:
        alike = float(np.linalg.norm(np.array(part.finish.color) - main)) <= _ALIKE
        return replace(part, finish=replace(part.finish, color=tuple(color))) if alike else part
    shades = part.picture / 255.0
    alike = np.linalg.norm(shades - main, axis=2) <= _ALIKE
    lighter = shades.mean(axis=2, keepdims=True) - main.mean()
    picture = np.where(alike[..., None], np.clip(color + lighter, 0.0, 1.0), shades)
    return replace(part, picture=(255.0 * picture).round().astype(np.uint8))
