"""Cameras: where they stand, as facts, and adding them to a model's description."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import cos, radians, sin, tan
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from remac_env.errors import check_choice
from remac_env.kitchen.fixtures.base import WALL_Y

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    import mujoco

    from remac_env.kitchen.fixtures.base import Fixture
    from remac_env.kitchen.floor_plan import Layout

Point = tuple[float, float, float]
Floats = NDArray[np.float64]

FRONT = "front"
"""The whole kitchen in a square picture, seen from the open side of the room."""

WIDE = "wide"
"""The whole kitchen in a picture of 16 to 9, for people."""

WRIST = "{robot}/wrist"
"""What a robot's hand sees."""

HELD = "{robot}/held"
"""What a robot holds, its hand, and what it stands at; placed by `following.follow`."""

FOLLOW = "follow"
"""The robots and what they work at, for videos; placed by `tracking.place`."""

CLOSE = "{robot}/close"
"""A robot's hand from near by, for videos; placed by `tracking.place`."""

SIDE = "side/{station}"
"""A close look at what stands at a station, into cupboards and the microwave."""

FIELD = 46.0
"""Vertical, degrees, of cameras with square pictures."""
FOLLOW_FIELD = 34.0
"""Vertical, degrees, of the camera that follows the robots."""

_WIDE_FIELD = 33.0  # from further away, so that robots in the foreground do not hide the kitchen
_FRONT_ASPECT, WIDE_ASPECT = 1.0, 16 / 9

# Position relative to what is looked at, by kind of slot: from the right, or from the left where a door opens to the
# right; steeply down into a basin, almost level into a cupboard.
_FROM = {
    "surface": (0.42, -0.72, 0.80),
    "burner": (0.42, -0.72, 0.80),
    "basin": (0.30, -0.42, 0.95),
    "cavity": (0.40, -0.95, 0.42),
}
_BETWEEN_PANELS = 0.25  # of the way to the side, where a door opens to either side
# Whole kitchens: degrees above the horizon, more of them a metre of depth, and at most; then heights to be seen, m.
_LEAST_STEEP, _STEEPER, _STEEPEST = 14.0, 3.5, 27.0
_HIGHEST, _LOWER, _LOWEST = 34.0, 2.8, 16.0  # the same of square pictures: fewer of them a metre, and at least
_FIXTURE_TOP, _WALL_TOP, _ROBOT_TOP = 1.4, 2.25, 1.3
_ROBOT_HALF = 0.36  # m, of a robot's base
_FRAMED = 0.98  # of the picture
_FRONT_SLACK = 0.3  # m that fixtures along the back wall stand out
_WALL_GAP = 0.12  # seen from behind, a wall would be a veil over the picture
# In the hand's frame: z along the fingers, which end at 0.115, and x away from the robot when it works ahead of itself.
WRIST_AT, WRIST_LOOKS_AT, _WRIST_FIELD = (0.115, 0.0, 0.04), (0.02, 0.0, 0.17), 72.0
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
    """As near as it can be while all worktops, fixtures and robots are in a square picture, with little floor before.

    The deeper the kitchen, the lower it stands: less of the floor between the fixtures is seen.
    """
    steep = max(_LOWEST, _HIGHEST - _LOWER * _depth(layout))
    return _before_room(FRONT, FIELD, _FRONT_ASPECT, steep, _work(layout), low=True)


def wide_camera(layout: Layout) -> Camera:
    """As near as it can be while the whole kitchen is in a picture of 16 to 9.

    The deeper the kitchen, the higher it stands, to look over what is in front.
    """
    depth = _depth(layout)
    steep = min(_STEEPEST, _LEAST_STEEP + _STEEPER * depth)
    return _before_room(WIDE, _WIDE_FIELD, WIDE_ASPECT, steep, _to_be_seen(layout, depth))


def _before_room(
    name: str, field: float, aspect: float, steep: float, points: list[Point], *, low: bool = False
) -> Camera:
    """Before the open side, as near as it can be while all points are in the picture."""
    back = np.array([0.0, -cos(radians(steep)), sin(radians(steep))])
    turn = axes(back, np.array([0.0, 0.0, 1.0]))
    position = fitted(np.array(points), turn, field, aspect=aspect, framed=_FRAMED, low=low)
    return Camera(name, _point(position), _point(position - back), field)


def fitted(
    points: Floats, turn: Floats, field: float, *, aspect: float = 1.0, framed: float = 1.0, near: float = 0.0,
    low: bool = False,
) -> Floats:  # fmt: skip
    """The nearest place, (3,), from which a camera with these axes has all points, (n, 3), in its picture.

    framed: how much of the picture they may fill, 0..1. near: m that the camera keeps from them at least. They are in
    the picture's middle; with `low`, at its lower edge.
    """
    slope = tan(radians(field) / 2) * framed
    x, y, z = (points @ turn).T
    x = x / aspect
    high, deep = (np.array([(side * along + slope * z).max() for along in (x, y)]) for side in (1, -1))
    away = max(float(z.max()) + near, float((high + deep).max()) / (2 * slope))
    across, up = (high - deep) / 2
    if low:
        up = slope * away - deep[1]
    place: Floats = turn @ np.array([across * aspect, up, away])
    return place


def _to_be_seen(layout: Layout, depth: float) -> list[Point]:
    """What must be in pictures of the whole kitchen: the back wall, the fixtures' ends, robots wherever they may be."""
    sides = layout.room.x
    return [(x, -depth, z) for x in sides for z in (0.0, _FIXTURE_TOP)] + _back_and_robots(layout)


