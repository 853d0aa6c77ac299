"""What observation images leave out is not missed; what is on is seen to be on."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np
import pytest
from quirk_sheet import load, task_of

import remac_env
from remac_env.kitchen.canvas import COARSE_GROUP, FINE_GROUP
from remac_env.rendering import gl, renderer
from remac_env.rendering.cameras import FRONT, SIDE, WRIST
from remac_env.rendering.renderer import CLOSE, OBSERVATION, Renderer
from remac_env.rendering.sight import out_of_view
from remac_env.rendering.stage import SMALL, Stage

SIZE = 96


@pytest.fixture(scope="module")
def env() -> Iterator[remac_env.KitchenParallelEnv]:
    made = remac_env.parallel_env(
        "HeatOnStove", robots=2, backend="symbolic", obs="state+images", image_size=SIZE, layout="one_wall_large"
    )
    made.reset(seed=3)
    yield made
    made.close()


@pytest.fixture
def stage(env: remac_env.KitchenParallelEnv) -> Stage:
    made = env._pictures._stage(env._moment())
    made.show_world(env.start, env.world)
    return made


def side(env: remac_env.KitchenParallelEnv, fixture: str) -> str:
    return SIDE.format(station=env.start.scene.fixtures[fixture].station)


def differs(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The pixels in which two pictures clearly differ, (height, width)."""
    return np.abs(one.astype(int) - other.astype(int)).max(axis=2) > 40


@pytest.mark.parametrize("fixture", ["faucet", "stove", "microwave"])
def test_what_is_on_is_seen_to_be_on(env: remac_env.KitchenParallelEnv, stage: Stage, fixture: str) -> None:
    switch = env.start.scene.fixtures[fixture].switches[0]
    views = {name: side(env, name) for name in ("faucet", "stove", "microwave")}
    off = {name: stage._render(camera, (SIZE, SIZE), OBSERVATION) for name, camera in views.items()}
    stage.show_world(env.start, env.world.with_fixture(fixture, on=frozenset([switch])))
    for name, camera in views.items():
        changed = differs(stage._render(camera, (SIZE, SIZE), OBSERVATION), off[name])
        if name == fixture:
            # A hundredth of the picture, or, where it is drawn by rays, which show little of what is clear as water, a
            # two-hundredth; and what is drawn there is in one place, not all over the picture.
            by_rays = any(renderer.backend == "rays" for renderer in stage._renderers.values())
            assert changed.sum() > (0.005 if by_rays else 0.01) * SIZE**2
            assert not changed.all(axis=0).any() and not changed.all(axis=1).any()
        else:
            assert not changed.any(), name


def test_every_switch_of_a_rich_kitchen_is_seen_to_be_on_from_its_station() -> None:
    rich = task_of("dead switch", load()["dead switch"], quirky=False)
    env = remac_env.parallel_env(rich, robots=1, backend="symbolic")
    env.reset(seed=1)
    stage = env._pictures._stage(env._moment())
    owners = [name for name, fixture in env.start.scene.fixtures.items() if fixture.switches]
    assert len(owners) > 3
    for name in owners:
        pictures = []
        for on in ((), env.start.scene.fixtures[name].switches[:1]):
            stage.show_world(env.start, env.world.with_fixture(name, on=frozenset(on)))
            pictures.append(stage._render(side(env, name), (SIZE, SIZE), OBSERVATION))
        assert differs(*pictures).sum() > 0.005 * SIZE**2, name
    env.close()


def test_what_was_seasoned_shows_grains(env: remac_env.KitchenParallelEnv, stage: Stage) -> None:
    place = env.world.objects["vegetable"].place
    camera = SIDE.format(station=env.start.scene.slots[place.where].station)
    bare = stage._render(camera, (128, 128), OBSERVATION)
    stage.show_world(env.start, env.world.with_object("vegetable", marks=frozenset({"washed"})))
    assert not differs(stage._render(camera, (128, 128), OBSERVATION), bare).any()
    stage.show_world(env.start, env.world.with_object("vegetable", marks=frozenset({"seasoned"})))
    seasoned = differs(stage._render(camera, (128, 128), OBSERVATION), bare)
    assert seasoned.sum() >= 4
    stage.show_world(env.start, env.world)
    assert not differs(stage._render(camera, (128, 128), OBSERVATION), bare).any()


