"""Cameras: where they stand, as facts, and adding them to a model's description."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, radians, sin, tan
from typing import TYPE_CHECKING

import numpy as np

from remac_env.errors import check_choice
from remac_env.kitchen.fixtures.base import WALL_Y

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    import mujoco

    from remac_env.kitchen.layout import Layout

Point = tuple[float, float, float]

FRONT = "front"
"""The whole kitchen in a square picture, seen from the open side of the room."""

WIDE = "wide"
"""The whole kitchen in a picture of 16 to 9, for people."""

WRIST = "{robot}/wrist"
"""What a robot's hand sees."""

SIDE = "side/{station}"
"""A close look at what stands at a station, into cupboards and the microwave."""

_FIELD = 46.0  # vertical, degrees
_WIDE_FIELD = 33.0  # from further away, so that robots in the foreground do not hide the kitchen
_ROOM_MARGIN = 1.05
_FRONT_ASPECT, _FRONT_HEIGHT, _FRONT_LOOKS_AT = 1.0, 2.40, 0.25
_WIDE_ASPECT, _WIDE_HEIGHT, _WIDE_LOOKS_AT = 16 / 9, 2.45, 0.85

# Position relative to what is looked at, by kind of slot: from the right, or from the left where a door opens to the
# right; steeply down into a basin, almost level into a cupboard.
_FROM = {
    "surface": (0.42, -0.72, 0.80),
    "burner": (0.42, -0.72, 0.80),
    "basin": (0.30, -0.42, 0.95),
    "cavity": (0.40, -0.95, 0.42),
}
# Deep kitchens: degrees above the horizon, and more of them a metre of depth; heights, m, that are to be seen.
_LEAST_STEEP, _STEEPER, _STEEPEST = 16.0, 9.0, 34.0
_DEEP_LOOKS_AT, _DEEP_TOP, _BACK_TOP, _ROBOT_TOP = 0.7, 1.4, 2.25, 1.2
_FRAMED = 0.98  # of the picture
_FRONT_SLACK = 0.3  # m that fixtures along the back wall stand out
_WALL_GAP = 0.12  # seen from behind, a wall would be a veil over the picture
# In the hand's frame: z along the fingers, which end at 0.115, and x away from the robot when it works ahead of itself.
_WRIST_AT, _WRIST_LOOKS_AT, _WRIST_FIELD = (0.115, 0.0, 0.04), (0.02, 0.0, 0.17), 72.0
_BARE_STATION = (0.0, 0.95)  # y and z looked at where a station has no slots


@dataclass(frozen=True)
class Camera:
    """A fixed camera: position and the point it looks at, m, world frame; vertical field of view, degrees."""

    name: str
    position: Point
    target: Point
    field: float


def fixed_cameras(layout: Layout) -> tuple[Camera, ...]:
    """The front and the wide camera and one side camera for each station."""
    whole = (front_camera(layout), wide_camera(layout))
    return (*whole, *(side_camera(layout, station) for station in layout.stations))


def front_camera(layout: Layout) -> Camera:
    """Far enough from the wall for the whole width of the room in a square picture."""
    return _before_room(layout, FRONT, _FIELD, _FRONT_ASPECT, _FRONT_HEIGHT, _FRONT_LOOKS_AT)


def wide_camera(layout: Layout) -> Camera:
    """Far enough from the wall for the whole width of the room in a picture of 16 to 9."""
    return _before_room(layout, WIDE, _WIDE_FIELD, _WIDE_ASPECT, _WIDE_HEIGHT, _WIDE_LOOKS_AT)


def _before_room(layout: Layout, name: str, field: float, aspect: float, height: float, looks_at: float) -> Camera:
    left, right = layout.room.x
    middle = (left + right) / 2
    distance = _ROOM_MARGIN * (right - left) / 2 / (tan(radians(field) / 2) * aspect)
    depth = _depth(layout)
    if depth <= 0.0:
        return Camera(name, (middle, -distance, height), (middle, 0.0, looks_at), field)
    # A deep kitchen is seen from above, over what stands in front, from as far as it takes to see all of it.
    steep = radians(min(_STEEPEST, _STEEPER * depth) + _LEAST_STEEP)
    target = (middle, -depth / 2, _DEEP_LOOKS_AT)
    points = [(x, -y, z) for x in (left, right) for y in (0.0, depth) for z in (0.0, _DEEP_TOP)]
    points += [(x, WALL_Y, _BACK_TOP) for x in (left, right)]
    places = (*layout.stations.values(), *layout.asides)
    points += [(place.x, place.y, z) for place in places for z in (0.0, _ROBOT_TOP)]
    for step in range(200):
        away = 3.0 + 0.1 * step
        camera = Camera(name, (middle, target[1] - away * cos(steep), target[2] + away * sin(steep)), target, field)
        if all(max(map(abs, in_picture(camera, point, aspect))) < _FRAMED for point in points):
            break
    return camera


