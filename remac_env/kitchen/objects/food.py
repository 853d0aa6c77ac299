"""Drawn food, lying as it rests: x along it, z up, the origin in the middle of its collider."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from remac_env.kitchen.meshes import (
    Floats,
    Mesh,
    leaf,
    loft,
    merge,
    revolve,
    rotation,
    slab,
    smooth_profile,
    transform,
    tube,
)
from remac_env.kitchen.objects.part import DrawnPart, glossy, grid, picture
from remac_env.kitchen.style import Finish
from remac_env.kitchen.textures import Image, blend, noise

_UPRIGHT_TO_LYING = rotation((0, 1, 0), np.pi / 2)  # what grew along z lies along x
_PICTURE = Finish(color=(1.0, 1.0, 1.0), specular=0.3, shininess=0.5)


def carrot() -> tuple[DrawnPart, ...]:
    """A tapering root with rings and a crown of leaves."""
    profile = smooth_profile(
        [
            (0, -0.073),
            (0.004, -0.069),
            (0.009, -0.035),
            (0.0145, 0.02),
            (0.0165, 0.045),
            (0.012, 0.059),
            (0, 0.061),
        ],
        samples=22,
    )
    root = revolve(profile, sides=14)
    x, y, z = root.vertices.T
    rings = 1 + 0.04 * np.sin(400 * z)
    ringed = Mesh(np.column_stack([rings * x, rings * y, z]), root.faces, root.uv)
    leaves = merge(
        *(leaf(0.062, 0.0065, curl=1.2 + 0.22 * np.sin(2 * i), azimuth=2.4 * i, base=(0, 0, 0.057)) for i in range(6)),
        tube([(0, 0, 0.055), (0, 0, 0.068)], [0.006, 0.003], sides=8),
    )
    return (
        DrawnPart(_settle(_lie(ringed), profile, floor=0.016, share=0.8), glossy(0.95, 0.47, 0.10)),
        DrawnPart(_lie(leaves), glossy(0.25, 0.55, 0.16, specular=0.1)),
    )


def eggplant() -> tuple[DrawnPart, ...]:
    """A dark violet club with a green cap."""
    profile = smooth_profile(
        [
            (0, -0.067),
            (0.018, -0.062),
            (0.029, -0.033),
            (0.026, 0.005),
            (0.018, 0.036),
            (0.011, 0.050),
            (0, 0.053),
        ],
        samples=18,
    )
    body = _lie(revolve(profile, sides=18))
    cap = merge(
        tube([(0, 0, 0.048), (0.003, 0, 0.062), (0.009, 0, 0.076)], [0.0065, 0.005, 0.0055], sides=8),
        *(leaf(0.034, 0.010, curl=-1.1, azimuth=1.2566 * i, base=(0, 0, 0.056)) for i in range(5)),
    )
    return (
        DrawnPart(
            _settle(body, profile, floor=0.027, share=0.5),
            glossy(0.27, 0.10, 0.33, specular=0.8, shininess=0.7),
        ),
        DrawnPart(transform(_lie(cap), position=(0, 0, -0.006)), glossy(0.34, 0.50, 0.20, specular=0.1)),
    )


def corn() -> tuple[DrawnPart, ...]:
    """A cob of rows of kernels in three open husks."""
    profile = smooth_profile(
        [
            (0, -0.070),
            (0.018, -0.068),
            (0.0222, -0.035),
            (0.0215, 0.015),
            (0.015, 0.058),
            (0.006, 0.075),
            (0, 0.076),
        ],
        samples=16,
    )
    v, u = grid()
    edge = 2 * np.maximum(np.abs((12 * u) % 1 - 0.5), np.abs((22 * v) % 1 - 0.5))
    kernels = blend((0.98, 0.81, 0.27), (0.70, 0.47, 0.08), np.clip((edge - 0.65) / 0.35, 0, 1) ** 1.5)
    husk = leaf(0.105, 0.019, curl=1.34, base=(0.006, 0, -0.075))
    husks = merge(
        *(transform(husk, rotation=rotation((0, 0, 1), turn)) for turn in (0.5, 2.6, 4.7)),
        tube([(0, 0, -0.092), (0, 0, -0.062)], [0.008, 0.012], sides=8),
    )
    return (
        DrawnPart(_lie(revolve(profile, sides=16)), _PICTURE, picture(kernels)),
        DrawnPart(_lie(husks), glossy(0.45, 0.66, 0.25, specular=0.1)),
    )


def potato() -> tuple[DrawnPart, ...]:
    """A lumpy yellow tuber with eyes."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, 15)
    ball = _lie(revolve(np.column_stack([np.maximum(np.cos(angle), 0), np.sin(angle)]), sides=18))
    x, y, z = ball.vertices.T
    lumps = 1 + 0.05 * np.sin(3 * x + 2) * np.cos(2.5 * y + 1) + 0.03 * np.sin(5 * z + 1)
    tuber = transform(Mesh(ball.vertices * lumps[:, None], ball.faces, ball.uv), scale=(0.0445, 0.0295, 0.0265))
    speckles = noise(128, seed=61, base=(6, 6))
    eyes = np.clip((noise(128, seed=62, base=(10, 10), octaves=2) - 0.70) * 8, 0, 1)
    skin = blend(blend((0.88, 0.72, 0.36), (0.76, 0.58, 0.22), speckles), (0.36, 0.24, 0.13), eyes)
    dull = Finish(color=(1.0, 1.0, 1.0), specular=0.05, shininess=0.2)
    return (DrawnPart(tuber, dull, picture(skin)),)