def test_robots_share_the_view_of_the_whole_kitchen(
    env: remac_env.KitchenParallelEnv, stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[str | int] = []
    render = Renderer.render

    def counted(self: Renderer, data: mujoco.MjData, camera: str | int) -> np.ndarray:
        drawn.append(camera)
        return render(self, data, camera)

    monkeypatch.setattr(Renderer, "render", counted)
    seen = {robot: stage.observe(robot, env.world, size=SIZE) for robot in ("robot_0", "robot_1")}
    assert sorted(map(str, drawn)) == sorted([FRONT, *(WRIST.format(robot=robot) for robot in seen)])
    assert (seen["robot_0"]["front"] == seen["robot_1"]["front"]).all()
    assert not np.shares_memory(seen["robot_0"]["front"], seen["robot_1"]["front"])
    stage.show_world(env.start, env.world.with_robot("robot_0", station="sink"))
    moved = stage.observe("robot_1", env.world, size=SIZE)
    assert differs(moved["front"], seen["robot_1"]["front"]).any()


def triangles(model: mujoco.MjModel, group: int) -> int:
    return sum(int(model.mesh_facenum[model.geom_dataid[geom]]) for geom in np.flatnonzero(model.geom_group == group))


def test_small_pictures_have_few_triangles_and_look_alike(env: remac_env.KitchenParallelEnv, stage: Stage) -> None:
    model, camera = stage._model, side(env, "microwave")
    assert triangles(model, COARSE_GROUP) < triangles(model, FINE_GROUP) / 3
    fine, coarse = (stage._render(camera, (SIZE, SIZE), quality) for quality in (CLOSE, OBSERVATION))
    assert differs(fine, coarse).mean() < 0.04
    twins = model.geom_group == COARSE_GROUP
    model.geom_group[twins] = FINE_GROUP  # now nothing but sheets and objects is left for small pictures
    stage._drawn.clear()
    try:
        assert differs(fine, stage._render(camera, (SIZE, SIZE), OBSERVATION)).mean() > 0.15
    finally:
        model.geom_group[twins] = COARSE_GROUP
        stage._drawn.clear()


def test_large_observation_images_are_drawn_fine(
    env: remac_env.KitchenParallelEnv, stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []
    monkeypatch.setattr(Stage, "_render", lambda self, camera, size, quality: asked.append((size[0], quality)))
    for size in (SMALL, 2 * SMALL):
        stage.observe("robot_0", env.world, size=size)
    assert set(asked) == {(SMALL, OBSERVATION), (2 * SMALL, CLOSE)}


SCENE = """
<mujoco><worldbody>
  <geom name="ahead" size=".2" pos="0 0 0"/>
  <geom name="edge" size=".2" pos="1.65 0 0"/>
  <geom name="beside" size=".2" pos="2.1 0 0"/>
  <geom name="above" size=".2" pos="0 0 1.2"/>
  <geom name="behind" size=".2" pos="0 -4 0"/>
  <geom name="floor" type="plane" size="0 0 1" pos="0 -50 -50"/>
  <camera name="eye" pos="0 -3 0" xyaxes="1 0 0 0 0 1" fovy="30"/>
</worldbody></mujoco>
"""


def test_only_what_is_wholly_out_of_view_is_left_out() -> None:
    model = mujoco.MjModel.from_xml_string(SCENE)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    hidden = out_of_view(model, data, model.camera("eye").id, 2.0)
    assert {model.geom(int(geom)).name for geom in np.flatnonzero(hidden)} == {"beside", "above", "behind"}
    assert model.geom("edge").id not in np.flatnonzero(out_of_view(model, data, 0, 2.0))
    assert out_of_view(model, data, 0, 1.0)[model.geom("edge").id]


def test_leaving_out_changes_no_pixel(stage: Stage, monkeypatch: pytest.MonkeyPatch) -> None:
    if gl.probe() is None:
        pytest.skip("no OpenGL platform works here")
    shots = (FRONT, "robot_0/wrist", "side/sink")
    culled = [stage._render(camera, (SIZE, SIZE), OBSERVATION) for camera in shots]
    for everything, alike in ((False, True), (True, False)):
        stage._drawn.clear()
        monkeypatch.setattr(renderer, "out_of_view", lambda model, *_, all=everything: np.full(model.ngeom, all))
        whole = [stage._render(camera, (SIZE, SIZE), OBSERVATION) for camera in shots]
        assert all((one == other).all() for one, other in zip(culled, whole, strict=True)) == alike
    stage._drawn.clear()