def _depth(layout: Layout) -> float:
    """How far the fixtures that robots use reach into the room, m, beyond those along its back wall."""
    used = [fixture for fixture in layout.fixtures.values() if fixture.station is not None]
    fronts = [layout.frame(fixture.name).block(block).low[1] for fixture in used for block in fixture.blocks]
    return max(0.0, -min(fronts, default=0.0) - _FRONT_SLACK)


def in_picture(camera: Camera, point: Point, aspect: float) -> tuple[float, float]:
    """Where a point lies in a camera's picture, both within -1..1 when it is seen; infinite where it is behind."""
    back = np.array(camera.position) - np.array(camera.target)
    back /= np.linalg.norm(back)
    right = np.cross((0.0, 0.0, 1.0), back)
    right /= np.linalg.norm(right)
    offset = np.array(point) - np.array(camera.position)
    depth, half = float(-offset @ back), tan(radians(camera.field) / 2)
    if depth <= 0.0:
        return float("inf"), float("inf")
    return float(offset @ right) / (half * aspect * depth), float(offset @ np.cross(back, right)) / (half * depth)


def side_camera(layout: Layout, station: str) -> Camera:
    """Looks at the middle of what is used from a station; raises UnknownNameError."""
    check_choice("station", station, layout.stations)
    place = layout.stations[station]
    frame = layout.facing(place)
    slots = [slot for slot in layout.slots.values() if slot.station == station]
    if slots:
        x, y, z = (float(value) for value in np.mean([slot.center for slot in slots], axis=0))
    else:
        x, (y, z) = frame.local(place.x, place.y)[0], _BARE_STATION
    dx, dy, dz = _FROM[slots[0].kind if slots else "surface"]
    if any(layout.fixtures[slot.fixture].opens_to == "right" for slot in slots):
        dx = -dx
    eye = frame.space((x + dx, y + dy, z + dz))
    (left, right), gap = layout.room.x, _WALL_GAP
    eye = (min(max(eye[0], left + gap), right - gap), min(eye[1], WALL_Y - gap), eye[2])
    return Camera(SIDE.format(station=station), eye, frame.space((x, y, z)), _FIELD)


def add_cameras(spec: mujoco.MjSpec, layout: Layout, robots: Sequence[str]) -> None:
    """Add the fixed cameras and one on each robot's hand, named by FRONT, WIDE, SIDE and WRIST."""
    for camera in fixed_cameras(layout):
        spec.worldbody.add_camera(
            name=camera.name,
            pos=list(camera.position),
            quat=_turn_towards(camera.position, camera.target),
            fovy=camera.field,
        )
    for robot in robots:
        add_wrist_camera(spec, robot)


def add_wrist_camera(spec: mujoco.MjSpec, robot: str) -> None:
    """Add a camera on a robot's hand that looks past the fingertips, so that what is held or near them is seen."""
    turn = _turn_towards(_WRIST_AT, _WRIST_LOOKS_AT, up=(1.0, 0.0, 0.0))
    spec.body(f"{robot}/hand").add_camera(
        name=WRIST.format(robot=robot), pos=list(_WRIST_AT), quat=turn, fovy=_WRIST_FIELD
    )


def _turn_towards(position: Iterable[float], target: Iterable[float], up: Point = (0.0, 0.0, 1.0)) -> list[float]:
    """Quaternion (w, x, y, z) of a camera, which looks along its -z axis with y up."""
    import mujoco

    back = np.array(list(position), dtype=float) - np.array(list(target), dtype=float)
    back /= np.linalg.norm(back)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    turn = np.empty(4)
    mujoco.mju_mat2Quat(turn, np.stack([right, np.cross(back, right), back], axis=1).ravel())
    return [float(value) for value in turn]
