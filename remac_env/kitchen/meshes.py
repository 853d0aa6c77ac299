"""Meshes made from numbers: bevelled boxes, solids of revolution, tubes, leaves, slabs and lofts.

Pure numpy, no simulator. Lengths are metres, angles radians, right-handed frames with z up. Faces are
counter-clockwise seen from outside. Texture coordinates of boxes are metres on the surface, so that one texture keeps
one scale on every board it covers; round shapes run from 0 to 1 around (u) and along the profile or path (v).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from remac_env.kitchen.mesh import Floats, Ints, Mesh, add_mesh, merge, rotation, transform

__all__ = [
    "Floats",
    "Mesh",
    "add_mesh",
    "leaf",
    "loft",
    "plain_box",
    "merge",
    "revolve",
    "rotation",
    "rounded_box",
    "slab",
    "smooth_profile",
    "transform",
    "tube",
]


def rounded_box(
    half_extents: ArrayLike,
    *,
    radius: float,
    segments: int = 1,
    uv_scale: float = 1.0,
    uv_offset: ArrayLike = (0.0, 0.0),
) -> Mesh:
    """A box centred on the origin whose edges are rounded with `segments` arc steps on either side of each edge.

    The radius is cut to just under the smallest half extent. uv = metres * uv_scale + uv_offset: (x, y) on the top and
    bottom, horizontal and z on the sides. A world offset lets neighbouring boards continue one another's grain.
    """
    half = np.asarray(half_extents, dtype=float)
    if half.shape != (3,) or half.min() <= 0:
        raise ValueError(f"half_extents must be three positive lengths, got {half_extents!r}")
    if radius <= 0 or segments < 1:
        raise ValueError(f"radius must be positive and segments at least 1, got {radius} and {segments}")
    radius = min(radius, 0.999 * float(half.min()))
    sides = [_box_side(half, radius, segments, axis, sign) for axis in range(3) for sign in (1, -1)]
    points = np.concatenate([side[0] for side in sides])
    normals = np.concatenate([side[1] for side in sides])
    uv = np.concatenate([side[2] for side in sides]) * uv_scale + np.asarray(uv_offset, dtype=float)
    per_side = len(sides[0][0])
    faces = np.concatenate([side[3] + per_side * i for i, side in enumerate(sides)])
    return Mesh(points, faces, uv, normals)


def plain_box(half_extents: ArrayLike, *, uv_offset: ArrayLike = (0.0, 0.0)) -> Mesh:
    """A box with sharp edges, a ninth of the triangles of a rounded one; uv as there. half_extents: three lengths."""
    half = np.asarray(half_extents, dtype=float)
    if half.shape != (3,) or half.min() <= 0:
        raise ValueError(f"half_extents must be three positive lengths, got {half_extents!r}")
    points, normals = np.empty((6, 4, 3)), np.zeros((6, 4, 3))
    faces, uv = np.empty((6, 2, 3), dtype=np.int64), np.empty((6, 4, 2))
    turn = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    for number in range(6):
        axis, sign = number // 2, 1 - 2 * (number % 2)
        around = list(((1, 2), (2, 0), (0, 1))[axis])
        points[number][:, around] = turn * half[around]
        points[number][:, axis] = sign * half[axis]
        normals[number][:, axis] = sign
        uv[number] = points[number][:, list(((1, 2), (0, 2), (0, 1))[axis])]
        faces[number] = 4 * number + np.array([(0, 1, 2), (0, 2, 3)])[:, ::sign]
    offset = np.asarray(uv_offset, dtype=float)
    return Mesh(points.reshape(-1, 3), faces.reshape(-1, 3), uv.reshape(-1, 2) + offset, normals.reshape(-1, 3))


def _box_side(half: Floats, radius: float, segments: int, axis: int, sign: int) -> tuple[Floats, Floats, Floats, Ints]:
    """One of the six sides: a grid on the cube's face, pushed onto the rounded surface."""
    first, second = ((1, 2), (2, 0), (0, 1))[axis]
    inner = half - radius
    arc = radius * np.tan(np.linspace(0, np.pi / 4, segments + 1))
    along_first = np.concatenate([-inner[first] - arc[::-1], inner[first] + arc])
    along_second = np.concatenate([-inner[second] - arc[::-1], inner[second] + arc])
    size = len(along_first)
    points = np.empty((size, size, 3))
    points[..., first], points[..., second] = np.meshgrid(along_first, along_second, indexing="ij")
    points[..., axis] = sign * half[axis]
    core = np.clip(points, -inner, inner)
    normals = points - core
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    points = core + radius * normals
    horizontal, vertical = ((1, 2), (0, 2), (0, 1))[axis]
    uv = points[..., [horizontal, vertical]]
    faces = _grid_faces(size, size)
    return (
        points.reshape(-1, 3),
        normals.reshape(-1, 3),
        uv.reshape(-1, 2),
        faces if sign > 0 else faces[:, ::-1],
    )


