"""Collision shapes of objects, made of primitives. They carry all the mass.

Dishes and cups are hollow: a floor and a ring of tilted boxes. They stand on four small spheres at the bottom, and on
eight around the top when they are upside down, because few point contacts stand still cheaply while a ring of boxes
does not; all else of them meets edges and corners of furniture. Bottles and cans stand on such feet too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import atan2, cos, dist, hypot, pi, sin, tan
from types import MappingProxyType
from typing import Any

import mujoco

from remac_env.kitchen.objects.catalogue import Category

# Who touches whom (contype, conaffinity): furniture 1/0, door panels 1/1, objects 2/3, robots 4/7, feet 0/1.
_WHOLE = {"contype": 2, "conaffinity": 3}
_FOOT = {"contype": 0, "conaffinity": 1, "friction": [1.0, 0.005, 0.0001], "mass": 0.002}
_STIFF = {"condim": 6, "solref": [0.01, 1.0]}
# A pan hangs far from the fingers: its handle creeps in them four times slower than with the pads' own impedance. As
# weighty as a pad (friction: the larger of both), but its impedance rules.
_HANDLE = {"priority": 1, "solmix": 1000.0, "solref": [0.01, 1.0], "solimp": [0.99, 0.999, 0.001, 0.5, 2.0]}
COLLIDER_GROUP = 3

WALL_PIECES = 12
"""Boxes in the ring of a dish or cup, the first towards +x."""

_FOOT_RADIUS = 0.004
# Feet reach half a millimetre below the frame, so that the floor over them stays clear of the surface.
_FOOT_HEIGHT = 0.0035
_PRISM = 0.97  # of a cylinder's radius, from the axis to the faces of what stands in for it; to its corners 1.05
_FLOOR_HALF, _FLOOR_HEIGHT = 0.003, 0.006

Adder = Callable[[mujoco.MjsBody, Category], None]


def add_colliders(body: mujoco.MjsBody, category: Category) -> None:
    """Add the category's colliders to a body, in its frame."""
    _ADDERS[category.body.form](body, category)


def _capsule(body: mujoco.MjsBody, category: Category) -> None:
    half, radius = category.body["half_length"], category.body["radius"]
    _add(
        body, category, mujoco.mjtGeom.mjGEOM_CAPSULE,
        fromto=[-half, 0, 0, half, 0, 0], size=[radius, 0, 0], mass=category.mass, **_WHOLE, **_STIFF,
    )  # fmt: skip


def _ellipsoid(body: mujoco.MjsBody, category: Category) -> None:
    kind = mujoco.mjtGeom.mjGEOM_ELLIPSOID
    _add(body, category, kind, size=list(category.body["half"]), mass=category.mass, **_WHOLE, **_STIFF)


def _loaf(body: mujoco.MjsBody, category: Category) -> None:
    """Two capsules side by side along x: flat below, and free of the rare false contacts between two boxes."""
    x, y, radius = category.body["half"]
    for side in (-1, 1):
        ends = [radius - x, side * (y - radius), 0, x - radius, side * (y - radius), 0]
        kind = mujoco.mjtGeom.mjGEOM_CAPSULE
        _add(body, category, kind, fromto=ends, size=[radius, 0, 0], mass=category.mass / 2, **_WHOLE, **_STIFF)


def _dish(body: mujoco.MjsBody, category: Category) -> None:
    """A floor, a ring of boxes that lean outwards, feet and, where there is one, a handle towards -y."""
    measures = category.body.measures
    handle_mass = measures.get("handle_mass", 0.0)
    mass = category.mass - handle_mass
    _floor(body, category, measures["base_radius"], mass / 2)
    _wall(body, category, measures["base_radius"], measures["radius"], measures["height"], mass / 2)
    _feet(body, 0.9 * measures["base_radius"], _FOOT_HEIGHT, count=4)
    _feet(body, measures["radius"] - _FOOT_RADIUS, measures["height"], count=8)
    if "handle_to" in measures:
        radius, height = measures["handle_radius"], measures["height"]
        ends = [0, -measures["handle_from"] - radius, height, 0, -measures["handle_to"] + radius, height]
        kind = mujoco.mjtGeom.mjGEOM_CAPSULE
        _add(body, category, kind, fromto=ends, size=[radius, 0, 0], mass=handle_mass, **_WHOLE, **_HANDLE)


