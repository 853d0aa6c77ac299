"""Drawn shapes read from `visual/*.toml`: lists of parts, each one mesh by one of `MAKERS`. No simulator needed.

Lengths are metres, angles radians. Every part has `make`, the measures of that maker, and of these what it needs:
    color       "#rrggbb"; shine: specular and shininess, 0..1; paint: strokes over the colour (`paint.STROKES`)
    repeat      how many copies, evenly turned around the z axis
    wobble      [lobes around z, depth as a share of the radius]
    lie         true: what is given upright, along z, lies along x
    spin        turn about z at the end; at: where the part is moved to
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from inspect import Parameter, signature
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from remac_env.errors import KitchenFileError
from remac_env.files import read_text
from remac_env.kitchen.meshes import (
    Mesh,
    leaf,
    merge,
    revolve,
    rotation,
    rounded_box,
    slab,
    smooth_profile,
    transform,
    tube,
)
from remac_env.kitchen.objects.paint import paint
from remac_env.kitchen.objects.part import DrawnPart
from remac_env.kitchen.style import Finish, hex_color

FOLDER = Path(__file__).with_name("visual")
_UP = (0, 0, 1)
_SHARED = ("color", "shine", "paint", "repeat", "wobble", "lie", "spin", "at")


@lru_cache(maxsize=1)
def tables() -> Mapping[str, tuple[Path, Sequence[Mapping[str, Any]]]]:
    """The file and the parts of every drawn shape by name. KitchenFileError for a file that cannot be read."""
    found: dict[str, tuple[Path, Sequence[Mapping[str, Any]]]] = {}
    for file in sorted(FOLDER.glob("*.toml")):
        try:
            shapes = tomllib.loads(read_text(file))
        except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise KitchenFileError(file, "file", f"cannot be read: {error}") from error
        found.update({name: (file, parts) for name, parts in shapes.items()})
    return MappingProxyType(found)


def build(name: str) -> tuple[DrawnPart, ...]:
    """The parts of a drawn shape of `tables`."""
    source, parts = tables()[name]
    return tuple(part(table, source=source, where=f"{name}[{i}]") for i, table in enumerate(parts))


def part(table: Mapping[str, Any], *, source: object, where: str) -> DrawnPart:
    """One part from its table. Raises KitchenFileError naming the source, the key and the valid values."""
    kind = str(table.get("make", ""))
    if kind not in MAKERS:
        raise KitchenFileError(source, f"{where}.make", f"got {kind!r}", list(MAKERS))
    takes = signature(MAKERS[kind]).parameters
    for key in table.keys() - {"make", *takes, *_SHARED}:
        raise KitchenFileError(source, f"{where}.{key}", "is not a known key", [*takes, *_SHARED])
    for key, measure in takes.items():
        if measure.default is Parameter.empty and key not in table:
            raise KitchenFileError(source, f"{where}.{key}", "is missing")
    try:
        mesh = _placed(MAKERS[kind](**{key: table[key] for key in takes if key in table}), table)
    except (TypeError, ValueError, IndexError) as error:
        raise KitchenFileError(source, where, f"cannot be made: {error}", list(takes)) from error
    color, strokes = str(table.get("color", "")), table.get("paint", ())
    specular, shininess = table.get("shine", (0.2, 0.4))
    plain = hex_color(source, f"{where}.color", color)
    finish = Finish(color=(1.0, 1.0, 1.0) if strokes else plain, specular=specular, shininess=shininess)
    return DrawnPart(mesh, finish, paint(color, strokes, source=source, where=where) if strokes else None)


def _placed(mesh: Mesh, table: Mapping[str, Any]) -> Mesh:
    if "wobble" in table:
        lobes, depth = table["wobble"]
        x, y, z = mesh.vertices.T
        swell = 1 + depth * np.cos(lobes * np.arctan2(y, x))
        mesh = Mesh(np.column_stack([swell * x, swell * y, z]), mesh.faces, mesh.uv)
    count = table.get("repeat", 1)
    mesh = merge(*(transform(mesh, rotation=rotation(_UP, 2 * np.pi * i / count)) for i in range(count)))
    if table.get("lie"):
        mesh = transform(mesh, rotation=rotation((0, 1, 0), np.pi / 2))
    return transform(mesh, rotation=rotation(_UP, table.get("spin", 0.0)), position=table.get("at", (0, 0, 0)))


def _lathe(profile: Any, smooth: int = 0, sides: int = 20) -> Mesh:
    return revolve(smooth_profile(profile, samples=smooth) if smooth else profile, sides=sides)


def _ball(half: Any, lumps: float = 0.0, sides: int = 16) -> Mesh:
    """An ellipsoid, its z axis the pole; `lumps` dents it by that share."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, 12)
    unit = revolve(np.column_stack([np.maximum(np.cos(angle), 0), np.sin(angle)]), sides=sides)
    x, y, z = unit.vertices.T
    dents = 1 + lumps * (np.sin(3 * x + 2) * np.cos(2.5 * y + 1) + 0.6 * np.sin(5 * z + 1))
    return transform(Mesh(unit.vertices * dents[:, None], unit.faces, unit.uv), scale=half)


