"""The forms of colliders as facts: which measures each has and the room it takes up. No simulator needed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

Corner = tuple[float, float, float]

FORMS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "capsule": ("radius", "half_length"),
        "ellipsoid": ("half",),
        "loaf": ("half",),
        "dish": ("radius", "base_radius", "height", "wall"),
        "cup": ("radius", "height", "wall"),
        "bottle": ("radius", "shoulder", "neck_radius", "height"),
        "can": ("radius", "height"),
        "box": ("half",),
        "chain": ("points", "radii"),
    }
)
"""Forms and the measures that each needs, m. A loaf is a flat cushion; a chain is capsules from each point to the next,
one radius each. Capsule, ellipsoid and loaf have their frame in the middle, a chain where fingers close on it, x the
long way; the others stand on their frame's origin, turned about z (a box with x, y and z along its edges)."""

VECTORS = ("half",)
"""Measures that are three lengths."""

OPTIONAL_MEASURES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"dish": ("handle_radius", "handle_from", "handle_to", "handle_mass"), "cup": ("handle",)}
)
"""Further measures: a dish may have a bar towards -y (mass in kg), a cup an ear towards +x that reaches so far, m."""


@dataclass(frozen=True)
class Body:
    """What an object collides with: a form of `FORMS` and its measures, m."""

    form: str
    measures: Mapping[str, Any]

    def __getitem__(self, measure: str) -> Any:
        return self.measures[measure]

    @property
    def handle(self) -> float:
        """How far a handle reaches beyond the body's radius, m; 0 where there is none."""
        if "handle_to" in self.measures:
            return float(self["handle_to"] - self["radius"])
        return float(self.measures.get("handle", 0.0))

    @property
    def bounds(self) -> tuple[Corner, Corner]:
        """Lowest and highest corner of the box around the body in its own frame, m."""
        if self.form in ("ellipsoid", "loaf", "box"):
            x, y, z = self["half"]
            return ((-x, -y, 0.0), (x, y, 2 * z)) if self.form == "box" else ((-x, -y, -z), (x, y, z))
        if self.form == "chain":
            return _chain_bounds(self["points"], self["radii"])
        radius = self["radius"]
        if self.form == "capsule":
            return (-radius - self["half_length"], -radius, -radius), (
                radius + self["half_length"],
                radius,
                radius,
            )
        front = radius + self.handle if self.form == "dish" else radius
        right = radius + self.handle if self.form == "cup" else radius
        return (-radius, -front, 0.0), (right, radius, self["height"])


def _chain_bounds(points: tuple[Corner, ...], radii: tuple[float, ...]) -> tuple[Corner, Corner]:
    ends = [(end, radius) for i, radius in enumerate(radii) for end in points[i : i + 2]]
    low = [min(end[axis] - radius for end, radius in ends) for axis in range(3)]
    high = [max(end[axis] + radius for end, radius in ends) for axis in range(3)]
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])
