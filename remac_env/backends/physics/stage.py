"""Poses a simulation as a start says."""

from __future__ import annotations

import math
from collections.abc import Mapping

import mujoco
import numpy as np

from remac_env.backends.physics.bodies import Bodies
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots import bodies
from remac_env.robots.rotation import Array
from remac_env.start import Start
from remac_env.state import base_place

_AIR = 0.0002  # m under an object, so that it starts without penetration


def pose_start(simulation: Bodies, layout: Layout, objects: Mapping[str, Category], start: Start) -> None:
    """Set every joint of a fresh simulation: objects, doors, switches and robots."""
    simulation.clear()
    for name in start.world.objects:
        position, yaw = _object_pose(layout, objects, start, name)
        simulation.place(name, position, np.array([math.cos(0.5 * yaw), 0.0, 0.0, math.sin(0.5 * yaw)]))
    for name, state in start.world.fixtures.items():
        for joint, value in layout.fixtures[name].joints(start.doors.get(name, 0.0), state.on).items():
            simulation.data.qpos[int(simulation.model.joint(joint).qposadr[0])] = value
    for name, (index, offset) in start.robots.items():
        place = layout.asides[index]
        yaw = place.yaw + offset.yaw
        simulation.robots[name].put(bodies.get(start.body).tuck(place.x + offset.dx, place.y + offset.dy, yaw))
    mujoco.mj_forward(simulation.model, simulation.data)


def _object_pose(layout: Layout, objects: Mapping[str, Category], start: Start, name: str) -> tuple[Array, float]:
    """Position (3,) and yaw of an object in its slot, or in a vessel that is in one."""
    place, offset = start.world.objects[name].place, start.offsets[name]
    shift = np.array([offset.dx, offset.dy, objects[name].rest_height + _AIR])
    if place.relation == "vessel":
        ground = _object_pose(layout, objects, start, place.where)[0] + [0.0, 0.0, objects[place.where].inside_height]
    else:
        fixture = layout.fixtures[layout.slots[place.where].fixture]
        ground = np.array(layout.middle(place.where))
        ground += layout.frame(fixture.name).rotation @ np.array(fixture.shift(start.doors.get(fixture.name, 0.0)))
    frame = layout.frame(layout.slots[base_place(start.world, name).where].fixture)
    return ground + frame.rotation @ shift, offset.yaw + frame.heading
