"""What hands hold is seen whole, wrists look upright, overviews show little floor, microwaves what is in them."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np
import pytest

import remac_env
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.builder import build_spec
from remac_env.rendering import cameras
from remac_env.rendering.following import follow
from remac_env.rendering.rays import RayPainter
from remac_env.rendering.renderer import OBSERVATION
from remac_env.rendering.stage import Stage
from remac_env.robots.panda import measures as panda
from remac_env.state import Place

SIZE = 128
LEAST = 24  # pixels of a picture of 128 by 128, about 400 of one of 512
MOST_FLOOR = 0.36  # of a picture

Kitchen = tuple["remac_env.KitchenParallelEnv", Stage]


@pytest.fixture(scope="module")
def kitchen() -> Iterator[Kitchen]:
    env = remac_env.parallel_env("DefrostInBowl", robots=1, backend="symbolic", layout="u_shaped_small")
    env.reset(seed=3)
    stage = Stage(env.start, env.worlds.layout("u_shaped_small", env.start.style), env.worlds.categories)
    yield env, stage
    stage.close()
    env.close()


def shown(model: mujoco.MjModel, data: mujoco.MjData, camera: str, size: int = SIZE) -> np.ndarray:
    """The geom in each pixel, -1 for none, (size, size)."""
    painter = RayPainter(model, size, size, groups=OBSERVATION.groups)
    hidden = painter._geom_colors()[0][:, 3] < 1
    return painter._cast(data, *painter._rays(data, model.camera(camera).id), hidden)[0].reshape(size, size)


def seen_whole(stage: Stage, camera: str, noun: str) -> bool:
    """Whether an object is large enough in a camera's picture and nowhere at its edge."""
    model = stage._model
    geoms = shown(model, stage._data, camera)
    mask = (model.geom_bodyid[geoms] == model.body(noun).id) & (geoms >= 0)
    edge = mask[[0, -1]].any() or mask[:, [0, -1]].any()
    return bool(mask.sum() >= LEAST and not edge)


def holding(kitchen: Kitchen, noun: str, station: str, *, door: str = "closed") -> None:
    env, stage = kitchen
    world = env.world.with_robot("robot_0", station=station, holding=noun)
    world = world.with_object(noun, place=Place("held", "robot_0"))
    if station in env.start.scene.fixtures and env.start.scene.fixtures[station].door:
        world = world.with_fixture(station, door=door)
    stage.show_world(env.start, world)


STATIONS = ("counter_left", "counter_back_right", "sink", "stove", "cabinet", "microwave", "aside")


@pytest.mark.few(3)
@pytest.mark.parametrize("noun", ["bowl", "fish"])
@pytest.mark.parametrize("station", STATIONS)
def test_what_a_hand_holds_is_seen_whole(kitchen: Kitchen, noun: str, station: str) -> None:
    holding(kitchen, noun, station)
    stage = kitchen[1]
    assert seen_whole(stage, cameras.HELD.format(robot="robot_0"), noun)
    bad = cameras.FRONT if station == "aside" else cameras.SIDE.format(station=station)
    assert not seen_whole(stage, bad, noun)


def test_an_open_door_is_looked_into_past_what_is_held(kitchen: Kitchen) -> None:
    env, stage = kitchen
    holding(kitchen, "fish", "microwave", door="open")
    picture = shown(stage._model, stage._data, cameras.HELD.format(robot="robot_0"))
    assert seen_whole(stage, cameras.HELD.format(robot="robot_0"), "fish")
    casing = stage._model.body("microwave/casing").id
    materials = stage._model.mat("cavity").id
    inside = (stage._model.geom_bodyid[picture] == casing) & (stage._model.geom_matid[picture] == materials)
    assert inside.sum() >= LEAST


@pytest.mark.parametrize("station", ["sink", "aside"])
def test_the_pictures_of_a_station_are_the_same_whatever_a_robot_holds(kitchen: Kitchen, station: str) -> None:
    env, stage = kitchen
    holding(kitchen, "fish", station)
    full = env.world.with_robot("robot_0", station=station, holding="fish")
    seen = stage.observe("robot_0", full, size=32, cameras=("station", "side"))
    assert set(seen) == {"station", "side"} and (seen["station"] != seen["side"]).any()
    camera = cameras.ROOM if station == "aside" else cameras.SIDE.format(station=station)
    assert (stage._render(camera, (32, 32), OBSERVATION) == seen["station"]).all()