def _cup(body: mujoco.MjsBody, category: Category) -> None:
    """A floor, an upright ring of boxes, feet and an ear towards +x."""
    measures = category.body.measures
    radius, height, wall = measures["radius"], measures["height"], measures["wall"]
    _floor(body, category, radius - wall, category.mass / 2)
    _wall(body, category, radius - wall, radius - wall, height, category.mass / 2)
    _feet(body, radius - 2 * _FOOT_RADIUS, _FOOT_HEIGHT, count=4)
    _feet(body, radius - _FOOT_RADIUS, height - _FOOT_RADIUS, count=8)
    if "handle" in measures:
        out, thick = radius + measures["handle"] - 0.006, 0.006
        ends = [out, 0, 0.3 * height, out, 0, 0.7 * height]
        _add(body, category, mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=ends, size=[thick, 0, 0], mass=0.0, **_WHOLE)


def _bottle(body: mujoco.MjsBody, category: Category) -> None:
    """A cylinder, a capsule from its shoulder into a neck, and feet."""
    measures = category.body.measures
    radius, shoulder, neck, height = (measures[k] for k in ("radius", "shoulder", "neck_radius", "height"))
    _cylinder(body, category, radius, 0.001, shoulder, 0.85 * category.mass)
    _cylinder(body, category, neck, shoulder, height, 0.15 * category.mass)
    _add(
        body, category, mujoco.mjtGeom.mjGEOM_ELLIPSOID, pos=[0, 0, shoulder],
        size=[radius * 0.98, radius * 0.98, radius], mass=0.0, **_WHOLE,
    )  # fmt: skip
    _feet(body, radius - _FOOT_RADIUS, _FOOT_HEIGHT, count=4)


def _can(body: mujoco.MjsBody, category: Category) -> None:
    measures = category.body.measures
    shape = _prism if category.seasons else _cylinder
    shape(body, category, measures["radius"], 0.001, measures["height"], category.mass)
    _feet(body, measures["radius"] - _FOOT_RADIUS, _FOOT_HEIGHT, count=4)


def _box(body: mujoco.MjsBody, category: Category) -> None:
    """A box that stands on feet: two boxes face to face have too many contacts to stand still cheaply."""
    x, y, z = category.body["half"]
    kind = mujoco.mjtGeom.mjGEOM_BOX
    _add(
        body, category, kind, pos=[0, 0, z + 0.0005], size=[x, y, z - 0.0005], mass=category.mass, **_WHOLE, **_STIFF,
    )  # fmt: skip
    for side, front in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        _foot(body, [side * (x - _FOOT_RADIUS), front * (y - _FOOT_RADIUS), _FOOT_HEIGHT])


def _chain(body: mujoco.MjsBody, category: Category) -> None:
    """Capsules from each point to the next; the mass goes by their length."""
    points, radii = category.body["points"], category.body["radii"]
    links = list(zip(points, points[1:], radii, strict=False))
    lengths = [dist(start, end) + radius for start, end, radius in links]
    for (start, end, radius), length in zip(links, lengths, strict=True):
        kind, mass = mujoco.mjtGeom.mjGEOM_CAPSULE, category.mass * length / sum(lengths)
        _add(body, category, kind, fromto=[*start, *end], size=[radius, 0, 0], mass=mass, **_WHOLE, **_STIFF)


def _floor(body: mujoco.MjsBody, category: Category, radius: float, mass: float) -> None:
    _add(
        body, category, mujoco.mjtGeom.mjGEOM_CYLINDER,
        pos=[0, 0, _FLOOR_HEIGHT], size=[radius, _FLOOR_HALF, 0], mass=mass, **_WHOLE,
    )  # fmt: skip


