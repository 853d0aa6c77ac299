"""How each object is grasped: candidates for the pose of the hand, from the catalogue's facts about the object."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from remac_env.backends.physics.pose import Pose
from remac_env.kitchen.objects.catalogue import Category
from remac_env.kitchen.objects.colliders import WALL_PIECES
from remac_env.robots.body import Body, Fingertip
from remac_env.robots.rotation import Array, about_z, grip_frame

_OPENINGS = {"side": 0.04, "rim": 0.016, "handle": 0.03}  # m, travel of each finger: no wider than needed among others
MEASURED = Fingertip(beyond=0.0164, half_width=0.0095, thickness=0.010)
"""The fingertips with which the catalogue's heights of grasps, and distances of scripted skills, were measured."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Grasp(Pose):
    """One candidate: the grip's pose at the grasp, and its position (3,) ``before`` the approach."""

    before: Array

    @property
    def first(self) -> Pose:
        """The pose before the approach."""
        return Pose(self.before, self.rotation, self.frame)


_GENTLE = 7.0  # N a finger: tapered objects, which are light, creep out of a harder grip
_SURE = 8.0  # times the force with which a heavy object would just not slide
_GRAVITY = 9.81  # m/s2

DOWN = np.array([0.0, 0.0, -1.0])
_UP = np.array([0.0, 0.0, 1.0])
_STAND_OFF, _HANDLE_STAND_OFF = 0.12, 0.10
# Taken with the hand leaning along it, a long object lies nearly level in a hand that reaches forward into a cavity.
_LYING_LEANS = (0.45, 0.35, 0.0, 0.7)
_ASKEW, _AWAY = (0.0, 0.2, -0.2, 0.35, -0.35), (-0.3, -0.5)  # rad
_AIR = 0.006  # m between fingers and what they just fit around
_ANY_YAW = (0.0, 0.25 * math.pi, 0.5 * math.pi, -0.25 * math.pi)


def squeeze(obj: Category, body: Body) -> float | None:
    """With what force (N a finger) an object is held once the hand has closed; None: as hard as it can."""
    if obj.grasp.mode != "side":
        return None
    return max(_GENTLE, _SURE * obj.mass * _GRAVITY / (2.0 * body.grip_friction))


def opening(obj: Category, body: Body) -> float:
    """Travel of each finger (m) while the hand approaches an object."""
    return min(_OPENINGS[obj.grasp.mode], body.finger_travel)


def candidates(obj: Category, pose: Pose, body: Body) -> list[Grasp]:
    """Grasps of an object that is seen there, best first."""
    makers = {"side": _sides, "rim": _rims, "handle": _handles}
    return list(makers[obj.grasp.mode](obj, pose, body))


def _sides(obj: Category, pose: Pose, body: Body) -> Iterator[Grasp]:
    for lean, turn in product(_leans(obj, pose.rotation), _ANY_YAW if obj.grasp.any_yaw else (0.0,)):
        yield from _side(obj, pose, body, _along(pose.rotation) + turn, lean)


def awkward(obj: Category, pose: Pose, body: Body) -> list[Grasp]:
    """Further grasps of a long object, askew or leaning the other way, for where a hand square to it has no room."""
    if obj.grasp.mode != "side" or obj.grasp.any_yaw:
        return []
    turns = [turn for turn in _ASKEW if _width(obj, turn) <= 2.0 * opening(obj, body) - _AIR]
    every = product(turns, (*_leans(obj, pose.rotation), *_AWAY))
    return [grasp for turn, lean in every for grasp in _side(obj, pose, body, _along(pose.rotation) + turn, lean)]


def _along(rotation: Array) -> float:
    """The direction of an object's long axis (rad); of one that came to stand on end, that of its other axis."""
    axis = rotation[:, 0] if abs(rotation[2, 0]) < 0.8 else rotation[:, 1]
    return math.atan2(axis[1], axis[0])


def _leans(obj: Category, rotation: Array) -> tuple[float, ...]:
    lying = abs(rotation[2, 0]) < 0.8 and obj.size[0] > 1.3 * obj.size[1] and not obj.grasp.any_yaw
    return _LYING_LEANS if lying else obj.grasp.lean


def _side(obj: Category, pose: Pose, body: Body, yaw: float, lean: float) -> Iterator[Grasp]:
    """Hands over an object, the fingers to either side of the direction ``yaw``, leaning from the vertical."""
    for side in (0.5 * math.pi, -0.5 * math.pi):
        finger = about_z(yaw + side)[:, 0]
        # Lean about the finger axis only, so that both fingertips stay level.
        out = np.cross(_UP, finger)
        out = out if out[1] >= 0 else -out
        hand = grip_frame(out * math.sin(lean) + DOWN * math.cos(lean), finger)
        tilt = abs(lean)
        height = max(obj.grasp.height + 0.008 * math.sin(tilt), tip_depth(body, tilt) - obj.rest_height)
        at = pose.position + _UP * height
        yield Grasp(at, hand, pose.frame, before=at - hand[:, 2] * _STAND_OFF)


def _width(obj: Category, turn: float) -> float:
    """How far (m) the fingers open for a long object that they take askew."""
    return max(obj.grasp.width, 2.0 * math.hypot(obj.size[1] * math.cos(turn), obj.size[0] * math.sin(turn)))


def tip_depth(body: Body, lean: float) -> float:
    """How far the fingertips reach below the grip site, with a little air (m), for a hand leaning from the vertical."""
    return body.fingertip.beyond * math.cos(lean) + body.fingertip.half_width * math.sin(lean) + 0.0025


def _longer(tip: Fingertip, lean: float) -> float:
    """How much further (m) than the measured one a fingertip reaches down, of a hand leaning along its travel."""
    longer = (tip.beyond - MEASURED.beyond) * math.cos(lean) + (tip.thickness - MEASURED.thickness) * math.sin(lean)
    return max(0.0, longer)


def _rims(obj: Category, pose: Pose, body: Body) -> Iterator[Grasp]:
    position, rotation = pose.position, pose.rotation
    # Flat fingers hold a flat piece of the ring at its middle; over the edge of two, the rim turns in them.
    yaw, piece = math.atan2(rotation[1, 0], rotation[0, 0]), 2 * math.pi / WALL_PIECES
    facing = [(yaw + k * piece + 0.5 * math.pi + math.pi) % (2 * math.pi) - math.pi for k in range(WALL_PIECES)]
    for lean in obj.grasp.lean:
        for angle in sorted(facing, key=abs):
            out = about_z(angle - 0.5 * math.pi)[:, 0]
            approach = DOWN * math.cos(lean) - out * math.sin(lean)
            for side in (1.0, -1.0):
                at = position + out * obj.grasp.reach[0] + _UP * (obj.grasp.height + _longer(body.fingertip, lean))
                yield Grasp(at, grip_frame(approach, side * out), pose.frame, before=at - approach * _STAND_OFF)


def _handles(obj: Category, pose: Pose, body: Body) -> Iterator[Grasp]:
    position, rotation = pose.position, pose.rotation
    along = -rotation[:, 1] * [1.0, 1.0, 0.0]
    along = along / np.linalg.norm(along)
    across = np.cross(_UP, along)
    for reach in obj.grasp.reach:
        for lean in obj.grasp.lean:
            for side in (1.0, -1.0):
                approach = DOWN * math.cos(lean) - along * math.sin(lean)
                at = position + along * reach + _UP * (obj.grasp.height + _longer(body.fingertip, lean))
                hand = grip_frame(approach, side * across)
                yield Grasp(at, hand, pose.frame, before=at - approach * _HANDLE_STAND_OFF)