def _grid_faces(rows: int, columns: int) -> Ints:
    """Two triangles for each cell of a (rows, columns) grid of vertices stored row by row."""
    row, column = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (row * columns + column).ravel()
    b, c, d = a + columns, a + columns + 1, a + 1
    return np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)], axis=1).reshape(-1, 3)


def smooth_profile(points: ArrayLike, *, samples: int = 24) -> Floats:
    """(samples, 2) points of a Catmull-Rom curve through (radius, z) control points; radii never go below zero."""
    control = np.asarray(points, dtype=float)
    if control.ndim != 2 or control.shape[1] != 2 or len(control) < 2:
        raise ValueError(f"a profile needs at least two (radius, z) points, got shape {control.shape}")
    padded = np.vstack([2 * control[0] - control[1], control, 2 * control[-1] - control[-2]])
    at = np.linspace(0, len(control) - 1, samples)
    index = np.minimum(at.astype(int), len(control) - 2)
    t = (at - index)[:, None]
    a, b, c, d = (padded[index + k] for k in range(4))
    curve = 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
    curve[:, 0] = np.maximum(curve[:, 0], 0.0)
    curve[0], curve[-1] = control[0], control[-1]
    return curve


def revolve(profile: ArrayLike, *, sides: int = 24) -> Mesh:
    """Turn a profile of (radius, z) points around the z axis.

    List the points from the bottom outwards and up for outward faces (and down the inside again for a hollow vessel).
    Points of radius 0 become poles. The first column of vertices is repeated at the seam, for the texture.
    """
    points = np.asarray(profile, dtype=float)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2 or points[:, 0].min() < 0:
        raise ValueError(f"a profile needs at least two (radius >= 0, z) points, got shape {points.shape}")
    angle = np.linspace(0, 2 * np.pi, sides + 1)
    radius, height = points[:, :1], points[:, 1:]
    vertices = np.stack(
        [radius * np.cos(angle), radius * np.sin(angle), np.broadcast_to(height, (len(points), sides + 1))],
        axis=-1,
    )
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)]) / steps.sum()
    uv = np.stack(np.broadcast_arrays(angle / (2 * np.pi), along[:, None]), axis=-1)
    faces = _grid_faces(len(points), sides + 1)[:, ::-1]
    flat = vertices.reshape(-1, 3)
    return Mesh(flat, _drop_degenerate(flat, faces), uv.reshape(-1, 2))


def _drop_degenerate(vertices: Floats, faces: Ints) -> Ints:
    """Faces without those that have no area, such as the triangles between two copies of a pole."""
    corner = vertices[faces]
    doubled_area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    return faces[doubled_area > 1e-12]


def tube(
    path: ArrayLike,
    radius: ArrayLike,
    *,
    sides: int = 12,
    closed: bool = False,
    squash: tuple[float, float] = (1.0, 1.0),
) -> Mesh:
    """Sweep a circle along a path of (k, 3) points, without twist; ends are capped unless the path is closed.

    radius: one number or k numbers. squash scales the two axes of the circle: the first is horizontal where the path
    allows it.
    """
    points = np.asarray(path, dtype=float)
    count = len(points)
    if points.shape != (count, 3) or count < 2:
        raise ValueError(f"a path needs at least two (x, y, z) points, got shape {points.shape}")
    radii = np.broadcast_to(np.asarray(radius, dtype=float), (count,))
    across, upward = _sweep_axes(points, closed)
    angle = np.linspace(0, 2 * np.pi, sides + 1)[None, :, None]
    circle = squash[0] * np.cos(angle) * across[:, None] + squash[1] * np.sin(angle) * upward[:, None]
    rings = points[:, None] + radii[:, None, None] * circle
    if closed:
        rings = np.concatenate([rings, rings[:1]])
    rows = len(rings)
    uv = np.stack(np.broadcast_arrays(angle[:, :, 0] / (2 * np.pi), np.linspace(0, 1, rows)[:, None]), axis=-1)
    vertices, coordinates = rings.reshape(-1, 3), uv.reshape(-1, 2)
    faces = _grid_faces(rows, sides + 1)[:, ::-1]
    if not closed:
        first, last = len(vertices), len(vertices) + 1
        ring = np.arange(sides)
        end = (rows - 1) * (sides + 1)
        start_cap = np.stack([np.full(sides, first), ring + 1, ring], axis=-1)
        end_cap = np.stack([np.full(sides, last), end + ring, end + ring + 1], axis=-1)
        vertices = np.concatenate([vertices, points[:1], points[-1:]])
        coordinates = np.concatenate([coordinates, [[0.5, 0.0], [0.5, 1.0]]])
        faces = np.concatenate([faces, start_cap, end_cap])
    return Mesh(vertices, _drop_degenerate(vertices, faces), coordinates)


