"""Things: the catalogue is sound, they rest, are grasped as it says, fit into one another, and look like their body."""

from __future__ import annotations

import importlib.util
import itertools
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import get_args

import mujoco
import numpy as np
import pytest

from remac_env.errors import KitchenFileError, UnknownNameError
from remac_env.kitchen.objects import add_object, catalogue
from remac_env.kitchen.objects.drawn import part
from remac_env.kitchen.objects.shapes import names, shape

_spec = importlib.util.spec_from_file_location("grip", Path(__file__).with_name("grip.py"))
assert _spec is not None and _spec.loader is not None
grip = sys.modules["grip"] = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(grip)

CATEGORIES = catalogue.load()
FOOD = [name for name, category in CATEGORIES.items() if category.small]


def model_of(*things: tuple[str, str], visual: bool = False) -> mujoco.MjModel:
    """A table with objects (noun, category) on it, at the origin."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.timestep, spec.option.impratio, spec.option.ls_iterations = 0.005, 10, 50
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    table = mujoco.mjtGeom.mjGEOM_BOX
    spec.worldbody.add_geom(type=table, size=[1, 1, 0.1], pos=[0, 0, -0.1], contype=1, conaffinity=0)
    for noun, category in things:
        add_object(spec, spec.worldbody, noun, category, visual=visual)
    return spec.compile()


def test_facts_need_no_simulator() -> None:
    code = (
        "import sys; from remac_env.kitchen.objects import catalogue, shapes; catalogue.load(); shapes.shape('fish');"
        "raise SystemExit('mujoco' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


CHAINS = [name for name, category in CATEGORIES.items() if category.body.form == "chain"]


@pytest.mark.parametrize("category", CHAINS)
def test_fingers_close_on_the_thickest_part(category: str) -> None:
    """Where it tapers it creeps out of the hand: pears gripped 8 mm beside their belly slipped."""
    body = CATEGORIES[category].body
    links = list(zip(itertools.pairwise(body["points"]), body["radii"], strict=True))
    thickest = [link for link, radius in links if radius == max(body["radii"])]
    assert any(min(a[0], b[0]) - 0.003 <= 0.0 <= max(a[0], b[0]) + 0.003 for a, b in thickest)


def test_every_commanded_noun_has_a_category() -> None:
    import remac_env

    nouns = tomllib.loads((Path(remac_env.__file__).parent / "nouns.toml").read_text(encoding="utf-8"))["noun"]
    for noun in nouns:
        if noun["kind"] == "object":
            assert catalogue.for_role(noun["name"]), noun["name"]


def test_hidden_constraints_are_facts() -> None:
    needs = {name: set(category.needs_vessel_in) for name, category in CATEGORIES.items()}
    raw = [name for name, category in CATEGORIES.items() if category.group in ("fish", "meat")]
    assert {"fish", "steak"} < set(raw) and all(needs[name] == {"sink"} for name in raw)
    assert all(needs[name] == {"stove"} for name in catalogue.for_role("vegetable"))
    assert CATEGORIES["bowl"].vessel_in == {"sink"} and CATEGORIES["pan"].vessel_in == {"stove"}
    assert CATEGORIES["plate"].vessel_in == {"cabinet", "microwave"}
    assert {name for name, category in CATEGORIES.items() if category.vessel} == {"plate", "bowl", "pan"}
    assert [name for name, category in CATEGORIES.items() if category.seasons] == ["seasoning"]


@pytest.mark.parametrize("name", CATEGORIES)
def test_rests_where_the_catalogue_says_is_grasped_and_held(name: str) -> None:
    category = CATEGORIES[name]
    trial = grip.grasp_and_shake(category)
    assert trial.rest[:2] == pytest.approx([0, 0], abs=1e-3)
    assert trial.rest[2] == pytest.approx(category.rest_height, abs=1e-3)
    assert trial.speed < 0.01
    # What hangs from its rim or handle droops in fingers that grip no better than rubber does.
    share = 0.9 if category.grasp.mode == "side" else 0.5
    assert trial.risen > share * grip.LIFT


@pytest.mark.parametrize("name", ["potato", "plate", "pan"])
def test_a_grasp_that_misses_lifts_nothing(name: str) -> None:
    category = CATEGORIES[name]
    wrong = replace(category.grasp, height=category.grasp.height + 0.10)
    assert grip.grasp_and_shake(category, grasp=wrong).risen < 0.02


@pytest.mark.parametrize("vessel", ["plate", "bowl", "pan"])
@pytest.mark.parametrize("name", FOOD)
def test_food_comes_to_rest_inside_a_vessel(vessel: str, name: str) -> None:
    food, dish = CATEGORIES[name], CATEGORIES[vessel]
    model = model_of(("dish", vessel), ("food", name))
    data = mujoco.MjData(model)
    data.joint("food").qpos[2] = food.height_inside(dish) + 0.01
    for _ in range(300):
        mujoco.mj_step(model, data)
    at = data.body("food").xpos - data.body("dish").xpos
    assert np.hypot(*at[:2]) < 0.02
    assert at[2] == pytest.approx(food.height_inside(dish), abs=0.004)
    assert np.abs(data.qvel).max() < 0.05


@pytest.mark.parametrize("name", CATEGORIES)
def test_nothing_sinks_into_the_table_when_it_has_toppled(name: str) -> None:
    model = model_of(("thing", name))
    data = mujoco.MjData(model)
    data.joint("thing").qpos[2:7] = [0.2, np.cos(0.9), np.sin(0.9), 0, 0]
    for _ in range(400):
        mujoco.mj_step(model, data)
    lowest = np.inf
    for geom in range(model.ngeom):
        if model.geom_bodyid[geom]:
            corners = data.geom_xpos[geom] + (model.geom_aabb[geom, 3:] * _CORNERS + model.geom_aabb[geom, :3]) @ (
                data.geom_xmat[geom].reshape(3, 3).T
            )
            lowest = min(lowest, float(corners[:, 2].min()))
    assert lowest > -0.02


_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])


def test_sizes_fit_hand_sink_and_microwave() -> None:
    for name, category in CATEGORIES.items():
        half = np.array(category.size)
        assert category.grasp.width < 0.075, name  # the hand opens 0.08
        assert 2 * half[0] < 0.50 and 2 * half[1] < 0.40, name  # the sink's basin, the pan turned along it
    for name in [*FOOD, "plate", "bowl", "mug"]:
        half = np.array(CATEGORIES[name].size)
        assert 2 * half.max() < 0.26, name  # the microwave's cavity is 0.38 by 0.35 by 0.26


@pytest.mark.parametrize("name", CATEGORIES)
def test_drawn_shape_matches_the_body(name: str) -> None:
    low, high = (np.array(corner) for corner in CATEGORIES[name].body.bounds)
    parts = shape(CATEGORIES[name].look)
    drawn_low = np.min([part.mesh.bounds[0] for part in parts], axis=0)
    drawn_high = np.max([part.mesh.bounds[1] for part in parts], axis=0)
    # Leaves, tails and stems reach beyond the body; nothing reaches into the table it rests on.
    assert (drawn_low < low + 0.012).all() and (drawn_high > high - 0.012).all()
    assert (drawn_low > low - 0.06).all() and (drawn_high < high + 0.06).all()
    main = parts[0].mesh.bounds[0][2]
    assert main == pytest.approx(low[2], abs=0.004)


@pytest.mark.parametrize("name", CATEGORIES)
def test_visual_geometry_changes_neither_mass_nor_contacts(name: str) -> None:
    bare, drawn = model_of(("thing", name)), model_of(("thing", name), visual=True)
    assert bare.nq == drawn.nq and drawn.ngeom > bare.ngeom
    assert drawn.body("thing").mass == pytest.approx(bare.body("thing").mass)
    assert drawn.body("thing").inertia == pytest.approx(bare.body("thing").inertia)
    assert bare.body("thing").mass[0] == pytest.approx(CATEGORIES[name].mass, rel=0.2)
    visual = drawn.geom_group == 1
    assert visual.any() and not drawn.geom_contype[visual].any() and not drawn.geom_conaffinity[visual].any()


def test_shapes_are_small() -> None:
    assert sum(len(part.mesh.vertices) for name in names() for part in shape(name)) < 45_000


def test_there_are_many_kinds_of_things() -> None:
    groups = {category.group for category in CATEGORIES.values()}
    assert len(CATEGORIES) >= 55
    assert groups == set(get_args(catalogue.Group))
    assert len(catalogue.for_role("vegetable")) >= 10


@pytest.mark.parametrize("name", CATEGORIES)
def test_masses_are_those_of_kitchen_things(name: str) -> None:
    """Between a light berry and an iron pan, and for food neither lighter than bread nor heavier than stone."""
    category = CATEGORIES[name]
    assert 0.015 <= category.mass <= 1.0
    if category.small:
        volume = 8 * np.prod(category.size)
        assert 100 < category.mass / volume < 2000


@pytest.mark.parametrize("name", CATEGORIES)
def test_the_width_for_the_hand_is_that_of_the_body(name: str) -> None:
    category = CATEGORIES[name]
    if category.grasp.mode == "side" and category.body.form not in ("bottle", "chain"):
        assert category.grasp.width == pytest.approx(2 * min(category.size[:2]), abs=0.005)
    if category.body.form == "bottle":
        assert category.grasp.width == pytest.approx(2 * category.body["neck_radius"], abs=0.001)


PART = {"make": "lathe", "profile": [[0, 0], [0.01, 0.01], [0, 0.02]], "color": "#ff0000"}


def test_a_drawn_part_from_a_table() -> None:
    mesh = part(PART, source="mine", where="ball").mesh
    assert mesh.bounds[1] == pytest.approx([0.01, 0.01, 0.02])
    lying = part({**PART, "lie": True, "at": [0, 0, 0.5]}, source="mine", where="ball").mesh
    assert lying.bounds[1] == pytest.approx([0.02, 0.01, 0.51])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"make": "weave"}, ["make", "weave", "lathe"]),
        ({"size": 1}, ["size", "profile"]),
        ({"profile": None}, ["profile", "missing"]),
        ({"profile": [[1, 2, 3]]}, ["profile"]),
        ({"color": "red"}, ["color", "#rrggbb"]),
        ({"paint": [["splash", 1]]}, ["paint", "splash", "band"]),
        ({"paint": [["band", 0.1]]}, ["paint.band", "low", "high"]),
    ],
)
def test_bad_parts_name_source_key_and_choices(change: dict[str, object], words: list[str]) -> None:
    table = {key: value for key, value in {**PART, **change}.items() if value is not None}
    with pytest.raises(KitchenFileError) as caught:
        part(table, source="my shapes", where="ball[0]")
    for word in ["my shapes", "ball[0]", *words]:
        assert word in str(caught.value)


def test_a_malformed_file_is_named(tmp_path: Path) -> None:
    bad = tmp_path / "bad.toml"
    bad.write_text("[leek\n")
    with pytest.raises(KitchenFileError, match=r"bad\.toml.*cannot be read"):
        catalogue.read(bad)


TABLE = {
    "group": "vegetable", "mass": 0.1, "friction": [1, 0.01, 0.002], "rest_height": 0.02,
    "body": {"form": "loaf", "half": [0.05, 0.02, 0.02]}, "grasp": {"mode": "side", "height": 0.0, "width": 0.04},
}  # fmt: skip


def test_a_category_from_outside_is_drawn_as_its_body() -> None:
    own = catalogue.parse("leek", {**TABLE, "color": "#00ff00"})
    spec = mujoco.MjSpec()
    add_object(spec, spec.worldbody, "leek", own, visual=True)
    model = spec.compile()
    assert own.roles == ("vegetable", "leek")
    assert list(model.geom_group) == [3, 3, 1, 1]
    assert model.geom_size[0] == pytest.approx(model.geom_size[2])
    assert model.body("leek").mass[0] == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"mass": 0}, ["leek.mass", "above 0"]),
        ({"mass": None}, ["leek.mass"]),
        ({"group": "pet"}, ["leek.group", "pet", "vegetable"]),
        ({"colour": "#000000"}, ["leek.colour", "color"]),
        ({"color": "green"}, ["leek.color", "#rrggbb"]),
        ({"attributes": ["edible"]}, ["leek.attributes", "edible", "washable"]),
        ({"friction": [1, 2]}, ["leek.friction", "3"]),
        ({"body": {"form": "cone"}}, ["leek.body.form", "cone", "capsule"]),
        ({"body": {"form": "chain", "points": [[0, 0, 0]], "radii": []}}, ["leek.body.points", "2 to 5"]),
        ({"body": {"form": "chain", "points": [[0, 0, 0], [1, 0, 0]], "radii": [1, 2]}}, ["leek.body.radii"]),
        ({"body": {"form": "loaf"}}, ["leek.body.half", "missing"]),
        ({"body": {"form": "loaf", "half": [1, 1, 1], "radius": 1}}, ["leek.body.radius"]),
        ({"grasp": {"mode": "side", "height": 0, "width": 0.09}}, ["leek.grasp.width", "0.08"]),
        ({"grasp": {"mode": "rim", "height": 0, "width": 0.01}}, ["leek.grasp.reach"]),
        ({"grasp": {"mode": "bite", "height": 0, "width": 0.01}}, ["leek.grasp.mode", "side", "rim"]),
    ],
)
def test_bad_tables_name_source_key_and_choices(change: dict[str, object], words: list[str]) -> None:
    with pytest.raises(KitchenFileError) as caught:
        catalogue.parse("leek", {**TABLE, **change}, source="my tasks")
    for word in ["my tasks", *words]:
        assert word in str(caught.value)


def test_a_missing_key_is_named() -> None:
    with pytest.raises(KitchenFileError, match="leek.grasp: is missing"):
        catalogue.parse("leek", {key: value for key, value in TABLE.items() if key != "grasp"})


def test_unknown_category_lists_the_names() -> None:
    with pytest.raises(UnknownNameError, match="rye bread.*carrot"):
        catalogue.get("unicorn")
