"""Draws a mobile Panda with primitives (group 1, never colliding, massless).

White shells over dark joints, as the maker's arm; the accent colour tells robots apart: a band around the base, the
column's collar, a ring on the forearm and the fingertips.
"""

from __future__ import annotations

import math

import mujoco

DRAWN_GROUP = 1

Color = tuple[float, float, float, float]

_SHELL: Color = (0.93, 0.94, 0.95, 1.0)
_JOINT: Color = (0.17, 0.18, 0.20, 1.0)
_GREY: Color = (0.55, 0.57, 0.60, 1.0)
_RUBBER: Color = (0.07, 0.07, 0.08, 1.0)

_BOX = mujoco.mjtGeom.mjGEOM_BOX
_CAPSULE = mujoco.mjtGeom.mjGEOM_CAPSULE
_CYLINDER = mujoco.mjtGeom.mjGEOM_CYLINDER
_ELLIPSOID = mujoco.mjtGeom.mjGEOM_ELLIPSOID


class _Brush:
    """Adds drawn geoms to one body."""

    def __init__(self, body: mujoco.MjsBody) -> None:
        self._body = body

    def box(self, middle: tuple[float, ...], half: tuple[float, ...], color: Color, turn: float = 0.0) -> None:
        quat = [math.cos(0.5 * turn), 0.0, 0.0, math.sin(0.5 * turn)]
        self._add(_BOX, color, pos=middle, size=half, quat=quat)

    def rod(self, start: tuple[float, ...], end: tuple[float, ...], radius: float, color: Color) -> None:
        self._add(_CYLINDER, color, fromto=[*start, *end], size=[radius, 0.0, 0.0])

    def pill(self, start: tuple[float, ...], end: tuple[float, ...], radius: float, color: Color) -> None:
        self._add(_CAPSULE, color, fromto=[*start, *end], size=[radius, 0.0, 0.0])

    def ball(self, middle: tuple[float, ...], half: tuple[float, float, float], color: Color) -> None:
        self._add(_ELLIPSOID, color, pos=middle, size=half)

    def _add(self, kind: mujoco.mjtGeom, color: Color, **shape: object) -> None:
        self._body.add_geom(
            type=kind, rgba=list(color), mass=0.0, contype=0, conaffinity=0, group=DRAWN_GROUP, **shape
        )


def dress(
    spec: mujoco.MjSpec, name: str, bodies: dict[str, mujoco.MjsBody], accent: tuple[float, float, float]
) -> None:
    """Draw the robot ``name`` on its bodies (by short name), in white with ``accent`` (RGB)."""
    tint: Color = (float(accent[0]), float(accent[1]), float(accent[2]), 1.0)
    _base(_Brush(bodies["base"]), tint)
    _lift(_Brush(bodies["lift"]))
    _arm({part: _Brush(body) for part, body in bodies.items()}, tint)
    _hand({part: _Brush(body) for part, body in bodies.items()}, tint)


def _base(base: _Brush, tint: Color) -> None:
    """A rounded box on four wheels, with a coloured band and a dark deck, and the foot of the column."""
    base.box((-0.135, 0.0, 0.215), (0.255, 0.205, 0.125), _SHELL)
    for x in (-0.375, 0.105):
        for y in (-0.19, 0.19):
            base.rod((x, y, 0.09), (x, y, 0.34), 0.045, _SHELL)
    base.box((-0.135, 0.235, 0.215), (0.235, 0.004, 0.125), _SHELL)
    base.box((-0.135, -0.235, 0.215), (0.235, 0.004, 0.125), _SHELL)
    base.box((0.146, 0.0, 0.215), (0.004, 0.19, 0.125), _SHELL)
    base.box((-0.416, 0.0, 0.215), (0.004, 0.19, 0.125), _SHELL)
    base.box((-0.135, 0.0, 0.275), (0.2865, 0.195, 0.014), tint)
    base.box((-0.135, 0.0, 0.275), (0.245, 0.2405, 0.014), tint)
    base.box((-0.135, 0.0, 0.345), (0.27, 0.22, 0.006), _JOINT)
    base.box((-0.135, 0.0, 0.075), (0.25, 0.20, 0.03), _JOINT)
    for x in (-0.33, 0.06):
        for y in (-0.18, 0.18):
            base.rod((x, y - 0.025, 0.055), (x, y + 0.025, 0.055), 0.055, _RUBBER)
            base.rod((x, y - 0.027, 0.055), (x, y + 0.027, 0.055), 0.025, _GREY)
    base.rod((0.0, 0.0, 0.345), (0.0, 0.0, 0.61), 0.098, _SHELL)
    base.rod((0.0, 0.0, 0.595), (0.0, 0.0, 0.615), 0.101, tint)
    base.rod((0.0, 0.0, 0.35), (0.0, 0.0, 0.37), 0.115, _JOINT)


def _lift(lift: _Brush) -> None:
    """The telescoping part of the column and the plate that carries the arm."""
    lift.rod((0.0, 0.0, -0.30), (0.0, 0.0, -0.02), 0.08, _GREY)
    lift.rod((0.0, 0.0, -0.03), (0.0, 0.0, 0.0), 0.11, _JOINT)
    lift.box((-0.04, 0.0, 0.006), (0.11, 0.09, 0.006), _JOINT)


