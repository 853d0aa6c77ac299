"""Poses a MuJoCo model like a WorldState, so that a kitchen without physics can be looked at."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from remac_env.kitchen.fixtures.door import OPEN_TO
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots import bodies
from remac_env.robots.body import Body
from remac_env.rules.facts import ASIDE
from remac_env.start import Offset, Start
from remac_env.state import Place, WorldState, door_state

DOOR_ANGLES = {"closed": 0.0, "ajar": 0.4, "open": OPEN_TO}
"""Angles at which doors are drawn when their own is not known, rad."""


def pose(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    layout: Layout,
    categories: Mapping[str, Category],
    start: Start,
    world: WorldState,
) -> None:
    """Set positions in `data` to what `world` says: robots at their stations with folded arms, objects in the middle of
    their places but for the start's offsets. Nothing is simulated."""
    mujoco.mj_resetData(model, data)
    for name, fixture in layout.fixtures.items():
        if name in world.fixtures:
            state = world.fixtures[name]
            angle = start.doors.get(name, 0.0)
            if state.door is not None and door_state(angle) != state.door:
                angle = DOOR_ANGLES[state.door]
            for joint, value in fixture.joints(angle, state.on).items():
                data.joint(joint).qpos[0] = value
    for name in world.robots:
        _pose_robot(data, name, _standing(layout, start, world, name), bodies.get(start.body))
    mujoco.mj_kinematics(model, data)
    placed: set[str] = set()
    while len(placed) < len(world.objects):
        # What lies on something is posed after it; one pass a layer.
        for noun, item in world.objects.items():
            if noun not in placed and (item.place.relation != "vessel" or item.place.where in placed):
                _pose_object(data, layout, categories, start, noun, item.place, len(placed))
                placed.add(noun)
    mujoco.mj_forward(model, data)


def _standing(layout: Layout, start: Start, world: WorldState, name: str) -> tuple[float, float, float]:
    station = world.robots[name].station
    index, offset = start.robots[name]
    if station == ASIDE:
        place: Station = layout.asides[index]
        return place.x + offset.dx, place.y + offset.dy, place.yaw + offset.yaw
    place = layout.stations[station]
    return place.x, place.y, place.yaw


def _pose_robot(data: mujoco.MjData, name: str, standing: tuple[float, float, float], body: Body) -> None:
    for joint, value in zip(body.joints, body.tuck(*standing), strict=True):
        data.joint(f"{name}/{joint}").qpos[0] = value
    for finger in body.fingers:
        data.joint(f"{name}/{finger}").qpos[0] = body.finger_travel


def _pose_object(
    data: mujoco.MjData,
    layout: Layout,
    categories: Mapping[str, Category],
    start: Start,
    noun: str,
    place: Place,
    order: int,
) -> None:
    category = categories[start.categories[noun]]
    offset = start.offsets[noun] if place == start.world.objects[noun].place else Offset(yaw=start.offsets[noun].yaw)
    yaw = offset.yaw
    if place.relation == "slot":
        slot = layout.slots[place.where]
        fixture, frame = layout.fixtures[slot.fixture], layout.frame(slot.fixture)
        opened = max(fixture.read(data.model, data).door_angles, default=0.0)
        x, y, z = np.array(slot.center) + fixture.shift(opened)
        position = np.array(frame.space((x + offset.dx, y + offset.dy, z + category.rest_height)))
        yaw += frame.heading
    elif place.relation == "vessel":
        vessel = categories[start.categories[place.where]]
        position = data.joint(place.where).qpos[:3] + [offset.dx, offset.dy, category.height_inside(vessel)]
    elif place.relation == "held":
        position = data.site(f"{place.where}/grip").xpos.copy()
    else:
        position = np.array([0.35 * order - 1.0, -1.2, category.rest_height])
    data.joint(noun).qpos[:3] = position
    data.joint(noun).qpos[3:7] = [np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)]
