"""Cameras of the layouts see what they are for."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from remac_env.errors import UnknownNameError
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import parking
from remac_env.kitchen.fixtures import models as fixture_models
from remac_env.kitchen.floor_plan import Station
from remac_env.kitchen.layout_checks import world_blocks
from remac_env.rendering import cameras
from remac_env.rendering.renderer import Renderer
from remac_env.state import FrozenMap

LEAST_TALL, LEAST_TALL_WIDE = 0.17, 0.22
"""Of a picture's height, a robot at the farthest station."""

every_layout = pytest.mark.parametrize("name", layouts.names())


@every_layout
@pytest.mark.parametrize("team", [2, 4])
def test_front_and_wide_cameras_frame_the_work_and_no_more(name: str, team: int) -> None:
    layout = parking.for_robots(layouts.load(name), team)
    for camera, aspect in ((cameras.front_camera(layout), 1.0), (cameras.wide_camera(layout), 16 / 9)):
        points = [layout.middle(slot) for slot in layout.slots]
        for place in (*layout.asides, *layout.stations.values()):
            points += [(place.x, place.y, z) for z in (0.0, 1.2)]
        for fixture in filter(lambda each: each.station is not None, layout.fixtures.values()):
            blocks = map(layout.frame(fixture.name).block, fixture.blocks)
            points += [(x, y, b.high[2]) for b in blocks for x in (b.low[0], b.high[0]) for y in (b.low[1], b.high[1])]
        places = np.abs([cameras.in_picture(camera, point, aspect) for point in points])
        assert places.max() < 1.0
        assert places.max() > 0.9, "a nearer camera sees as much"


@every_layout
def test_the_farthest_robots_are_large_in_pictures_of_the_whole(name: str) -> None:
    for team in (1, 2, 3, 4):
        layout = parking.for_robots(layouts.load(name), team)
        front, wide = cameras.front_camera(layout), cameras.wide_camera(layout)
        assert min(_tall(front, place, 1.0) for place in layout.stations.values()) >= LEAST_TALL
        assert min(_tall(wide, place, 16 / 9) for place in layout.stations.values()) >= LEAST_TALL_WIDE
        short = replace(front, field=2 * front.field)
        assert min(_tall(short, place, 1.0) for place in layout.stations.values()) < LEAST_TALL


def _tall(camera: cameras.Camera, place: Station, aspect: float) -> float:
    """The share of the picture's height from a robot's wheels to its folded arm."""
    foot, top = (cameras.in_picture(camera, (place.x, place.y, z), aspect)[1] for z in (0.0, 1.3))
    return (top - foot) / 2


@every_layout
def test_cameras_do_not_look_through_a_ceiling(name: str) -> None:
    layout = layouts.load(name)
    for camera in cameras.fixed_cameras(layout):
        assert not layout.room.ceiling or camera.position[2] < layout.room.height, camera.name


@every_layout
def test_side_cameras_see_their_slots_from_free_space(name: str) -> None:
    layout = layouts.load(name)
    for slot in layout.slots.values():
        camera = cameras.side_camera(layout, slot.station)
        assert np.abs(cameras.in_picture(camera, layout.middle(slot.name), 1.0)).max() < 0.95, slot.name
        assert layout.room.x[0] < camera.position[0] < layout.room.x[1]
        for fixture in layout.fixtures.values():
            assert not any(block.holds(camera.position) for block in world_blocks(layout, fixture)), fixture.name


def test_what_is_behind_a_camera_is_not_in_its_picture() -> None:
    camera = cameras.front_camera(layouts.load("galley"))
    x, y, z = camera.position
    assert cameras.in_picture(camera, (x, y - 1.0, z), 1.0) == (np.inf, np.inf)


def test_unknown_station_lists_the_stations() -> None:
    with pytest.raises(UnknownNameError, match="cellar.*sink"):
        cameras.side_camera(layouts.load("galley"), "cellar")


@pytest.fixture(
    scope="module",
    params=[
        "one_wall_large", "u_shaped_small",
        *(pytest.param(name, marks=pytest.mark.long) for name in ("g_shaped_small", "l_shaped_large")),
    ],
)
def layout(request) -> layouts.Layout:
    """A layout; in one of them the cabinet opens to the right, in one in the middle."""
    side = {"u_shaped_small": "right", "l_shaped_large": "both"}.get(request.param, "left")
    made = (layouts.load(request.param, FrozenMap({"cabinet": make})) for make in fixture_models.names("cabinet"))
    return next(one for one in made if one.fixtures["cabinet"].opens_to == side)


@pytest.fixture(scope="module")
def kitchen(layout) -> tuple[mujoco.MjModel, mujoco.MjData]:
    from remac_env.kitchen.builder import build_spec

    spec = build_spec(layout, robots=["robot_0"], objects={"vegetable": "carrot"}, visual=True)
    cameras.add_cameras(spec, layout, ["robot_0"])
    model = spec.compile()
    data = mujoco.MjData(model)
    for fixture in layout.fixtures.values():
        for panel in fixture.door_panels:
            data.joint(panel.joint).qpos[0] = 1.45
    return model, data


def carrot_pixels(model: mujoco.MjModel, data: mujoco.MjData, camera: str) -> int:
    """Pixels in which the picture differs when the carrot is taken away."""
    picture = []
    with Renderer(model, 96, 96, backend="rays") as renderer:
        for away in (False, True):
            if away:
                data.joint("vegetable").qpos[:3] = (0, 0, -5)
            mujoco.mj_kinematics(model, data)
            mujoco.mj_camlight(model, data)
            picture.append(renderer.render(data, camera).astype(int))
    return int((np.abs(picture[0] - picture[1]).max(axis=2) > 25).sum())


@pytest.mark.few(6)
@pytest.mark.parametrize("fixture", ["cabinet", "microwave", "sink"])
def test_side_camera_sees_into_fixtures(layout, kitchen, fixture: str) -> None:
    model, data = kitchen
    slot = layout.slots[f"{fixture}.0"]
    data.joint("robot_0/base_y").qpos[0] = -30
    data.joint("vegetable").qpos[:3] = np.array(layout.middle(slot.name)) + [0, 0, 0.016]
    assert carrot_pixels(model, data, cameras.SIDE.format(station=slot.station)) > 20
    data.joint("vegetable").qpos[:3] = (0, 0, -5)
    assert carrot_pixels(model, data, cameras.SIDE.format(station=slot.station)) == 0


def test_wrist_camera_sees_what_the_hand_is_over(layout, kitchen) -> None:
    model, data = kitchen
    for number, angle in enumerate([0, 0.3, 0, -1.9, 0, 2.2, 0.785]):
        data.joint(f"robot_0/joint{number + 1}").qpos[0] = angle
    mujoco.mj_kinematics(model, data)
    grip = data.site("robot_0/grip")
    data.joint("vegetable").qpos[:3] = grip.xpos + 0.03 * grip.xmat.reshape(3, 3)[:, 2]
    assert carrot_pixels(model, data, cameras.WRIST.format(robot="robot_0")) > 100