def _arm(brush: dict[str, _Brush], tint: Color) -> None:
    """Shells of the seven links, in the frames of the maker's Denavit-Hartenberg data."""
    b = brush["link0"]
    b.pill((-0.06, 0.0, 0.06), (0.0, 0.0, 0.06), 0.06, _SHELL)
    b.rod((0.0, 0.0, 0.01), (0.0, 0.0, 0.135), 0.065, _SHELL)
    b.rod((0.0, 0.0, 0.135), (0.0, 0.0, 0.141), 0.062, _JOINT)
    b = brush["link1"]
    b.rod((0.0, 0.0, -0.192), (0.0, 0.0, -0.06), 0.060, _SHELL)
    b.ball((0.0, -0.005, -0.03), (0.062, 0.062, 0.075), _SHELL)
    b.rod((0.0, -0.075, 0.0), (0.0, 0.06, 0.0), 0.062, _SHELL)
    b.rod((0.0, -0.079, 0.0), (0.0, -0.075, 0.0), 0.05, _JOINT)
    b = brush["link2"]
    b.rod((0.0, 0.0, -0.06), (0.0, 0.0, 0.062), 0.059, _JOINT)
    b.pill((0.0, 0.0, 0.0), (0.0, -0.12, 0.0), 0.058, _SHELL)
    b.rod((0.0, -0.12, 0.0), (0.0, -0.192, 0.0), 0.060, _SHELL)
    b.rod((0.0, -0.192, 0.0), (0.0, -0.198, 0.0), 0.057, _JOINT)
    b = brush["link3"]
    b.rod((0.0, 0.0, -0.118), (0.0, 0.0, -0.04), 0.058, _SHELL)
    b.pill((0.0, 0.0, -0.035), (0.055, 0.015, 0.0), 0.055, _SHELL)
    b.rod((0.0825, -0.005, 0.0), (0.0825, 0.075, 0.0), 0.056, _SHELL)
    b.rod((0.0825, 0.075, 0.0), (0.0825, 0.079, 0.0), 0.045, _JOINT)
    b = brush["link4"]
    b.rod((0.0, 0.0, -0.055), (0.0, 0.0, 0.058), 0.054, _JOINT)
    b.pill((0.0, 0.0, 0.0), (-0.07, 0.06, 0.0), 0.053, _SHELL)
    b.rod((-0.0825, 0.06, 0.0), (-0.0825, 0.126, 0.0), 0.056, _SHELL)
    b.rod((-0.0825, 0.126, 0.0), (-0.0825, 0.132, 0.0), 0.052, tint)
    b = brush["link5"]
    b.rod((0.0, 0.0, -0.252), (0.0, 0.0, -0.14), 0.054, _SHELL)
    b.pill((0.0, 0.035, -0.13), (0.0, 0.07, -0.03), 0.036, _SHELL)
    b.pill((0.0, 0.02, -0.15), (0.0, 0.035, -0.06), 0.045, _SHELL)
    b.rod((0.0, 0.03, 0.0), (0.0, 0.098, 0.0), 0.047, _SHELL)
    b.rod((0.0, 0.098, 0.0), (0.0, 0.102, 0.0), 0.038, _JOINT)
    b = brush["link6"]
    b.rod((0.0, 0.0, -0.06), (0.0, 0.0, 0.055), 0.046, _JOINT)
    b.pill((0.0, 0.0, 0.0), (0.07, 0.005, 0.0), 0.05, _SHELL)
    b.rod((0.088, -0.03, 0.0), (0.088, 0.06, 0.0), 0.052, _SHELL)
    b.rod((0.088, 0.06, 0.0), (0.088, 0.064, 0.0), 0.04, _JOINT)
    b = brush["link7"]
    b.rod((0.0, 0.0, 0.055), (0.0, 0.0, 0.10), 0.045, _JOINT)
    b.pill((0.0, 0.0, 0.075), (0.033, 0.033, 0.08), 0.028, _SHELL)
    b.rod((0.0, 0.0, 0.098), (0.0, 0.0, 0.107), 0.042, _GREY)


def _hand(brush: dict[str, _Brush], tint: Color) -> None:
    """The hand's body, wide along the fingers, and two fingers with coloured tips."""
    hand = brush["hand"]
    hand.box((0.0, 0.0, 0.034), (0.026, 0.075, 0.026), _SHELL)
    for side in (1.0, -1.0):
        hand.rod((0.0, side * 0.075, 0.008), (0.0, side * 0.075, 0.060), 0.026, _SHELL)
    hand.box((0.0, 0.0, 0.0625), (0.014, 0.092, 0.004), _JOINT)
    hand.box((0.0265, 0.0, 0.034), (0.001, 0.05, 0.010), tint)
    hand.box((-0.0265, 0.0, 0.034), (0.001, 0.05, 0.010), tint)
    for part, side in (("finger_left", 1.0), ("finger_right", -1.0)):
        finger = brush[part]
        finger.box((0.0, side * 0.013, 0.018), (0.010, 0.0065, 0.016), _GREY)
        finger.box((0.0, side * 0.010, 0.036), (0.0095, 0.0095, 0.006), _GREY)
        finger.box((0.0, side * 0.0065, 0.050), (0.0093, 0.0035, 0.0105), _GREY)
        finger.box((0.0, side * 0.0015, 0.048), (0.0090, 0.0014, 0.0125), _RUBBER)
        finger.box((0.0, side * 0.0102, 0.050), (0.0085, 0.0006, 0.008), tint)