def tomato() -> tuple[DrawnPart, ...]:
    """A ribbed red fruit with a green star."""
    profile = smooth_profile(
        [(0, -0.024), (0.012, -0.0255), (0.0305, -0.010), (0.0305, 0.009), (0.014, 0.025), (0, 0.021)],
        samples=16,
    )
    fruit = revolve(profile, sides=20)
    x, y, z = fruit.vertices.T
    ribs = 1 + 0.035 * np.cos(5 * np.arctan2(y, x))
    ribbed = Mesh(np.column_stack([ribs * x, ribs * y, z]), fruit.faces, fruit.uv)
    star = merge(
        *(leaf(0.020, 0.0055, curl=0.15, azimuth=1.2566 * i, base=(0, 0, 0.0225)) for i in range(5)),
        tube([(0, 0, 0.020), (0.002, 0, 0.034)], [0.003, 0.0025], sides=6),
    )
    return (
        DrawnPart(ribbed, glossy(0.86, 0.14, 0.08, specular=0.6, shininess=0.6)),
        DrawnPart(star, glossy(0.22, 0.48, 0.14, specular=0.1)),
    )


def fish() -> tuple[DrawnPart, ...]:
    """A fish on its side, head towards -x, back towards +y, the tail flicked up."""
    along = np.linspace(0, 1, 20)
    depth = 0.0335 * np.sin(np.pi * np.clip(0.92 * along + 0.06, 0, 1)) ** 0.75 * (1 - 0.25 * along)
    spine = np.column_stack([-0.078 + 0.150 * along, 0 * along, 0.010 * along**4])
    flesh = tube(spine, depth, sides=16, squash=(1.0, 0.72))
    fins = merge(
        _fin(
            [(0.0, -0.006), (0.034, -0.034), (0.026, 0.0), (0.034, 0.034), (0.0, 0.006)],
            (0.066, 0, 0.009),
            lift=0.45,
        ),
        _fin([(-0.018, 0.0), (0.028, 0.0), (0.024, 0.012), (-0.002, 0.018)], (-0.005, 0.026, 0.0)),
        _fin([(-0.004, -0.015), (0.016, -0.012), (0.016, 0.0), (-0.006, 0.0)], (-0.01, -0.026, 0.0)),
    )
    ball = revolve([(0, -0.004), (0.0036, -0.0025), (0.005, 0), (0.0036, 0.0025), (0, 0.004)], sides=10)
    pupil = transform(ball, scale=(0.62, 0.62, 0.7))
    sides = (-1, 1)
    return (
        DrawnPart(flesh, Finish(color=(1.0, 1.0, 1.0), specular=0.7, shininess=0.6), _scales()),
        DrawnPart(fins, glossy(0.36, 0.47, 0.56, specular=0.3)),
        DrawnPart(
            merge(*(transform(ball, position=(-0.062, 0.005, 0.0115 * s)) for s in sides)),
            glossy(0.95, 0.93, 0.80),
        ),
        DrawnPart(
            merge(*(transform(pupil, position=(-0.0622, 0.005, 0.0138 * s)) for s in sides)),
            glossy(0.03, 0.03, 0.03, specular=0.9),
        ),
    )


def _fin(outline: ArrayLike, position: ArrayLike, *, lift: float = 0.0) -> Mesh:
    """A thin plate in the x-y plane; positive `lift` (rad) raises its +x end."""
    return transform(slab(_counter_clockwise(outline), 0.003), position=position, rotation=rotation((0, 1, 0), -lift))


