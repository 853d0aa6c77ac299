"""Cameras of the built-in layout see what they are for. Skipped until the layout can be built."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from remac_env.errors import UnknownNameError
from remac_env.kitchen import layout as layouts
from remac_env.rendering import cameras
from remac_env.rendering.renderer import Renderer


@pytest.fixture(scope="module")
def layout() -> layouts.Layout:
    return layouts.load("one_wall_large")


def image_point(camera: cameras.Camera, point: tuple[float, float, float], aspect: float) -> np.ndarray:
    """Where a point lies in the picture: (x, y) in -1..1 when it is seen."""
    back = np.array(camera.position) - np.array(camera.target)
    back /= np.linalg.norm(back)
    right = np.cross((0, 0, 1), back)
    right /= np.linalg.norm(right)
    offset = np.array(point) - np.array(camera.position)
    half = np.tan(np.radians(camera.field) / 2)
    depth = -offset @ back
    assert depth > 0
    return np.array([offset @ right / (half * aspect), offset @ np.cross(back, right) / half]) / depth


def test_front_and_wide_cameras_frame_the_whole_width(layout) -> None:
    for camera, aspect in ((cameras.front_camera(layout), 1.0), (cameras.wide_camera(layout), 16 / 9)):
        for x in layout.room.x:
            for z in (0.0, 1.0, 2.2):
                assert np.abs(image_point(camera, (x, 0.0, z), aspect)).max() < 1.0
        for place in layout.asides:
            assert np.abs(image_point(camera, (place.x, place.y, 1.2), aspect)).max() < 1.0


def test_side_cameras_see_their_slots(layout) -> None:
    for slot in layout.slots.values():
        camera = cameras.side_camera(layout, slot.station)
        assert np.abs(image_point(camera, slot.center, 1.0)).max() < 0.95, slot.name
        assert layout.room.x[0] < camera.position[0] < layout.room.x[1]


def test_unknown_station_lists_the_stations(layout) -> None:
    with pytest.raises(UnknownNameError, match="cellar.*sink"):
        cameras.side_camera(layout, "cellar")


@pytest.fixture(scope="module")
def kitchen(layout) -> tuple[mujoco.MjModel, mujoco.MjData]:
    from remac_env.kitchen.builder import build_spec

    spec = build_spec(layout, robots=["robot_0"], objects={"vegetable": "carrot"}, looks=True)
    cameras.add_cameras(spec, layout, ["robot_0"])
    model = spec.compile()
    data = mujoco.MjData(model)
    for fixture in layout.fixtures.values():
        if fixture.door:
            data.joint(f"{fixture.name}/door").qpos[0] = 1.45
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


@pytest.mark.parametrize("fixture", ["cabinet", "microwave", "sink"])
def test_side_camera_sees_into_fixtures(layout, kitchen, fixture: str) -> None:
    model, data = kitchen
    slot = layout.slots[f"{fixture}.0"]
    data.joint("robot_0/base_y").qpos[0] = -3
    data.joint("vegetable").qpos[:3] = np.array(slot.center) + [0, 0, 0.016]
    assert carrot_pixels(model, data, cameras.SIDE.format(station=slot.station)) > 30
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
