"""The shapes of a drawn mobile Panda, one mesh for each body and material. Pure numpy.

Arm links are bent tubes: each runs from the flange of the joint before it to a drum beside the next joint's
axis, as on the manufacturer's arm, and fills about the capsule that stands for it in collisions. Lengths in m, frames
of the bodies.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from math import cos, pi, radians

import numpy as np

from remac_env.kitchen.meshes import Floats, Mesh, loft, merge, revolve, rotation, smooth_profile, transform, tube

Point = tuple[float, float, float]
Parts = dict[str, Mesh]

SHELL, JOINT, METAL, RUBBER, ACCENT = MATERIALS = ("shell", "joint", "metal", "rubber", "accent")

_SIDES = 16
_ORIGIN: Point = (0.0, 0.0, 0.0)
_CREASE = cos(radians(38.0))  # edges sharper than this stay sharp
_AIMS = {"x": rotation((0, 1, 0), pi / 2), "y": rotation((1, 0, 0), -pi / 2), "z": np.eye(3)}
_PROUD = 0.0015  # how far bands stand out of the surface below them; less would flicker in small pictures

# Middle and half sizes of the base as seen from above, see the colliders in `model`.
_BASE_X, _BASE_HALF = -0.135, (0.285, 0.24)
_BASE_CORNER = 0.10
_AXLES_X, _WHEEL = (-0.325, 0.055), 0.070


@lru_cache(maxsize=1)
def robot_parts() -> Mapping[tuple[str, str], Mesh]:
    """Meshes by (short name of the body, material), in the body's frame. Shared: do not change them."""
    bodies: dict[str, Parts] = {
        "base": _base(),
        "lift": _lift(),
        "link0": _link0(),
        "link1": _link1(),
        "link2": _link2(),
        "link3": _link3(),
        "link4": _link4(),
        "link5": _link5(),
        "link6": _link6(),
        "link7": _link7(),
        "hand": _hand(),
        "finger_left": _finger(0.0),
        "finger_right": _finger(pi),
    }
    return {(body, kind): _shaded(mesh) for body, parts in bodies.items() for kind, mesh in parts.items()}


def _base() -> Parts:
    """A rounded body over four wheels, a coloured band around it, a panel at the back of its deck, a dark eye ahead."""
    shell = [(0.030, 0.075), (0.004, 0.095), (0.0, 0.300), (0.008, 0.330), (0.030, 0.348)]
    deck = [(0.045, 0.340), (0.045, 0.354), (0.052, 0.358)]
    wheels, hubs = [], []
    for x in _AXLES_X:
        for side in (-1.0, 1.0):
            wheels.append(_drum("y", (x, side * 0.200, _WHEEL), (-0.028, 0.028), _WHEEL, sides=12))
            hubs.append(_cap("y", (x, side * 0.226, _WHEEL), side, 0.034, sides=12))
    collar = [(0.0, 0.350), (0.128, 0.352), (0.128, 0.362), (0.112, 0.380), (0.102, 0.412), (0.100, 0.430)]
    sleeve = [(0.0985, 0.425), (0.0985, 0.575)]
    rim = [(0.100, 0.570), (0.100, 0.600), (0.094, 0.608), (0.075, 0.608)]
    panel = _tower([(0.350, (0.062, 0.150), 0.02), (0.364, (0.062, 0.150), 0.02)], x=-0.305)
    eye = _block((0.006, 0.085, 0.020), (0.147, 0.0, 0.2325))
    return {
        SHELL: merge(_base_tower(shell), _round(collar), _round(rim)),
        JOINT: merge(_base_tower([(0.055, 0.030), (0.055, 0.085)]), _base_tower(deck), eye),
        ACCENT: merge(_base_tower([(-_PROUD, 0.190), (-_PROUD, 0.275)]), _round(sleeve), panel),
        RUBBER: merge(*wheels),
        METAL: merge(*hubs),
    }