def test_side_shows_what_is_held_and_equal_states_look_equal(kitchen: Kitchen) -> None:
    env, stage = kitchen
    pictures = []
    for _ in range(2):
        holding(kitchen, "fish", "sink")
        world = env.world.with_robot("robot_0", station="sink", holding="fish")
        pictures.append(stage.observe("robot_0", world, size=32)["side"])
    assert (pictures[0] == pictures[1]).all()
    stage._drawn.clear()
    assert (stage._render(cameras.HELD.format(robot="robot_0"), (32, 32), OBSERVATION) == pictures[0]).all()


@pytest.mark.parametrize("wrist", np.linspace(-2.8, 2.8, 9))
@pytest.mark.parametrize("bend", [0.6, 1.9, 3.1])
def test_wrist_pictures_are_upright(kitchen: Kitchen, wrist: float, bend: float) -> None:
    env, stage = kitchen
    stage.show_world(env.start, env.world)
    data = stage._data
    data.joint("robot_0/joint6").qpos[0], data.joint("robot_0/joint7").qpos[0] = bend, wrist
    mujoco.mj_kinematics(stage._model, data)
    mujoco.mj_camlight(stage._model, data)
    fixed = data.camera("robot_0/wrist").xmat.reshape(3, 3).copy()
    follow(stage._model, data, stage._layout, env.world)
    turn = data.camera("robot_0/wrist").xmat.reshape(3, 3)
    assert abs(turn[2, 0]) < 1e-9 or abs(turn[2, 2]) > 0.97  # the horizon is level
    assert turn[2, 1] >= 0.0 or abs(turn[2, 2]) > 0.97
    assert np.linalg.det(turn) == pytest.approx(1.0)
    if abs(wrist) > 2.5 and bend < 3:
        assert fixed[2, 1] != pytest.approx(turn[2, 1])  # a camera that turns with the hand is another


@pytest.mark.few(1)
@pytest.mark.parametrize("name", layouts.names())
def test_little_of_the_front_picture_is_floor(name: str) -> None:
    layout = layouts.load(name)
    robots = ["robot_0", "robot_1"]
    spec = build_spec(layout, robots=robots, objects={}, visual=True)
    cameras.add_cameras(spec, layout, robots)
    spec.worldbody.add_camera(name="down", pos=[0.0, -2.0, 6.0], fovy=46.0)
    model = spec.compile()
    data = mujoco.MjData(model)
    for robot, place in zip(robots, layout.asides, strict=False):
        for joint, value in zip(panda.JOINTS, panda.tucked(place.x, place.y, place.yaw), strict=True):
            data.joint(f"{robot}/{joint}").qpos[0] = value
    mujoco.mj_forward(model, data)

    def share(camera: str) -> float:
        geoms = shown(model, data, camera, 64)
        return float(((model.geom_matid[geoms] == model.mat("floor").id) & (geoms >= 0)).mean())

    assert share(cameras.FRONT) < MOST_FLOOR < share("down")


@pytest.mark.few(1)
@pytest.mark.parametrize("style", ["modern_1", "coastal", "farmhouse"])
@pytest.mark.parametrize("on", [False, True])
def test_a_shut_microwave_shows_what_is_in_it(style: str, on: bool) -> None:
    env = remac_env.parallel_env("OpenMicrowavePnP", robots=1, backend="symbolic", layout="galley", style=style)
    env.reset(seed=2)
    stage = Stage(env.start, env.worlds.layout("galley", style), env.worlds.categories)
    slot = env.start.scene.fixtures["microwave"].slots[0]
    full = env.world.with_robot("robot_0", station="microwave").with_object("vegetable", place=Place("slot", slot))
    full = full.with_fixture("microwave", door="closed", on=frozenset(["microwave"] if on else []))
    empty = full.with_object("vegetable", place=Place("floor"))

    def changed() -> int:
        pictures = []
        for world in (full, empty):
            stage.show_world(env.start, world)
            pictures.append(stage.observe("robot_0", world, size=SIZE)["side"].astype(int))
        return int((np.abs(pictures[0] - pictures[1]).max(axis=2) > 25).sum())

    assert changed() >= LEAST
    panes = stage._model.geom_matid == stage._model.mat("glass").id
    stage._model.geom_rgba[panes, 3] = 1.0
    assert changed() < LEAST
    stage.close()
    env.close()
