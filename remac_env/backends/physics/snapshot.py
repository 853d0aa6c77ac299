"""Reads a WorldState out of the simulation's geometry. Nothing else turns MjData into facts."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from remac_env.backends.physics.bodies import Bodies, Standing
from remac_env.backends.physics.pose import Pose
from remac_env.kitchen.fixtures import Slot
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots.rotation import Array
from remac_env.rules.facts import ASIDE, Rules
from remac_env.state import FLOOR, FixtureState, FrozenMap, ObjectState, Place, RobotState, WorldState

STATION_DISTANCE = 0.20  # m; released threshold
STATION_COSINE = 0.98  # of the heading's error; released threshold
PAN_ON_BURNER = 0.15  # m from the burner's middle; released threshold
SLOT_SLACK = 0.06  # m over a slot's edge: an object that rolled a little still lies in it
_SURFACE_BAND = (-0.03, 0.12)  # m of an object's frame over the slot's surface
_CAVITY_HEIGHT = 0.5
_NEAR = 0.6  # m, along and across, within which all of a slot lies
_VESSEL_BAND = (-0.01, 0.14)  # m of an object's frame over that of the vessel it is in
UPRIGHT = 0.8  # z component of a vessel's axis


class Posed(Protocol):
    """Whatever says where bodies are, or are seen."""

    def pose(self, body: str) -> Pose:
        """Where a body is."""


def read_world(
    simulation: Bodies, scene: Rules, layout: Layout, objects: Mapping[str, Category], *,
    held: Mapping[str, str], marks: Mapping[str, frozenset[str]], running: frozenset[str],
) -> WorldState:
    """The world as it is.

    ``held``: robot -> what it holds, see `hands`. ``marks`` and ``running`` are what geometry does not show: marks of
    objects, and switches that a push button has left on.
    """
    robots = {n: RobotState(station_of(robot, layout), held.get(n)) for n, robot in simulation.robots.items()}
    holders = {body: name for name, body in held.items()}
    states = {
        name: ObjectState(_place(simulation, layout, objects, holders, name), marks.get(name, frozenset()))
        for name in scene.objects
    }
    fixtures = {}
    for name in scene.fixtures:
        reading = layout.fixtures[name].read(simulation.model, simulation.data)
        on = reading.on | (running & frozenset(layout.fixtures[name].switches))
        fixtures[name] = FixtureState(reading.door, frozenset(on))
    return WorldState(FrozenMap(robots), FrozenMap(states), FrozenMap(fixtures))


def station_of(robot: Standing, layout: Layout) -> str:
    """The station at which a robot stands, else ``aside``."""
    x, y, yaw = robot.standing
    for name, station in layout.stations.items():
        near = math.hypot(x - station.x, y - station.y) <= STATION_DISTANCE
        if near and math.cos(yaw - station.yaw) >= STATION_COSINE:
            return name
    return ASIDE


def touching(simulation: Bodies) -> NDArray[np.int32]:
    """Pairs of geoms (n, 2) that touch now."""
    data = simulation.data
    pairs: NDArray[np.int32] = data.contact.geom[: data.ncon]
    return pairs.copy()


def hands(
    simulation: Bodies, objects: Mapping[str, Category], moments: Iterable[NDArray[np.int32]]
) -> dict[str, str]:
    """Robot -> what it holds, at the first of these moments (`touching`) at which it holds anything."""
    held: dict[str, str] = {}
    for touched in moments:
        for name, robot in simulation.robots.items():
            body = None if name in held else holding(simulation, robot, objects, touched)
            if body is not None and body not in held.values():
                held[name] = body
    return held


def holding(
    simulation: Bodies, robot: Standing, objects: Mapping[str, Category], pairs: NDArray[np.int32] | None = None
) -> str | None:
    """The object that both fingers of a robot touch, or None; now, or where ``pairs`` touch."""
    model = simulation.model
    fingers = [model.body(finger).id for finger in robot.fingers]
    bodies = {model.body(name).id: name for name in objects}
    touched: dict[int, set[int]] = {}
    for first, second in model.geom_bodyid[touching(simulation) if pairs is None else pairs].tolist():
        for one, other in ((first, second), (second, first)):
            if one in fingers and other in bodies:
                touched.setdefault(other, set()).add(one)
    both = sorted(body for body, by in touched.items() if len(by) == 2)
    return bodies[both[0]] if both else None


def _place(
    simulation: Bodies, layout: Layout, objects: Mapping[str, Category], holders: Mapping[str, str], name: str
) -> Place:
    if name in holders:
        return Place("held", holders[name])
    position = simulation.pose(name).position
    vessel = vessel_around(simulation, objects, name, position)
    if vessel is not None:
        return Place("vessel", vessel)
    slot = slot_under(layout, position - [0.0, 0.0, objects[name].rest_height], partial(shifted, simulation, layout))
    return FLOOR if slot is None else Place("slot", slot)


def vessel_around(
    simulation: Posed, objects: Mapping[str, Category], name: str, position: Array
) -> str | None:
    """The nearest upright vessel in or on which the object's frame lies."""
    found = []
    if objects[name].vessel:
        return None
    for other, kind in objects.items():
        if other == name or not kind.vessel:
            continue
        pose = simulation.pose(other)
        middle, rotation = pose.position, pose.rotation
        aside, _, up = rotation.T @ (position - middle)
        away = math.hypot(aside, float((rotation.T @ (position - middle))[1]))
        if rotation[2, 2] >= UPRIGHT and away <= kind.body["radius"] and _VESSEL_BAND[0] <= up <= _VESSEL_BAND[1]:
            found.append((away, other))
    return min(found)[1] if found else None


def shifted(simulation: Bodies, layout: Layout, slot: str) -> Array:
    """By how much (3,) a slot has moved with its drawer, m, world frame."""
    fixture = layout.fixtures[layout.slots[slot].fixture]
    opened = max(fixture.read(simulation.model, simulation.data).door_angles, default=0.0)
    return layout.frame(fixture.name).rotation @ np.array(fixture.shift(opened))


def slot_under(layout: Layout, point: Array, seen: Callable[[str], Array] | None = None) -> str | None:
    """The slot on which an object with its lowest point at ``point`` (3,) lies, or None; world frame, m.

    ``seen``: by how much (3,) a slot seems to be off, where one asks for what is seen.
    """
    x, y = float(point[0]), float(point[1])
    found = []
    for name, (middle_x, middle_y, _) in layout.middles.items():
        # Most slots are far away, which is quick to see.
        if abs(x - middle_x) < _NEAR and abs(y - middle_y) < _NEAR:
            miss = _miss(layout, layout.slots[name], point if seen is None else point - seen(name))
            found += [] if miss is None else [(miss, name)]
    return min(found)[1] if found else None


def _miss(layout: Layout, slot: Slot, point: Array) -> float | None:
    """Distance (m) of a point from a slot's middle, None where it is not in the slot."""
    x, y = layout.frame(slot.fixture).local(float(point[0]), float(point[1]))
    aside, along, up = (abs(x - slot.center[0]), abs(y - slot.center[1]), float(point[2]) - slot.center[2])
    distance = math.hypot(aside, along)
    if slot.kind == "burner":
        return distance if distance <= PAN_ON_BURNER and _SURFACE_BAND[0] <= up <= _SURFACE_BAND[1] else None
    slack, height = (0.0, _CAVITY_HEIGHT) if slot.kind == "cavity" else (SLOT_SLACK, _SURFACE_BAND[1])
    inside = aside <= slot.half[0] + slack and along <= slot.half[1] + slack
    return distance if inside and _SURFACE_BAND[0] <= up <= height else None
