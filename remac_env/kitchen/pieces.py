"""Meshes of boards and of straight round bars, of which most furniture is made.

The simulator draws its own cylinders with hundreds of triangles each, and a kitchen has a hundred thin handles. Meshes
are kept once made: a kitchen is drawn anew for every style, always from the same pieces.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from remac_env.kitchen.meshes import Mesh, plain_box, rounded_box, transform

Point = tuple[float, float, float]

_CAP_STEPS = 3  # rings from the equator of a round end to its pole


@lru_cache(maxsize=4096)
def board(low: Point, high: Point, radius: float, segments: int, world_grain: bool) -> Mesh:
    """Return a box between two corners, m, with edges rounded by `radius`, or sharp ones where it is 0.

    uv in metres, of the world or from the middle of the box.
    """
    half, middle = (np.asarray(high) - low) / 2, (np.asarray(low) + high) / 2
    offset = middle[[0, 2] if half[1] < half[2] else [0, 1]] if world_grain else (0.0, 0.0)
    if radius == 0:
        return transform(plain_box(half, uv_offset=offset), position=middle)
    return transform(rounded_box(half, radius=radius, segments=segments, uv_offset=offset), position=middle)


@lru_cache(maxsize=4096)
def bar(start: Point, end: Point, radius: float, round_ends: bool) -> Mesh:
    """Return a bar of `radius`, m, whose axis runs from start to end; round ends reach one radius beyond them.

    Thick bars get more sides than thin ones. uv: 0 to 1 around, metres along.
    """
    base, tip = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    length = float(np.linalg.norm(tip - base))
    if length <= 0 or radius <= 0:
        raise ValueError(f"a bar needs a length and a radius, got {length} and {radius}")
    sides = 10 if radius < 0.012 else 16 if radius < 0.05 else 32
    profile = _round_profile(radius, length) if round_ends else _flat_profile(radius, length)
    turn = np.linspace(0, 2 * np.pi, sides + 1)
    axis = (tip - base) / length
    across = np.cross(axis, (0.0, 0.0, 1.0) if abs(axis[2]) < 0.9 else (1.0, 0.0, 0.0))
    across /= np.linalg.norm(across)
    spokes = np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * np.cross(axis, across)
    distance, along, outward, forward = (column[:, None, None] for column in profile.T)
    vertices = base + distance * spokes + along * axis
    normals = outward * spokes + forward * axis
    rows = len(profile)
    uv = np.stack(np.broadcast_arrays(turn / (2 * np.pi), profile[:, 1][:, None]), axis=-1)
    faces = _band_faces(profile, rows, sides)
    return Mesh(vertices.reshape(-1, 3), faces, uv.reshape(-1, 2), normals.reshape(-1, 3))


def _flat_profile(radius: float, length: float) -> NDArray[np.float64]:
    """Rows of (distance from the axis, along the axis, outward and forward part of the normal)."""
    return np.array(
        [
            (0, 0, 0, -1),
            (radius, 0, 0, -1),
            (radius, 0, 1, 0),
            (radius, length, 1, 0),
            (radius, length, 0, 1),
            (0, length, 0, 1),
        ],
        dtype=float,
    )


def _round_profile(radius: float, length: float) -> NDArray[np.float64]:
    """Rows as `_flat_profile`, with half a ball at each end."""
    rise = np.linspace(0, np.pi / 2, _CAP_STEPS + 1)
    top = np.stack([radius * np.cos(rise), length + radius * np.sin(rise), np.cos(rise), np.sin(rise)], axis=1)
    bottom = np.stack([radius * np.cos(rise), -radius * np.sin(rise), np.cos(rise), -np.sin(rise)], axis=1)[::-1]
    return np.concatenate([bottom, top])


def _band_faces(profile: NDArray[np.float64], rows: int, sides: int) -> NDArray[np.int64]:
    """Two triangles for each cell between two rows, leaving out those without area."""
    faces: list[tuple[int, int, int]] = []
    for row in range(rows - 1):
        if np.allclose(profile[row, :2], profile[row + 1, :2]):
            continue
        for side in range(sides):
            a = row * (sides + 1) + side
            b, c, d = a + 1, a + sides + 2, a + sides + 1
            if profile[row, 0] > 1e-9:
                faces.append((a, b, c))
            if profile[row + 1, 0] > 1e-9:
                faces.append((a, c, d))
    return np.array(faces, dtype=np.int64)
