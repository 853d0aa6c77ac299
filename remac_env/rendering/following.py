"""Cameras that follow what happens: wrist pictures stay upright, and what a hand holds is framed.

Where they stand is a function of the layout and of the present pose, so that equal states give equal pictures.
"""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np
from numpy.typing import NDArray

from remac_env.kitchen.canvas import COARSE_GROUP, DRAWN_GROUP
from remac_env.kitchen.fixtures.base import WALL_Y
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.layout_checks import world_blocks
from remac_env.rendering.cameras import FIELD, HELD, WRIST, WRIST_AT, WRIST_LOOKS_AT, axes, fitted, side_offset
from remac_env.rules.facts import ASIDE
from remac_env.state import WorldState

Floats = NDArray[np.float64]

_UP = np.array([0.0, 0.0, 1.0])
_MIRRORED = np.array([-1.0, 1.0, 1.0])
_TURNED_OVER = -0.3  # how far ahead and up a hand's x axis points: below this the camera sits on its other side
_STRAIGHT_DOWN = 0.97  # of a unit of sight that is vertical: from here on "up" is where the robot faces

# Directions from what is held to the camera: to the right, ahead and up, as the robot faces. The one from which most of
# it is seen is taken, and of several the nearest.
_SIDES = ((0.95, 0.1, 0.45), (0.7, -0.5, 0.7), (0.6, 0.6, 0.5), (0.1, -0.3, 1.0))
_DIRECTIONS = tuple((side * x, y, z) for x, y, z in _SIDES for side in (1, -1))
_INTO = ((0.8, -0.8, 0.4), (0.95, -0.5, 0.4), (1.0, -0.25, 0.4), (0.6, -1.0, 0.15))  # the same, into what has a door
_TO_EDGE = 0.15  # m from the middle of a place on a worktop towards the robot
_ABOVE = (0.0, 0.0, 0.03)  # m over a floor, where something lies on it
_FRAMED = 0.80  # of the picture's width and height is what must be seen
_NEAREST = 0.25  # m from the camera to the nearest point of it
_GAP = 0.12  # m from the camera to walls
_INNER = 0.6  # of an object's box: its corners are looked for there, since round objects do not fill theirs
_TOUCH, _BESIDE = 0.01, 0.12  # m: what is so near a point of what is held, or over a place, does not hide it
_DRAWN = np.array([group in (DRAWN_GROUP, COARSE_GROUP) for group in range(mujoco.mjNGROUP)], dtype=np.uint8)
_CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)


def follow(model: mujoco.MjModel, data: mujoco.MjData, layout: Layout, world: WorldState) -> None:
    """Place the cameras WRIST and HELD of all robots in `data`, whose positions must be computed."""
    for robot, state in world.robots.items():
        _keep_upright(data, robot)
        if state.holding is not None:
            _frame_held(model, data, layout, world, robot, state.holding)


def _keep_upright(data: mujoco.MjData, robot: str) -> None:
    """Put the wrist's camera on the hand's outer side, ahead of it or above, with the world's up in the picture's.

    Where it looks straight down, what lies ahead of the robot is up in the picture.
    """
    hand, camera = data.body(f"{robot}/hand"), data.camera(WRIST.format(robot=robot))
    turn = hand.xmat.reshape(3, 3)
    facing = facing_of(data, robot)
    outward = float((facing[:, 1] + _UP) @ turn[:, 0])
    side = _MIRRORED if outward < _TURNED_OVER else 1.0
    eye, target = (hand.xpos + turn @ (side * np.array(point)) for point in (WRIST_AT, WRIST_LOOKS_AT))
    back = eye - target
    steep = abs(back[2]) > _STRAIGHT_DOWN * np.linalg.norm(back)
    camera.xpos[:] = eye
    camera.xmat[:] = axes(back, facing[:, 1] if steep else _UP).ravel()