def _lift() -> Parts:
    """The inner column, long enough to stay in its sleeve when all the way up, and the plate below the arm."""
    head = [(0.081, -0.080), (0.085, -0.074), (0.098, -0.050), (0.114, -0.034), (0.117, -0.022), (0.117, -0.008)]
    return {
        METAL: _round([(0.080, -0.600), (0.080, -0.075)]),
        SHELL: _round(head),
        JOINT: _tower([(-0.010, (0.125, 0.110), 0.075), (0.005, (0.125, 0.110), 0.075)], x=-0.033),
    }


def _link0() -> Parts:
    """The foot of the arm: broad behind, narrowing upwards to the first joint."""
    rings = [
        (0.004, (0.108, 0.094), 0.070, -0.037),
        (0.026, (0.107, 0.093), 0.070, -0.036),
        (0.052, (0.098, 0.085), 0.072, -0.028),
        (0.078, (0.080, 0.074), 0.070, -0.012),
        (0.102, (0.067, 0.067), 0.066, -0.001),
        (0.134, (0.064, 0.064), 0.063, 0.0),
    ]
    shell = loft([_ring(z, half, corner, x) for z, half, corner, x in rings])
    return {SHELL: shell, JOINT: _round([(0.058, 0.130), (0.058, 0.145)])}


def _link1() -> Parts:
    path = [(0, 0, -0.186), (0, 0, -0.145), (0, -0.003, -0.105), (0, -0.024, -0.055), (0, -0.050, -0.005)]
    tubing = _bend(path, [0.063, 0.0635, 0.066, 0.067, 0.062])
    return {
        SHELL: merge(tubing, _drum("y", _ORIGIN, (-0.118, -0.004), 0.067)),
        JOINT: _cap("y", (0, -0.118, 0), -1.0, 0.052),
    }


def _link2() -> Parts:
    path = [(0, -0.186, 0), (0, -0.145, 0), (0, -0.105, 0.003), (0, -0.055, 0.024), (0, -0.005, 0.050)]
    tubing = _bend(path, [0.063, 0.0635, 0.066, 0.067, 0.062])
    shoulder, flange = _gap("z", _ORIGIN, 0.061), _gap("y", (0, -0.193, 0), 0.058)
    return {
        SHELL: merge(tubing, _drum("z", _ORIGIN, (0.004, 0.118), 0.067)),
        JOINT: merge(_cap("z", (0, 0, 0.118), 1.0, 0.052), shoulder, flange),
    }


def _link3() -> Parts:
    path = [(0, 0, -0.116), (0, 0, -0.075), (0.014, 0.008, -0.045), (0.048, 0.028, -0.016), (0.080, 0.048, -0.002)]
    tubing = _bend(path, [0.062, 0.062, 0.0625, 0.061, 0.057])
    return {
        SHELL: merge(tubing, _drum("y", (0.0825, 0, 0), (0.004, 0.108), 0.062)),
        JOINT: _cap("y", (0.0825, 0.108, 0), 1.0, 0.048),
        ACCENT: _round([(0.056, -0.121), (0.0650, -0.121), (0.0660, -0.082), (0.060, -0.082)]),
    }


def _link4() -> Parts:
    path = [(-0.0825, 0.114, 0), (-0.0825, 0.080, 0), (-0.069, 0.048, 0.008), (-0.036, 0.018, 0.028)]
    tubing = _bend([*path, (-0.003, 0.002, 0.048)], [0.062, 0.062, 0.0625, 0.061, 0.057])
    elbow, flange = _gap("z", _ORIGIN, 0.057), _gap("y", (-0.0825, 0.123, 0), 0.057)
    return {
        SHELL: merge(tubing, _drum("z", _ORIGIN, (0.004, 0.108), 0.062)),
        JOINT: merge(_cap("z", (0, 0, 0.108), 1.0, 0.048), elbow, flange),
    }


def _link5() -> Parts:
    path = [(0, 0, -0.250), (0, 0.001, -0.205), (0, 0.010, -0.150), (0, 0.032, -0.095), (0, 0.052, -0.045)]
    tubing = _bend([*path, (0, 0.060, 0)], [0.062, 0.0625, 0.061, 0.055, 0.051, 0.048])
    return {
        SHELL: merge(tubing, _drum("y", _ORIGIN, (0.004, 0.112), 0.055)),
        JOINT: _cap("y", (0, 0.112, 0), 1.0, 0.042),
        ACCENT: _round([(0.056, -0.255), (0.0648, -0.255), (0.0655, -0.212), (0.060, -0.212)]),
    }