def _counter_clockwise(outline: ArrayLike) -> Floats:
    """The outline in counter-clockwise order."""
    points = np.asarray(outline, dtype=float)
    after = np.roll(points, -1, axis=0)
    area = (points[:, 0] * after[:, 1] - points[:, 1] * after[:, 0]).sum()
    return points if area > 0 else points[::-1]


def _scales() -> Image:
    """Silver belly (u 0), blue back (u 1/2), scales, and a dark line behind the gills."""
    v, u = grid()
    shade = np.clip(0.7 - 0.85 * np.cos(2 * np.pi * u), 0, 1)
    skin = blend((0.76, 0.85, 0.92), (0.22, 0.37, 0.53), shade)
    shift = 0.5 * (np.floor(18 * v) % 2)
    scales = np.hypot((22 * u + shift) % 1 - 0.5, (18 * v) % 1 - 0.2)
    skin = skin * (1 - 0.22 * np.clip((scales - 0.45) * 6, 0, 1) * (v > 0.27))[..., None]
    gills = np.abs(v - 0.25 + 0.03 * np.cos(4 * np.pi * u)) < 0.012
    return picture(np.where(gills[..., None], 0.55 * skin, skin))


def steak() -> tuple[DrawnPart, ...]:
    """A thick slice of marbled meat with a rim of fat and a bone."""
    turn = np.linspace(0, 2 * np.pi, 36, endpoint=False)
    edge = _steak_edge(turn)[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    low, high = edge.min(axis=0), edge.max(axis=0)
    edge = (edge - (low + high) / 2) / ((high - low) / 2) * (0.053, 0.033)
    half = 0.0135
    layers = [(0.93, -half), (1.0, -0.6 * half), (1.0, 0.6 * half), (0.93, half)]
    rings = [np.column_stack([edge * size, np.full(len(edge), z)]) for size, z in layers]
    slice_ = loft(rings)
    # The picture covers the face: its middle at the origin and its edge where the rim of fat is.
    uv = slice_.vertices[:, :2] / (0.112, 0.072) + 0.5
    bone = revolve([(0.0085, 0), (0.0085, 0.0012), (0, 0.0016)], sides=12)
    return (
        DrawnPart(Mesh(slice_.vertices, slice_.faces, uv, slice_.normals), _PICTURE, _marbled_meat(edge)),
        DrawnPart(transform(bone, scale=(1.5, 0.7, 1), position=(0.030, 0.004, half)), glossy(0.95, 0.91, 0.80)),
    )


def _steak_edge(turn: Floats) -> Floats:
    """Distance of the outline from the middle in a direction (rad), before it is stretched to measure."""
    return 1 + 0.22 * np.cos(turn - 0.5) + 0.10 * np.cos(2 * turn + 0.6) - 0.07 * np.cos(3 * turn)


def _marbled_meat(edge: Floats) -> Image:
    """Red meat with veins; the rim of fat follows the outline, (k, 2) m."""
    v, u = grid()
    x, y = (u - 0.5) * 0.112, (v - 0.5) * 0.072
    turns = np.arctan2(edge[:, 1] / 0.033, edge[:, 0] / 0.053)
    order = np.argsort(turns)
    lengths = np.hypot(edge[:, 0] / 0.053, edge[:, 1] / 0.033)[order]
    here = np.interp(np.arctan2(y / 0.033, x / 0.053), turns[order], lengths, period=2 * np.pi)
    depth = np.hypot(x / 0.053, y / 0.033) / here
    meat = blend((0.66, 0.13, 0.13), (0.84, 0.33, 0.30), noise(128, seed=5, base=(3, 3), octaves=4))
    veins = 0.8 * np.clip(1 - 14 * np.abs(noise(128, seed=4, base=(6, 6), octaves=4) - 0.5), 0, 1)
    meat = blend(meat, (0.95, 0.84, 0.78), veins)
    return picture(blend(meat, (0.96, 0.89, 0.79), np.clip((depth - 0.84) / 0.05, 0, 1)))


def _lie(mesh: Mesh) -> Mesh:
    """Lay down along x what was made upright along z."""
    return transform(mesh, rotation=_UPRIGHT_TO_LYING)


def _settle(mesh: Mesh, profile: Floats, *, floor: float, share: float) -> Mesh:
    """Sink the thin parts of a lying solid of revolution towards the surface `floor` below its axis, by a share."""
    thickness = np.interp(mesh.vertices[:, 0], profile[:, 1], profile[:, 0])
    sunk = mesh.vertices.copy()
    sunk[:, 2] -= share * (floor - thickness)
    return Mesh(sunk, mesh.faces, mesh.uv)