def _sweep_axes(points: Floats, closed: bool) -> tuple[Floats, Floats]:
    """Two unit vectors (k, 3) across the path at each point, carried along it without twist."""
    tangent = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0) if closed else np.gradient(points, axis=0)
    tangent = tangent / np.linalg.norm(tangent, axis=1, keepdims=True)
    side = np.cross(tangent[0], (0.0, 0.0, 1.0))
    if np.linalg.norm(side) < 1e-3:
        side = np.cross(tangent[0], (0.0, 1.0, 0.0))
    across = np.empty_like(points)
    for i, direction in enumerate(tangent):
        side = side - direction * (side @ direction)
        side = side / np.linalg.norm(side)
        across[i] = side
    return across, np.cross(tangent, across)


def leaf(
    length: float,
    width: float,
    *,
    curl: float,
    azimuth: float = 0.0,
    base: ArrayLike = (0.0, 0.0, 0.0),
    sides: int = 6,
) -> Mesh:
    """A pointed leaf that grows from `base` at elevation `curl` (rad), bending over, turned by `azimuth` about z."""
    along = np.linspace(0, 1, 6)
    bend = curl * (1 - 0.3 * along)
    path = np.stack([along * length * np.cos(bend), 0 * along, along * length * np.sin(bend)], axis=-1)
    half_width = np.maximum(width * np.sin(np.pi * np.clip(along * 0.95 + 0.05, 0, 1)) ** 0.8, 0.0008)
    blade = tube(path, half_width, sides=sides, squash=(1.0, 0.25))
    return transform(blade, position=base, rotation=rotation((0, 0, 1), azimuth))


def slab(outline: ArrayLike, thickness: float) -> Mesh:
    """A flat plate: a star-shaped counter-clockwise outline of (k, 2) points in the x-y plane, centred on z = 0.

    Flat sides with sharp edges; uv are metres (x, y).
    """
    edge = np.asarray(outline, dtype=float)
    if edge.ndim != 2 or edge.shape[1] != 2 or len(edge) < 3:
        raise ValueError(f"an outline needs at least three (x, y) points, got shape {edge.shape}")
    half = thickness / 2
    return loft([np.column_stack([edge, np.full(len(edge), z)]) for z in (-half, half)])


def loft(rings: Sequence[ArrayLike], *, capped: bool = True) -> Mesh:
    """Join rings of equally many points, each counter-clockwise seen from the end of the list, by flat facets.

    Every facet has its own vertices, so that edges stay sharp (range hoods, plinths). uv are metres (x, z) on facets
    that stand and (x, y) on those that lie. Caps are fans around the middle of the first and the last ring.
    """
    layers = [np.asarray(ring, dtype=float) for ring in rings]
    count = len(layers[0])
    if len(layers) < 2 or any(layer.shape != (count, 3) for layer in layers):
        raise ValueError(
            f"a loft needs at least two rings of the same shape (k, 3), got {[np.shape(r) for r in rings]}"
        )
    corners = []
    for low, high in pairwise(layers):
        low_next, high_next = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
        corners += [np.stack([low, low_next, high_next], axis=1), np.stack([low, high_next, high], axis=1)]
    if capped:
        for layer, upward in ((layers[0], False), (layers[-1], True)):
            middle = np.broadcast_to(layer.mean(axis=0), layer.shape)
            around = (layer, np.roll(layer, -1, axis=0)) if upward else (np.roll(layer, -1, axis=0), layer)
            corners.append(np.stack([middle, *around], axis=1))
    triangles = np.concatenate(corners)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    length = np.linalg.norm(normal, axis=1)
    triangles, normal = triangles[length > 1e-12], normal[length > 1e-12] / length[length > 1e-12, None]
    vertices, normals = triangles.reshape(-1, 3), np.repeat(normal, 3, axis=0)
    uv = np.where(np.abs(normals[:, 2:]) > 0.9, vertices[:, [0, 1]], vertices[:, [0, 2]])
    return Mesh(vertices, np.arange(len(vertices)).reshape(-1, 3), uv, normals)