def _link6() -> Parts:
    path = [(0, 0, 0.012), (0.030, 0.003, 0.010), (0.062, 0.007, 0.005), (0.088, 0.010, 0)]
    gap = _gap("z", _ORIGIN, 0.050)
    wrist, end = _drum("z", _ORIGIN, (0.004, 0.066), 0.055), _drum("y", (0.088, 0, 0), (-0.046, 0.068), 0.057)
    return {
        SHELL: merge(_bend(path, [0.049, 0.050, 0.051, 0.050]), wrist, end),
        JOINT: merge(_cap("z", (0, 0, 0.066), 1.0, 0.042), _cap("y", (0.088, 0.068, 0), 1.0, 0.044), gap),
    }


def _link7() -> Parts:
    """The flange with the manufacturer's knob beside it, between dark rings."""
    knob = _bend([(0, 0, 0.078), (0.022, 0.022, 0.079), (0.044, 0.044, 0.080)], [0.030, 0.029, 0.026])
    return {
        SHELL: merge(_drum("z", (0, 0, 0), (0.056, 0.100), 0.049), knob),
        JOINT: merge(_gap("z", (0, 0, 0.051), 0.044), _gap("z", (0, 0, 0.102), 0.044)),
    }


def _hand() -> Parts:
    """The hand's body, wide along the fingers, a dark rail for them, and a coloured band."""
    body = [
        (-0.002, (0.022, 0.052), 0.020),
        (0.008, (0.029, 0.082), 0.026),
        (0.022, (0.032, 0.099), 0.030),
        (0.052, (0.032, 0.102), 0.030),
        (0.060, (0.029, 0.099), 0.027),
    ]
    around = (0.032 + _PROUD, 0.102 + _PROUD)
    band = [(0.026, around, 0.030), (0.046, around, 0.030)]
    rail = [(0.055, (0.015, 0.088), 0.012), (0.0645, (0.015, 0.088), 0.012)]
    return {SHELL: _tower(body), ACCENT: _tower(band), JOINT: _tower(rail)}


def _finger(turn: float) -> Parts:
    """The left finger, or turned by pi about the approach the right one; its pad's face lies at y = 0."""
    slider, neck, tip = ((0.0, 0.013, 0.018), (0.0, 0.0100, 0.0315), (0.0, 0.0062, 0.0455))
    metal = merge(
        _block((0.0100, 0.0065, 0.0170), slider),
        _block((0.0096, 0.0080, 0.0050), neck),
        _block((0.0092, 0.0040, 0.0150), tip),
    )
    pad = _block((0.0094, 0.0018, 0.0135), (0.0, 0.0018, 0.0475))
    about = rotation((0, 0, 1), turn)
    return {METAL: transform(metal, rotation=about), RUBBER: transform(pad, rotation=about)}


def _block(half: Point, middle: Point) -> Mesh:
    """A box standing upright, its vertical edges cut off."""
    x, y, z = half
    cut = min(0.002, 0.5 * y)
    right = [(x, cut - y), (x, y - cut), (x - cut, y), (cut - x, y)]
    outline = np.array([*right, *((-a, -b) for a, b in right)])
    return transform(loft([np.column_stack([outline, np.full(8, h)]) for h in (-z, z)]), position=middle)