def _tube(path: Any, radius: Any, sides: int = 10, squash: Any = (1.0, 1.0), smooth: int = 0) -> Mesh:
    """A tube; `smooth` samples of a curve through the path (and the radii) where given."""
    points = np.asarray(path, dtype=float)
    radii = np.broadcast_to(np.asarray(radius, dtype=float), (len(points),))
    if smooth:
        # smooth_profile keeps its first column positive: the radii go there.
        columns = [smooth_profile(np.column_stack([radii, axis]), samples=smooth) for axis in points.T]
        points, radii = np.column_stack([c[:, 1] for c in columns]), np.maximum(columns[0][:, 0], 0.0008)
    return tube(points, radii, sides=sides, squash=tuple(squash))


def _leaf(length: float, width: float, curl: float, base: Any = (0, 0, 0), azimuth: float = 0.0) -> Mesh:
    return leaf(length, width, curl=curl, base=base, azimuth=azimuth)


def _box(half: Any, radius: float = 0.003, shift: Any = (0, 0, 0)) -> Mesh:
    """A box around `shift` with rounded edges; every side shows the whole picture."""
    mesh = rounded_box(half, radius=radius)
    half = np.asarray(half, dtype=float)
    side = np.abs(mesh.vertices / half).argmax(axis=1) if mesh.normals is None else np.abs(mesh.normals).argmax(axis=1)
    sign = np.sign(mesh.vertices[np.arange(len(side)), side])
    across, up = np.where(side == 0, 1, 0), np.where(side == 2, 1, 2)
    rows = np.arange(len(side))
    u = mesh.vertices[rows, across] / half[across]
    u = np.where((side == 0) & (sign < 0) | (side == 1) & (sign > 0), -u, u)
    uv = np.column_stack([u, mesh.vertices[rows, up] / half[up]]) * 0.499 + 0.5
    return Mesh(mesh.vertices + np.asarray(shift, dtype=float), mesh.faces, uv, mesh.normals)


def _slab(outline: Any, thick: float) -> Mesh:
    """A flat plate; its top shows the whole picture."""
    mesh = slab(outline, thick)
    low, high = mesh.bounds
    return Mesh(mesh.vertices, mesh.faces, (mesh.vertices[:, :2] - low[:2]) / (high - low)[:2], mesh.normals)


def _ring(radius: float, thick: float, squash: Any = (1.0, 1.0), sides: int = 12, around: int = 28) -> Mesh:
    turn = np.linspace(0, 2 * np.pi, around, endpoint=False)
    circle = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), 0 * turn])
    return tube(circle, thick, sides=sides, closed=True, squash=tuple(squash))


def _seeds(half: Any, count: int, grain: Any, least: float = 0.2, seed: int = 1) -> Mesh:
    """Small ellipsoids `grain` scattered over the upper part of an ellipsoid, from the share `least` of its height."""
    rng = np.random.default_rng(seed)
    height, turn = rng.uniform(least, 1.0, count), np.arange(count) * 2.39996  # the golden angle spreads them evenly
    flat = np.sqrt(1 - height**2)
    at = np.column_stack([flat * np.cos(turn), flat * np.sin(turn), height]) * np.asarray(half, dtype=float)
    angle = np.linspace(-np.pi / 2, np.pi / 2, 5)
    ball = revolve(np.column_stack([np.maximum(np.cos(angle), 0), np.sin(angle)]), sides=6)
    return merge(
        *(transform(ball, scale=grain, rotation=rotation(_UP, 1.7 * i), position=p) for i, p in enumerate(at))
    )


MAKERS: Mapping[str, Callable[..., Mesh]] = MappingProxyType(
    {
        "lathe": _lathe, "ball": _ball, "tube": _tube, "leaf": _leaf, "box": _box, "slab": _slab, "ring": _ring,
        "seeds": _seeds,
    }
)  # fmt: skip
"""Makers of meshes by name; the measures are their parameters."""