def _wall(
    body: mujoco.MjsBody, category: Category, base_radius: float, radius: float, height: float, mass: float
) -> None:
    """A ring of boxes from the base radius at the bottom to the radius at the top."""
    lean, length = atan2(radius - base_radius, height), hypot(radius - base_radius, height)
    middle, bottom = (radius + base_radius) / 2, 0.004
    half = [category.body["wall"], middle * tan(pi / WALL_PIECES) * 1.05, length / 2]
    for piece in range(WALL_PIECES):
        turn = 2 * pi * piece / WALL_PIECES
        _add(
            body, category, mujoco.mjtGeom.mjGEOM_BOX,
            pos=[middle * cos(turn), middle * sin(turn), bottom + height / 2], size=half,
            quat=_turned_and_leaning(turn, lean), mass=mass / WALL_PIECES, **_WHOLE,
        )  # fmt: skip


def _turned_and_leaning(turn: float, lean: float) -> list[float]:
    """Quaternion (w, x, y, z) of a turn about z after a lean about y, rad."""
    cos_turn, sin_turn, cos_lean, sin_lean = cos(turn / 2), sin(turn / 2), cos(lean / 2), sin(lean / 2)
    return [cos_turn * cos_lean, -sin_turn * sin_lean, cos_turn * sin_lean, sin_turn * cos_lean]


def _cylinder(body: mujoco.MjsBody, category: Category, radius: float, bottom: float, top: float, mass: float) -> None:
    ends, kind = [0, 0, bottom, 0, 0, top], mujoco.mjtGeom.mjGEOM_CYLINDER
    _add(body, category, kind, fromto=ends, size=[radius, 0, 0], mass=mass, **_WHOLE, **_STIFF)


def _prism(body: mujoco.MjsBody, category: Category, radius: float, bottom: float, top: float, mass: float) -> None:
    """What stands in for a cylinder that is shaken in a hand: eight faces, made of four boxes.

    Between flat pads a cylinder is met at few points, at one end of this pad and at the other end of that one: it walks
    along them, and once it is off their middle they squeeze it out. A face lies flat on a pad; hands come square to an
    object's axes or just between them, which is square to a face.
    """
    face, high = _PRISM * radius, (top - bottom) / 2
    half = [face, face * tan(pi / 8), high]
    for number in range(4):
        turn = number * pi / 8
        _add(
            body, category, mujoco.mjtGeom.mjGEOM_BOX, pos=[0, 0, bottom + high], size=half,
            quat=[cos(turn), 0, 0, sin(turn)], mass=mass / 4, **_WHOLE, **_STIFF,
        )  # fmt: skip


def _feet(body: mujoco.MjsBody, radius: float, height: float, *, count: int) -> None:
    """Small spheres in a circle; they touch furniture and nothing else."""
    for number in range(count):
        turn = pi / 4 + 2 * pi * number / count
        _foot(body, [radius * cos(turn), radius * sin(turn), height])


def _foot(body: mujoco.MjsBody, position: list[float]) -> None:
    kind = mujoco.mjtGeom.mjGEOM_SPHERE
    body.add_geom(type=kind, pos=position, size=[_FOOT_RADIUS, 0, 0], group=COLLIDER_GROUP, **_FOOT)


def _add(body: mujoco.MjsBody, category: Category, kind: mujoco.mjtGeom, **options: Any) -> None:
    body.add_geom(
        type=kind,
        friction=list(category.friction),
        group=COLLIDER_GROUP,
        rgba=[*category.color, 1.0],
        **options,
    )


_ADDERS: Mapping[str, Adder] = MappingProxyType(
    {
        "capsule": _capsule, "ellipsoid": _ellipsoid, "loaf": _loaf, "dish": _dish, "cup": _cup, "bottle": _bottle,
        "can": _can, "box": _box, "chain": _chain,
    }
)  # fmt: skip