def _bend(path: Sequence[Point], radius: Sequence[float]) -> Mesh:
    """A tube along a smooth curve through the points, of changing radius, its ends slightly rounded."""
    points, radii = np.array(path, dtype=float), np.array(radius)
    at = np.linspace(0, 1, 2 * len(points) - 1)
    # smooth_profile keeps its first column positive, so each coordinate goes through the second.
    line = np.column_stack([
        smooth_profile(np.column_stack([np.ones(len(points)), points[:, k]]), samples=len(at))[:, 1] for k in range(3)
    ])
    thick = np.interp(at, np.linspace(0, 1, len(radii)), radii)
    first = line[0] - 0.004 * (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    return tube(np.vstack([first, line]), np.concatenate([[thick[0] - 0.004], thick]), sides=_SIDES)


def _drum(axis: str, middle: Point, ends: tuple[float, float], radius: float, *, sides: int = _SIDES) -> Mesh:
    """A round body along an axis, between two places on it, with rounded rims."""
    low, high = ends
    bevel = 0.012
    arc = np.linspace(0, pi / 2, 3)
    rim = np.column_stack([radius - bevel + bevel * np.sin(arc), low + bevel - bevel * np.cos(arc)])
    top = np.column_stack([rim[::-1, 0], low + high - rim[::-1, 1]])
    profile = np.vstack([[[0.0, low]], rim, top, [[0.0, high]]])
    return transform(revolve(profile, sides=sides), position=middle, rotation=_AIMS[axis])


def _gap(axis: str, middle: Point, radius: float) -> Mesh:
    """The dark ring seen between two links."""
    return transform(revolve([(radius, -0.009), (radius, 0.009)], sides=_SIDES), position=middle, rotation=_AIMS[axis])


def _cap(axis: str, middle: Point, side: float, radius: float, *, sides: int = _SIDES) -> Mesh:
    """A flat, slightly domed lid on the end of a drum, on the positive or negative side of the axis."""
    profile = np.array([(radius, -0.002), (radius, 0.002), (radius - 0.004, 0.005), (0.0, 0.007)])
    lid = revolve(profile, sides=sides)
    aim = _AIMS[axis] if side > 0 else _AIMS[axis] @ rotation((1, 0, 0), pi)
    return transform(lid, position=middle, rotation=aim)


def _round(profile: Sequence[tuple[float, float]]) -> Mesh:
    return revolve(profile, sides=_SIDES)


def _base_tower(profile: Sequence[tuple[float, float]]) -> Mesh:
    """A body with the base's outline: (inset, z) from the bottom up."""
    x, y = _BASE_HALF
    return _tower([(z, (x - inset, y - inset), _BASE_CORNER - inset) for inset, z in profile], x=_BASE_X)


def _tower(layers: Sequence[tuple[float, tuple[float, float], float]], *, x: float = 0.0) -> Mesh:
    """A stack of rounded rectangles (z, half sizes, corner radius), closed below and above."""
    return loft([_ring(z, half, corner, x) for z, half, corner in layers])


def _ring(z: float, half: tuple[float, float], corner: float, x: float) -> Floats:
    """Points (20, 3) of a horizontal rounded rectangle, counter-clockwise from above."""
    quarter = np.linspace(0, pi / 2, 5)
    points = []
    for start, (sx, sy) in zip(np.arange(4) * pi / 2, ((1, 1), (-1, 1), (-1, -1), (1, -1)), strict=True):
        angle = start + quarter
        points.append(np.column_stack([
            x + sx * (half[0] - corner) + corner * np.cos(angle),
            sy * (half[1] - corner) + corner * np.sin(angle),
            np.full(5, z),
        ]))
    return np.concatenate(points)


def _shaded(mesh: Mesh) -> Mesh:
    """The mesh with normals of its own, without uv: smooth across seams and shallow edges, sharp across steep ones.

    Vertices are split where normals differ, and merged where place and normal agree.
    """
    corners = mesh.vertices[mesh.faces]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(area, axis=1)
    keep = size > 1e-11
    corners, area = corners[keep], area[keep]
    flat = area / size[keep, None]
    places = corners.reshape(-1, 3)
    _, place = np.unique(np.round(places, 6), axis=0, return_inverse=True)
    place = place.ravel()
    face = np.repeat(np.arange(len(corners)), 3)
    normals = np.empty_like(places)
    order = np.argsort(place, kind="stable")
    for group in np.split(order, np.flatnonzero(np.diff(place[order])) + 1):
        near = flat[face[group]] @ flat[face[group]].T > _CREASE
        normals[group] = near @ area[face[group]]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    _, first, index = np.unique(
        np.column_stack([place, np.round(normals, 3)]), axis=0, return_index=True, return_inverse=True
    )
    return Mesh(places[first], index.reshape(-1, 3), None, normals[first])