def _frame_held(
    model: mujoco.MjModel, data: mujoco.MjData, layout: Layout, world: WorldState, robot: str, held: str
) -> None:
    """Look at what a robot holds, at its hand and at what lies at its station, from where most of it is seen."""
    station = world.robots[robot].station
    slots = [slot for slot in layout.slots.values() if slot.station == station]
    shut_in = any(layout.fixtures[slot.fixture].door_panels for slot in slots)
    taken = {item.place.where for item in world.objects.values() if item.place.relation == "slot"}
    places = np.array([layout.middle(s.name) for s in slots if shut_in or s.name in taken]).reshape(-1, 3)
    facing = facing_of(data, robot)
    points = [_corners(model, data, held), _corners(model, data, f"{robot}/hand"), places]
    if slots and not len(places):
        points.append(np.mean([layout.middle(slot.name) for slot in slots], axis=0, keepdims=True))
        points[-1] -= _TO_EDGE * facing[:, 1]
    framed, inner = np.concatenate(points), _corners(model, data, held, _INNER)
    sought = np.concatenate([inner, places + _ABOVE])
    near = np.repeat([_TOUCH, _BESIDE], [len(inner), len(places)])
    weights = np.repeat([1.0, len(inner) / max(1, len(places))], [len(inner), len(places)])
    camera = data.camera(HELD.format(robot=robot))
    best = (-1.0, 0.0)
    for back in _directions(layout, station, shut_in, facing):
        turn = axes(back, _UP)
        eye = fitted(framed, turn, FIELD, framed=_FRAMED, near=_NEAREST)
        seen = float(weights @ _seen(model, data, eye, sought, near, held)) if _is_free(layout, eye) else 0.0
        rank = (round(seen, 6), -round(float(np.linalg.norm(eye - inner[0])), 6))
        if rank > best:
            best, camera.xpos[:], camera.xmat[:] = rank, eye, turn.ravel()


def _directions(layout: Layout, station: str, shut_in: bool, facing: Floats) -> Iterator[Floats]:
    """Directions, world frame, from which to look at what is held at a station."""
    if station != ASIDE:
        usual = np.array(side_offset(layout, station))
        frame = layout.facing(layout.stations[station]).rotation
        yield frame @ usual
        if shut_in:
            side = np.copysign(1.0, usual[0])
            yield from (frame @ (side * x, y, z) for x, y, z in _INTO)
    for direction in _DIRECTIONS:
        yield facing @ np.array(direction)


def facing_of(data: mujoco.MjData, robot: str) -> Floats:
    """Right, ahead and up of a robot as columns (3, 3), world frame."""
    joint = int(data.model.body(f"{robot}/base").jntadr[0]) + 2  # its joints are x, y and yaw, whatever they are called
    yaw = float(data.joint(joint).qpos[0])
    ahead = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    return np.stack([np.cross(ahead, _UP), ahead, _UP], axis=1)


def _corners(model: mujoco.MjModel, data: mujoco.MjData, body: str, share: float = 1.0) -> Floats:
    """Corners (n, 3) of the boxes around a body's drawn shapes, m, drawn in to a share of their size."""
    facts = model.body(body)
    first = int(facts.geomadr[0])
    geoms = [g for g in range(first, first + facts.geomnum[0]) if _DRAWN[model.geom_group[g]]]
    boxes = [model.geom_aabb[g, :3] + share * _CORNERS * model.geom_aabb[g, 3:] for g in geoms]
    turns = [data.geom_xmat[g].reshape(3, 3) for g in geoms]
    return np.concatenate([data.geom_xpos[g] + box @ turn.T for g, box, turn in zip(geoms, boxes, turns, strict=True)])


def _is_free(layout: Layout, eye: Floats) -> bool:
    """Whether a place is in the room and in no furniture."""
    left, right = layout.room.x
    inside = left + _GAP < eye[0] < right - _GAP and eye[1] < WALL_Y - _GAP
    place = (float(eye[0]), float(eye[1]), float(eye[2]))
    return inside and not any(
        block.holds(place) for fixture in layout.fixtures.values() for block in world_blocks(layout, fixture)
    )


def _seen(
    model: mujoco.MjModel, data: mujoco.MjData, eye: Floats, points: Floats, near: Floats, body: str
) -> NDArray[np.bool_]:
    """Whether nothing but the body, or what is near it, is in the way from a place to each point, (n, 3) -> (n,)."""
    way = points - eye
    far = np.linalg.norm(way, axis=1)
    count = len(points)
    geoms, distances = np.full(count, -1, np.int32), np.zeros(count)
    way = np.ascontiguousarray(way / far[:, None]).ravel()
    mujoco.mj_multiRay(model, data, eye, way, _DRAWN, 1, -1, geoms, distances, None, count, mujoco.mjMAXVAL)
    seen: NDArray[np.bool_] = (model.geom_bodyid[geoms] == model.body(body).id) & (geoms >= 0)
    seen |= (geoms < 0) | (distances > far - near)
    return seen
