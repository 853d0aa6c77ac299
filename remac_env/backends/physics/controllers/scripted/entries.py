"""Poses of a hand inside a cavity: that bring in what it holds, or that grasp what lies there."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from remac_env.backends.physics.controllers.scripted.grasps import tip_depth
from remac_env.backends.physics.controllers.scripted.place import upright_poses
from remac_env.backends.physics.controllers.scripted.skill import lowest
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.pose import Pose
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots.body import Body
from remac_env.robots.rotation import Array, about_z, grip_frame

_TILTS = (0.45, 0.3, 0.6, 0.8)  # of the hand below the horizontal
_GRASP_TILTS = (0.6, 0.7, 0.8, 0.53, 0.45, 1.0, 0.3)
_HOLD = 0.005  # m by which the pads must reach below an object's middle, with the air that tip_depth adds
_OFF_PALM = 0.004  # m that stay between an object and the palm
_PAD = 0.012  # m to either side of a grasp's middle that the fingers hold along an object, about
_WIDEST_TURN = 1.25  # rad to the side from which a hand still fits into a cavity
_CLEAR_OF_FLOOR = 0.03  # m by which a vessel is lowered once it is in
_TOUCH = 0.003  # m between the object's lowest point and the floor where the hand opens
_FORWARD = 0.03  # m by which an object let go on end moves on as it falls


@dataclass(frozen=True, eq=False, kw_only=True)
class Entry(Pose):
    """A pose of the hand while the base drives in, and its position (3,) in the ``end``."""

    end: Array

    @property
    def last(self) -> Pose:
        """The pose in the end."""
        return Pose(self.end, self.rotation, self.frame)


def placing(here: Workspace, body: str, point: Array, clear: float, base: Array) -> Iterator[Entry]:
    """Hand poses that bring the held object in over ``point``.

    Those come first in which the object is nearly as it will lie, so that it does not topple.
    """
    offset, turned = here.robot.grip_pose().of(here.sensed.pose(body))
    heading = about_z(float(base[2]))
    found: list[tuple[float, int, Array, float]] = []
    for tilt in _TILTS:
        for side in (-heading[:, 1], heading[:, 1]):
            hand = grip_frame(heading[:, 0] * math.cos(tilt) - np.array([0.0, 0.0, math.sin(tilt)]), side)
            fall = _fall(here.kitchen.objects[body], hand @ turned)
            found.append((round(abs(fall) + 0.2 * abs(tilt - _TILTS[0]), 6), len(found), hand, fall))
    for _, _, hand, fall in sorted(found, key=lambda entry: entry[:2]):
        below = lowest(here, body, hand @ turned)
        shift = -hand @ offset
        height = max(point[2] + below + _TOUCH, point[2] + 0.03 - shift[2])
        at = np.array([point[0], point[1], height]) + shift - _FORWARD * abs(math.sin(fall)) * heading[:, 0]
        yield Entry(at + [0.0, 0.0, clear], hand, here.robot.frame, end=at)


def level(here: Workspace, point: Array) -> list[Entry]:
    """Hand poses that bring a vessel in level over ``point``."""
    grasps = upright_poses(here, point, "cavity")
    raised = [0.0, 0.0, _CLEAR_OF_FLOOR]
    return [Entry(grasp.position + raised, grasp.rotation, grasp.frame, end=grasp.position) for grasp in grasps]


def _fall(obj: Category, rotation: Array) -> float:
    """How far an object turned so is from lying or standing (rad)."""
    if obj.rest_height > 0.01:
        return math.asin(min(1.0, abs(float(rotation[2, 0]))))
    tilt = math.acos(min(1.0, abs(float(rotation[2, 2]))))
    return min(tilt, 0.5 * math.pi - tilt)


def grasping(
    obj: Category, body: Body, pose: Pose, raised: Sequence[float], askew: float, base: Array
) -> Iterator[Entry]:
    """Hand poses that grasp an object from the front, ``askew`` rad at most."""
    position, rotation = pose.position, pose.rotation
    heading = float(base[2])
    turns: tuple[float, ...] = (0.0, 0.3, -0.3, 0.6, -0.6)
    if obj.grasp.mode == "side" and not obj.grasp.any_yaw:
        along = math.atan2(rotation[1, 0], rotation[0, 0])
        along = (along - heading + 0.5 * math.pi) % math.pi - 0.5 * math.pi
        # Square to the object, or nearer to square to the cavity, for the hand is wide.
        turns = (along - math.copysign(min(askew, abs(along)), along),)
    for higher, tilt in product(raised, _GRASP_TILTS):
        for yaw in turns:
            if abs(yaw) > _WIDEST_TURN:
                continue
            front = about_z(heading + yaw)
            for side in (-front[:, 1], front[:, 1]):
                approach = front[:, 0] * math.cos(tilt) - np.array([0.0, 0.0, math.sin(tilt)])
                hand = grip_frame(approach, side)
                height = max(obj.grasp.height, tip_depth(body, 0.5 * math.pi - tilt) - obj.rest_height)
                # A long object lies along the hand: take it nearer, or its end would meet the palm.
                height += higher
                if higher and height > tip_depth(body, 0.5 * math.pi - tilt) - _HOLD:
                    continue
                spare = (body.palm - _OFF_PALM + height * math.sin(tilt)) / math.cos(tilt)
                nearer = min(max(0.0, obj.size[0] - spare), 0.6 * obj.size[0])
                at = position + [0.0, 0.0, height] - nearer * front[:, 0]
                aside, turned = _bent(obj, -nearer * front[:, 0] @ rotation)
                at, hand = at + rotation @ aside, about_z(turned) @ hand
                approach = hand[:, 2]
                yield Entry(at + [0.0, 0.0, 0.03] - 0.04 * approach, hand, pose.frame, end=at)


def _bent(obj: Category, at: Array) -> tuple[Array, float]:
    """How far (3,) beside its axis a bent object's middle line is at ``at`` in its frame, and its turn there (rad)."""
    if obj.body.form != "chain":
        return np.zeros(3), 0.0
    x, y, _ = np.array(obj.body["points"]).T
    ahead, behind = (float(np.interp(at[0] + end, x, y)) for end in (_PAD, -_PAD))
    return np.array([0.0, 0.5 * (ahead + behind), 0.0]), math.atan2(ahead - behind, 2.0 * _PAD)
