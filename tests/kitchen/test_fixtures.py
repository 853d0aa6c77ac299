"""The fixtures as MuJoCo models: joints, colliders where the facts say, reading of state; drawing changes nothing."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from remac_env.errors import KitchenFileError
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.builder import build_model, build_spec, show_switches
from remac_env.kitchen.canvas import COLLIDER_GROUP, DRAWN_GROUPS, SWITCHED
from remac_env.kitchen.fixtures import KINDS, FixtureReading, models
from remac_env.kitchen.fixtures.door import OPENED, WIDEST
from remac_env.kitchen.fixtures.microwave import BUTTON_TRAVEL
from remac_env.kitchen.fixtures.room import around
from remac_env.kitchen.fixtures.table import Table
from remac_env.kitchen.pieces import bar
from remac_env.state import FrozenMap

LAYOUT = layouts.load("one_wall_large")


@pytest.fixture(scope="module")
def bare() -> mujoco.MjModel:
    return build_model(LAYOUT, robots=(), objects={})


@pytest.fixture(scope="module")
def dressed() -> mujoco.MjModel:
    return build_model(LAYOUT, robots=(), objects={}, visual=True)


def joints(model: mujoco.MjModel) -> list[str]:
    return [model.joint(index).name for index in range(model.njnt)]


def test_joints_and_sites_by_name(bare: mujoco.MjModel) -> None:
    knobs = [f"stove/knob_{index}" for index in range(4)]
    assert joints(bare) == ["cabinet/door", *knobs, "faucet/lever", "microwave/door", "microwave/button"]
    sites = {bare.site(index).name for index in range(bare.nsite)}
    assert sites == {"cabinet/handle", "microwave/handle", "faucet/handle", "microwave/button", *knobs}


def test_the_setting_of_the_physics(bare: mujoco.MjModel) -> None:
    option = bare.opt
    assert option.timestep == 0.005 and option.impratio == 10
    assert option.cone == mujoco.mjtCone.mjCONE_ELLIPTIC and option.ls_iterations >= 20
    assert option.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    assert option.enableflags & mujoco.mjtEnableBit.mjENBL_SLEEP


@pytest.mark.parametrize(
    ("joint", "damping", "friction", "armature", "limits"),
    [
        ("cabinet/door", 0.4, 0.6, 0.05, (0, WIDEST)),
        ("microwave/door", 0.4, 0.6, 0.05, (0, WIDEST)),
        ("stove/knob_3", 0.05, 0.08, 0.002, (-0.05, 1.8)),
        ("faucet/lever", 0.3, 0.3, 0.01, (0, 1.0)),
    ],
)
def test_joints_are_as_measured(
    bare: mujoco.MjModel, joint: str, damping: float, friction: float, armature: float, limits: tuple[float, float]
) -> None:
    at = bare.joint(joint).dofadr[0]
    assert bare.dof_damping[at] == damping
    assert bare.dof_frictionloss[at] == friction
    assert bare.dof_armature[at] == armature
    assert tuple(bare.joint(joint).range) == limits


def test_visual_geometry_changes_nothing_but_pictures(bare: mujoco.MjModel, dressed: mujoco.MjModel) -> None:
    assert joints(bare) == joints(dressed)
    assert [bare.body(i).name for i in range(bare.nbody)] == [dressed.body(i).name for i in range(dressed.nbody)]
    moving = bare.body_dofnum > 0
    for field in ("body_pos", "body_mass", "body_inertia", "body_ipos"):
        assert np.allclose(getattr(bare, field)[moving], getattr(dressed, field)[moving]), field
    drawn = np.isin(dressed.geom_group, DRAWN_GROUPS)
    assert drawn.sum() > 50
    assert not dressed.geom_contype[drawn].any() and not dressed.geom_conaffinity[drawn].any()
    assert (dressed.geom_matid[drawn] >= 0).all()
    assert (~drawn).sum() == bare.ngeom
    assert set(bare.geom_group) == {COLLIDER_GROUP}


def test_robots_and_objects_keep_their_order() -> None:
    robots, objects = ("robot_0", "robot_1"), {"vegetable": "carrot", "bowl": "bowl"}
    models = [build_model(LAYOUT, robots=robots, objects=objects, visual=visual) for visual in (False, True)]
    assert joints(models[0]) == joints(models[1])
    assert {"vegetable", "bowl", "robot_0/base_x", "robot_1/base_x"} <= set(joints(models[0]))
    assert models[0].nq == models[1].nq and models[0].nu == models[1].nu


def test_visual_geometry_moves_alike(bare: mujoco.MjModel, dressed: mujoco.MjModel) -> None:
    ends = []
    for model in (bare, dressed):
        data = mujoco.MjData(model)
        data.qvel[:] = 0.8
        for _ in range(100):
            mujoco.mj_step(model, data)
        ends.append(data.qpos.copy())
    assert np.allclose(ends[0], ends[1], atol=1e-9)
    assert ends[0][0] > 0.01


def test_colliders_meet_objects_and_robots_and_leaves_meet_furniture_too(bare: mujoco.MjModel) -> None:
    panels = np.array([bare.body(body).name.endswith("/door") for body in bare.geom_bodyid])
    floor = bare.geom_bodyid == bare.body("room/floor").id
    assert set(bare.geom_contype[~floor]) == {1} and set(bare.geom_contype[floor]) == {3} and panels.any()
    assert set(bare.geom_conaffinity[panels]) == {1} and set(bare.geom_conaffinity[~panels]) == {0}
    bar_geom = bare.geom("microwave/handle")
    assert bar_geom.size[0] == pytest.approx(0.009)


@pytest.mark.parametrize("slot", LAYOUT.slots)
def test_a_thing_rests_on_every_slot(slot: str) -> None:
    """A cube dropped in the middle of a slot, and near its edge, comes to rest at the height that the facts give."""
    facts = LAYOUT.slots[slot]
    frame = LAYOUT.frame(facts.fixture)
    spec = build_spec(LAYOUT, robots=(), objects={})
    side = 0.02
    places = [(0.0, 0.0), (facts.half[0] - 0.035, 0.0)]
    for index, (x, y) in enumerate(places):
        position = frame.space((facts.center[0] + x, facts.center[1] + y, facts.center[2] + side + 0.01))
        cube = spec.worldbody.add_body(name=f"cube_{index}", pos=position)
        cube.add_freejoint(name=f"cube_{index}")
        cube.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[side] * 3, contype=2, conaffinity=3, mass=0.1)
    model = spec.compile()
    data = mujoco.MjData(model)
    for _ in range(100):
        mujoco.mj_step(model, data)
    for index, (x, y) in enumerate(places):
        expected = frame.space((facts.center[0] + x, facts.center[1] + y, facts.center[2] + side))
        assert np.allclose(data.body(f"cube_{index}").xpos, expected, atol=0.004)


@pytest.mark.parametrize("name", ["cabinet", "microwave"])
def test_doors_open_towards_the_robot(bare: mujoco.MjModel, name: str) -> None:
    fixture = LAYOUT.fixtures[name]
    data = mujoco.MjData(bare)
    mujoco.mj_forward(bare, data)
    closed = data.site(f"{name}/handle").xpos.copy()
    assert fixture.read(bare, data).door_angles == (0.0,)
    data.joint(f"{name}/door").qpos[0] = OPENED
    mujoco.mj_forward(bare, data)
    opened = data.site(f"{name}/handle").xpos
    assert opened[1] < closed[1] - 0.25, "the handle comes towards the robot"
    assert opened[0] < closed[0] - 0.25, "hinged on the left"
    assert np.isclose(opened[2], closed[2])
    swept = np.array(fixture.swept_points)
    assert np.linalg.norm(swept[:, :2] - opened[:2], axis=1).min() < 0.01, "the facts know where the handle goes"
    assert fixture.read(bare, data).door_angles == (OPENED,)


DOUBLE = [variant for variant in models.names("cabinet") if variant.startswith("double")]


def double(variant: str) -> layouts.Layout:
    return layouts.load("one_wall_large", FrozenMap({"cabinet": variant}))


@pytest.mark.parametrize("variant", DOUBLE)
def test_two_door_panels_meet_in_the_middle_and_open_to_both_sides(variant: str) -> None:
    layout = double(variant)
    cabinet = layout.fixtures["cabinet"]
    left, right = cabinet.door_panels
    assert cabinet.opens_to == "both" and (left.side, right.side) == ("left", "right")
    assert left.hinge + left.width == pytest.approx(right.hinge - right.width), "no gap and no overlap"
    model = build_model(layout, robots=(), objects={})
    data = mujoco.MjData(model)
    assert joints(model)[:2] == ["cabinet/left_door", "cabinet/right_door"]
    mujoco.mj_forward(model, data)
    handles = [data.site(panel.grip).xpos.copy() for panel in (left, right)]
    assert 0.05 < handles[1][0] - handles[0][0] < 0.15
    for joint, value in cabinet.joints(OPENED, frozenset()).items():
        data.joint(joint).qpos[0] = value
    mujoco.mj_forward(model, data)
    opened = [data.site(panel.grip).xpos for panel in (left, right)]
    assert opened[0][0] < handles[0][0] - 0.15 and opened[1][0] > handles[1][0] + 0.15
    swept = np.array(cabinet.swept_points)
    for place in opened:
        assert np.linalg.norm(swept[:, :2] - place[:2], axis=1).min() < 0.01


@pytest.mark.parametrize(
    ("angles", "state"),
    [
        ((0.0, 0.0), "closed"),
        ((0.05, 0.0), "closed"),
        ((0.051, 0.0), "ajar"),
        ((0.0, 1.45), "ajar"),
        ((0.89, 1.45), "ajar"),
        ((0.90, 0.95), "open"),
        ((0.4,), "ajar"),
        ((), None),
    ],
)
def test_a_door_is_what_all_its_leaves_are(angles: tuple[float, ...], state: str | None) -> None:
    assert FixtureReading(door_angles=angles).door == state


def test_reading_tells_the_leaves_apart() -> None:
    layout = double("double_bar")
    model = build_model(layout, robots=(), objects={})
    data = mujoco.MjData(model)
    data.joint("cabinet/right_door").qpos[0] = 1.2
    reading = layout.fixtures["cabinet"].read(model, data)
    assert reading.door_angles == (0.0, 1.2) and reading.door == "ajar"


def test_an_unknown_hinge_is_refused() -> None:
    measures = Table({"hinge": "top", "handle": "bar"}, file="models.toml", where="cabinet.flap")
    place = Table({"x": [0.0, 0.45], "z": [1.35, 1.95], "station": "cabinet"}, file="odd.toml")
    with pytest.raises(KitchenFileError, match=r"cabinet\.flap\.hinge.*left, right, both"):
        KINDS["cabinet"].parse("cabinet", place, measures)


def test_a_door_stays_where_it_is_left(bare: mujoco.MjModel) -> None:
    data = mujoco.MjData(bare)
    data.joint("cabinet/door").qpos[0] = 1.3
    for _ in range(400):
        mujoco.mj_step(bare, data)
    assert data.joint("cabinet/door").qpos[0] == pytest.approx(1.3, abs=1e-3)


def test_each_knob_lights_its_own_burner(bare: mujoco.MjModel) -> None:
    stove = LAYOUT.fixtures["stove"]
    for index in range(4):
        data = mujoco.MjData(bare)
        assert stove.read(bare, data).on == frozenset()
        data.joint(f"stove/knob_{index}").qpos[0] = 0.34
        assert stove.read(bare, data).on == frozenset()
        data.joint(f"stove/knob_{index}").qpos[0] = 0.36
        assert stove.read(bare, data).on == {f"stove.{index}"}
        mujoco.mj_forward(bare, data)
        burner = LAYOUT.slots[f"stove.{index}"].center
        assert data.site(f"stove/knob_{index}").xpos[1] < burner[1]


def test_the_lever_is_lifted_to_let_water_run(bare: mujoco.MjModel) -> None:
    faucet = LAYOUT.fixtures["faucet"]
    data = mujoco.MjData(bare)
    mujoco.mj_forward(bare, data)
    low = data.site("faucet/handle").xpos.copy()
    assert faucet.read(bare, data).on == frozenset()
    data.joint("faucet/lever").qpos[0] = 0.5
    mujoco.mj_forward(bare, data)
    assert data.site("faucet/handle").xpos[2] > low[2] + 0.04
    assert faucet.read(bare, data).on == {"faucet"}
    assert low[0] > LAYOUT.fixtures["sink"].slots[0].center[0], "right of the spout"


def test_the_button_gives_way_and_comes_back(bare: mujoco.MjModel) -> None:
    microwave = LAYOUT.fixtures["microwave"]
    data = mujoco.MjData(bare)
    force = data.joint("microwave/button").qfrc_applied
    force[0] = 1.0
    for _ in range(100):
        mujoco.mj_step(bare, data)
    assert not microwave.read(bare, data).pressed, "a light touch is no press"
    force[0] = 5.0
    for _ in range(100):
        mujoco.mj_step(bare, data)
    assert microwave.read(bare, data).pressed == {"microwave"}
    assert data.joint("microwave/button").qpos[0] == pytest.approx(BUTTON_TRAVEL, abs=0.001)
    force[0] = 0.0
    for _ in range(200):
        mujoco.mj_step(bare, data)
    reading = microwave.read(bare, data)
    assert not reading.pressed and not reading.on
    assert abs(data.joint("microwave/button").qpos[0]) < 5e-4


def test_switches_show(dressed: mujoco.MjModel) -> None:
    def visible() -> set[str]:
        names = (dressed.geom(index).name for index in range(dressed.ngeom))
        return {name.split(SWITCHED)[0] for name in names if SWITCHED in name and dressed.geom(name).rgba[3] > 0}

    assert visible() == set()
    every = frozenset(switch for fixture in LAYOUT.fixtures.values() for switch in fixture.switches)
    show_switches(dressed, every)
    assert visible() == every, "each switch has something to see"
    show_switches(dressed, frozenset({"faucet"}))
    assert visible() == {"faucet"}
    show_switches(dressed, frozenset())
    assert visible() == set()


def test_walls_leave_windows_free() -> None:
    pieces = around((-1.0, 1.0), (0.0, 2.0), [((-0.2, 0.3), (0.5, 1.0))])
    area = sum((x[1] - x[0]) * (z[1] - z[0]) for x, z in pieces)
    assert area == pytest.approx(2.0 * 2.0 - 0.5 * 0.5)
    assert not any(x[0] < 0.0 < x[1] and z[0] < 0.7 < z[1] for x, z in pieces)
    assert around((-1.0, 1.0), (0.0, 2.0), [((3.0, 4.0), (0.5, 1.0))]) == [((-1.0, 1.0), (0.0, 2.0))]


@pytest.mark.parametrize("round_ends", [True, False])
def test_bars_are_closed_and_face_outwards(round_ends: bool) -> None:
    start, end, radius = (0.1, 0.2, 0.3), (0.1, 0.5, 0.7), 0.02
    mesh = bar(start, end, radius, round_ends)
    corners = mesh.vertices[mesh.faces]
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    solid = np.pi * radius**2 * 0.5 + (4 / 3 * np.pi * radius**3 if round_ends else 0.0)
    assert volume == pytest.approx(solid, rel=0.05)
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert mesh.normals is not None
    assert (np.einsum("ij,ij->i", facing, mesh.normals[mesh.faces].mean(axis=1)) > 0).all()
    with pytest.raises(ValueError, match="length"):
        bar(start, start, radius, round_ends)