def _work(layout: Layout) -> list[Point]:
    """The same with the corners of the fixtures that robots use instead of the room's sides."""
    blocks = [layout.frame(fixture.name).block(block) for fixture in _used(layout) for block in fixture.blocks]
    corners = [
        (x, y, z) for b in blocks for x, y, z in product((b.low[0], b.high[0]), (b.low[1], b.high[1]), (0.0, b.high[2]))
    ]
    arms = [(place.x + side * _ROBOT_HALF, place.y, _ROBOT_TOP) for place in layout.asides for side in (-1, 1)]
    return corners + arms + _back_and_robots(layout)


def _back_and_robots(layout: Layout) -> list[Point]:
    points = [(x, y, z) for x in layout.room.x for y in (0.0, WALL_Y) for z in (0.0, _WALL_TOP)]
    for place in (*layout.stations.values(), *layout.asides):
        points += [(place.x, place.y - _ROBOT_HALF, 0.0), (place.x, place.y, _ROBOT_TOP)]
        points += [(place.x + side * _ROBOT_HALF, place.y, 0.0) for side in (-1, 1)]
    return points


def _used(layout: Layout) -> list[Fixture]:
    """The fixtures that robots use."""
    return [fixture for fixture in layout.fixtures.values() if fixture.station is not None]


def _depth(layout: Layout) -> float:
    """How far the fixtures that robots use reach into the room, m, beyond those along its back wall."""
    fronts = [layout.frame(fixture.name).block(block).low[1] for fixture in _used(layout) for block in fixture.blocks]
    return max(0.0, -min(fronts, default=0.0) - _FRONT_SLACK)


def in_picture(camera: Camera, point: Point, aspect: float) -> tuple[float, float]:
    """Where a point lies in a camera's picture, both within -1..1 when it is seen; infinite where it is behind."""
    x, y = _in_picture(camera, np.array([point]), aspect)[0]
    return float(x), float(y)


def _in_picture(camera: Camera, points: Floats, aspect: float) -> Floats:
    """The same for points (n, 3) at once: (n, 2)."""
    right, up, back = axes(np.array(camera.position) - np.array(camera.target), np.array([0.0, 0.0, 1.0])).T
    offsets = points - np.array(camera.position)
    half = tan(radians(camera.field) / 2)
    depth = np.maximum(-offsets @ back, 0.0)[:, None]
    places = offsets @ np.stack([right / (half * aspect), up / half], axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(depth > 0.0, places / depth, np.inf)


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
    dx, dy, dz = side_offset(layout, station)
    eye = frame.space((x + dx, y + dy, z + dz))
    (left, right), gap = layout.room.x, _WALL_GAP
    eye = (min(max(eye[0], left + gap), right - gap), min(eye[1], WALL_Y - gap), eye[2])
    return Camera(SIDE.format(station=station), eye, frame.space((x, y, z)), FIELD)


def side_offset(layout: Layout, station: str) -> Point:
    """From where a side camera looks, m from what it looks at, in the frame of the station's wall."""
    slots = [slot for slot in layout.slots.values() if slot.station == station]
    dx, dy, dz = _FROM[slots[0].kind if slots else "surface"]
    fixtures = [layout.fixtures[slot.fixture] for slot in slots]
    if any(len(fixture.door_panels) > 1 for fixture in fixtures):
        dx *= _BETWEEN_PANELS
    elif any(fixture.opens_to == "right" for fixture in fixtures):
        dx = -dx
    return dx, dy, dz


def add_cameras(spec: mujoco.MjSpec, layout: Layout, robots: Sequence[str]) -> None:
    """Add the fixed cameras, three for each robot and one for all: FRONT, WIDE, SIDE, WRIST, HELD, CLOSE, FOLLOW."""
    for camera in fixed_cameras(layout):
        spec.worldbody.add_camera(
            name=camera.name,
            pos=list(camera.position),
            quat=_turn_towards(camera.position, camera.target),
            fovy=camera.field,
        )
    for robot in robots:
        add_wrist_camera(spec, robot)
        spec.worldbody.add_camera(name=HELD.format(robot=robot), fovy=FIELD)
        spec.worldbody.add_camera(name=CLOSE.format(robot=robot), fovy=FIELD)
    spec.worldbody.add_camera(name=FOLLOW, fovy=FOLLOW_FIELD)


def add_wrist_camera(spec: mujoco.MjSpec, robot: str) -> None:
    """Add a camera on a robot's hand that looks past the fingertips, so that what is held or near them is seen."""
    turn = _turn_towards(WRIST_AT, WRIST_LOOKS_AT, up=(1.0, 0.0, 0.0))
    spec.body(f"{robot}/hand").add_camera(
        name=WRIST.format(robot=robot), pos=list(WRIST_AT), quat=turn, fovy=_WRIST_FIELD
    )


def _turn_towards(position: Iterable[float], target: Iterable[float], up: Point = (0.0, 0.0, 1.0)) -> list[float]:
    """Quaternion (w, x, y, z) of a camera, which looks along its -z axis with y up."""
    import mujoco

    back = np.array(list(position), dtype=float) - np.array(list(target), dtype=float)
    turn = np.empty(4)
    mujoco.mju_mat2Quat(turn, axes(back, np.array(up)).ravel())
    return [float(value) for value in turn]


def axes(back: Floats, up: Floats) -> Floats:
    """The axes of a camera as columns (3, 3): right, up and `back`, away from what it looks at."""
    back = back / np.linalg.norm(back)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(back, right), back], axis=1)


def _point(vector: Floats) -> Point:
    x, y, z = (float(part) for part in vector)
    return x, y, z
