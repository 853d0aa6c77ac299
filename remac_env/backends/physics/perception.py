"""Poses as one robot sees them: of objects and of fixtures, each off by an error that is drawn once a round.

Everything that is not the robot itself is misjudged: objects, fixtures with their handles, switches and slots, and so
the world in which paths are checked. Each object is misjudged as a whole, and each fixture: moved in three directions
and turned about the vertical. What a hand holds stays as misjudged as it was when the hand took it.

Not misjudged: the robot itself, other robots (which tell where they are), how far a door or switch stands open or is
turned, and the floor plan, by which drives choose the ways that they then check.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from remac_env.kitchen.fixtures import Fixture
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots.rotation import Array, about_z

LEVER = 0.15
"""m: turns are drawn so that a point so far from the middle is off by as much as the middle is; so far, or half the
length of what is larger, which shows its turn better."""


@dataclass(frozen=True)
class Error:
    """A misjudged place: a shift (3,), m, and a turn about the vertical, rad, about ``pivot`` (3,); world frame."""

    shift: Array
    turn: float
    pivot: Array

    def point(self, point: Array) -> Array:
        """Where a point (3,) of what is misjudged seems to be."""
        return self.pivot + self.shift + about_z(self.turn) @ (point - self.pivot)


@dataclass(frozen=True)
class HeldError:
    """The same of an object in a hand, expressed in the object's own frame: shift (3,), m, and rotation (3, 3)."""

    shift: Array
    rotation: Array


class Perception:
    """What one robot misjudges. ``objects`` and ``fixtures``: errors by name; none where perception is perfect."""

    def __init__(self) -> None:
        self.objects: dict[str, Error | HeldError] = {}
        self.fixtures: dict[str, Error] = {}

    def draw(
        self, chance: np.random.Generator, noise: float, layout: Layout, objects: Mapping[str, Category],
        held: str | None,
    ) -> None:
        """Draw all errors anew, but for an object that the hand holds; ``noise``: standard deviation, m."""
        in_hand = self.objects.get(held) if held else None
        drawn: dict[str, Error | HeldError] = {
            name: _error(chance, noise, np.zeros(3), max(objects[name].size[:2])) for name in sorted(objects)
        }
        self.objects = drawn
        if held and isinstance(in_hand, HeldError):
            self.objects[held] = in_hand
        self.fixtures = {}
        for name in sorted(layout.fixtures):
            middle, half = _extent(layout.fixtures[name])
            self.fixtures[name] = _error(chance, noise, np.array(layout.frame(name).space(middle)), half)

    def seen(self, name: str, position: Array, rotation: Array) -> tuple[Array, Array]:
        """How an object at ``position`` (3,) and ``rotation`` (3, 3), world frame, is seen."""
        error = self.objects.get(name)
        if error is None:
            return position, rotation
        if isinstance(error, HeldError):
            return position + rotation @ error.shift, rotation @ error.rotation
        return position + error.shift, about_z(error.turn) @ rotation

    def hold(self, name: str, rotation: Array) -> None:
        """From now on an object with ``rotation`` (3, 3) in the world keeps its error as it turns with the hand."""
        error = self.objects.get(name)
        if isinstance(error, Error):
            self.objects[name] = HeldError(rotation.T @ error.shift, rotation.T @ about_z(error.turn) @ rotation)


def _error(chance: np.random.Generator, noise: float, pivot: Array, half: float) -> Error:
    shift = chance.normal(0.0, noise, 3)
    return Error(shift, float(chance.normal(0.0, noise / max(LEVER, half))), pivot)


def _extent(fixture: Fixture) -> tuple[tuple[float, float, float], float]:
    """The middle of a fixture, frame of its wall, and half its longer side seen from above, m."""
    blocks = fixture.blocks
    if not blocks:
        return (0.0, 0.0, 0.0), 0.0
    low, high = (np.array([getattr(block, end) for block in blocks]) for end in ("low", "high"))
    least, most = low.min(axis=0), high.max(axis=0)
    x, y, z = 0.5 * (least + most)
    return (float(x), float(y), float(z)), float(0.5 * (most - least)[:2].max())
