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
    from collections.abc import Iterable, Iterator, Sequence

    import mujoco

    from remac_env.kitchen.floor_plan import Layout

Point = tuple[float, float, float]
Floats = NDArray[np.float64]

FRONT = "front"
"""All that robots work at and every place of theirs, in a square picture, seen from the open side of the room."""

WIDE = "wide"
"""The same in a picture of 16 to 9, for people."""

ROOM = "room"
"""The whole kitchen with its back wall, from nearer by: the picture `station` while a robot is away from all stations.
Checkers that see have learnt it so: what is shipped does not know robots that stand aside from FRONT."""

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
"""Vertical, degrees, of cameras that look at one place from near by."""
WHOLE_FIELD = 20.0
"""Vertical, degrees, of those that show robots and their work from the open side of the room: from far away, so that
robots in the foreground are not large and their work small."""
STEEP = 18.0
"""Degrees above the horizon from which they look: on to worktops, and on to little floor."""

WIDE_ASPECT = 16 / 9

# Position relative to what is looked at, by kind of slot: from the right, or from the left where a door opens to the
# right; steeply down into a basin, almost level into a cupboard.
_FROM = {
    "surface": (0.42, -0.72, 0.80),
    "burner": (0.42, -0.72, 0.80),
    "basin": (0.30, -0.42, 0.95),
    "cavity": (0.40, -0.95, 0.42),
}
_BETWEEN_PANELS = 0.25  # of the way to the side, where a door opens to either side
_WORK_LOW, _ROBOT_TOP = 0.7, 1.3  # m above the floor: fixtures are seen from here up, robots up to here
_ROBOT_HALF = 0.40  # m, of a robot's base, and how far it may stand off its place
_FRAMED = 0.98  # of the picture
# The room's camera: degrees above the horizon, fewer of them a metre of depth, and at least; m, as above.
_HIGHEST, _LOWER, _LOWEST = 34.0, 2.8, 16.0
_FRONT_SLACK, _WALL_TOP, _ROBOT_NEAR = 0.3, 2.25, 0.36
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
    """The front, the wide and the room's camera and one side camera for each station."""
    whole = (front_camera(layout), wide_camera(layout), room_camera(layout))
    return (*whole, *(side_camera(layout, station) for station in layout.stations))


def front_camera(layout: Layout) -> Camera:
    """As near as it can be while what robots work at, and robots wherever they stand, are in a square picture.

    The picture's lower edge is where the foremost robot stands: no floor before it is seen.
    """
    return _before_room(FRONT, 1.0, layout, low=True)


def wide_camera(layout: Layout) -> Camera:
    """The same for a picture of 16 to 9."""
    return _before_room(WIDE, WIDE_ASPECT, layout)


def room_camera(layout: Layout) -> Camera:
    """As near as it can be with the same and the back wall in a square picture; the deeper the kitchen, the lower."""
    used = [fixture for fixture in layout.fixtures.values() if fixture.station is not None]
    blocks = [layout.frame(fixture.name).block(block) for fixture in used for block in fixture.blocks]
    depth = max(0.0, -min((block.low[1] for block in blocks), default=0.0) - _FRONT_SLACK)
    points = [
        (x, y, z) for b in blocks for x, y, z in product((b.low[0], b.high[0]), (b.low[1], b.high[1]), (0.0, b.high[2]))
    ]
    points += [(x, y, z) for x in layout.room.x for y in (0.0, WALL_Y) for z in (0.0, _WALL_TOP)]
    for place in (*layout.stations.values(), *layout.asides):
        sides = place.x - _ROBOT_NEAR, place.x + _ROBOT_NEAR
        heights = (0.0, _ROBOT_TOP) if place in layout.asides else (0.0,)
        points += [(place.x, place.y - _ROBOT_NEAR, 0.0), (place.x, place.y, _ROBOT_TOP)]
        points += [(x, place.y, z) for x in sides for z in heights]
    return _placed(ROOM, 1.0, max(_LOWEST, _HIGHEST - _LOWER * depth), FIELD, points, low=True)


def _before_room(name: str, aspect: float, layout: Layout, *, low: bool = False) -> Camera:
    """Before the open side, as near as it can be while all the work is in the picture."""
    return _placed(name, aspect, STEEP, WHOLE_FIELD, [*_work(layout), *_robots(layout)], low=low)


def _placed(name: str, aspect: float, steep: float, field: float, points: Sequence[Point], *, low: bool) -> Camera:
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


def _work(layout: Layout) -> Iterator[Point]:
    """Corners of the fixtures that robots use, above the height of what they use there; not of hoods and walls."""
    for fixture in layout.fixtures.values():
        if fixture.station is None:
            continue
        for block in map(layout.frame(fixture.name).block, fixture.blocks):
            low = max(block.low[2], min(_WORK_LOW, block.high[2]))
            yield from product((block.low[0], block.high[0]), (block.low[1], block.high[1]), (low, block.high[2]))


def _robots(layout: Layout) -> Iterator[Point]:
    """Corners of robots at all their places."""
    for place in (*layout.stations.values(), *layout.asides):
        for x, y in product((-_ROBOT_HALF, _ROBOT_HALF), repeat=2):
            yield place.x + x, place.y + y, 0.0
        yield place.x, place.y, _ROBOT_TOP


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
    spec.worldbody.add_camera(name=FOLLOW, fovy=WHOLE_FIELD)


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
