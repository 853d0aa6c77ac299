"""Annexes that are built: the layout in which they have a shape, and the templates that are set there too."""

from __future__ import annotations

import re

import mujoco
import pytest

import remac_env
from remac_env.errors import OptionError, SamplingError
from remac_env.generator import make, templates
from remac_env.generator.making import candidates
from remac_env.kitchen import annexes
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.fixtures import KINDS
from remac_env.kitchen.fixtures.certificates import anchor
from remac_env.kitchen.scene import build_scene
from remac_env.rules.quirks import QUIRKS

ROWS = {name: row for name, row in templates.load().items() if name.endswith(f"({templates.BUILT})")}
MARKS = ("washed", "heated", "cooled", "dried")


def test_every_template_with_annexes_is_built_but_for_those_that_physics_has_no_room_for() -> None:
    plain = {name: row for name, row in templates.load().items() if row.annexes}
    assert all(row.annexes == () and ROWS[name].name == name for name, row in ROWS.items())
    missing = {name for name in plain if templates.built_name(name) not in ROWS}
    narrow = {name for name, row in plain.items() if row.team and QUIRKS[row.team.kind].across}
    assert missing == narrow and len(narrow) == 3
    elsewhere = {name for name, row in ROWS.items() if row.family != templates.BUILT}
    assert elsewhere == {"clean plates away (built)", "washing for two (built)"}


def test_nothing_else_draws_from_them() -> None:
    for pool in (None, "held out", "teams", "physics", "physics teams"):
        assert not {row.name for row in candidates(1, pool, 2)} & ROWS.keys()
    drawn = {row.name for pool in ("built", "built held out", "built teams") for row in candidates(1, pool, 2)}
    assert drawn == {name for name, row in ROWS.items() if 1 in row.sizes and row.family == templates.BUILT}


def test_each_annex_of_a_template_stands_where_it_is_built() -> None:
    plain = templates.load()
    for name, row in ROWS.items():
        for layout in layouts.names(row.family):
            assert {*plain[name.removesuffix(" (built)")].annexes} <= layouts.load(layout).fixtures.keys(), name


@pytest.mark.parametrize("name", layouts.names(*sorted({row.family for row in ROWS.values()})))
def test_what_is_built_is_what_the_skill_table_has(name: str) -> None:
    scene = build_scene(layouts.load(name), {}, ("robot_0",), gives=MARKS)
    for annex in (annex for annex in annexes.load().values() if annex.name in scene.fixtures):
        built = scene.fixtures[annex.name]
        same = ("door", "switches", "shut_to_run", "gives")
        assert [getattr(built, key) for key in same] == [getattr(annex, key) for key in same], annex.name
        assert bool(built.slots) == bool(annex.slots) and len(built.slots) <= len(annex.slots)
        assert not any(scene.conflicting(built.station, f.station) for f in scene.fixtures.values() if f != built)


def test_whoever_asks_for_the_floor_plan_has_words_for_what_is_in_it() -> None:
    env = remac_env.parallel_env("HeatOnStove", layout="long_galley", backend="symbolic")
    env.reset(seed=3)
    said = {noun.name: set(noun.uses) for noun in layouts.nouns("long_galley")}
    assert said == {noun.name: set(noun.uses) for noun in annexes.nouns()}
    assert {"turn on grill", "open freezer door", "place to dish rack"} <= set(env.vocabulary.commands(env.start.scene))


def colliders(model: mujoco.MjModel, name: str, kind: str, x: float) -> list[object]:
    """Sizes and places of what robots touch of a fixture whose middle is at x, in the order of its bodies."""
    found: list[object] = []
    for body in (model.body(index) for index in range(model.nbody)):
        if body.name.startswith(f"{name}/"):
            start = int(body.geomadr[0])
            for geom in (geom for geom in range(start, start + int(body.geomnum[0])) if model.geom_contype[geom]):
                place = model.geom_pos[geom] + body.pos - (x if body.pos[0] or model.geom_pos[geom][0] else 0.0, 0, 0)
                found.append([int(model.geom_type[geom]), *model.geom_size[geom].round(6), *place.round(6)])
    return found


@pytest.mark.parametrize("kind", sorted(kind for kind, cls in KINDS.items() if cls.proven_as))
def test_what_is_proven_as_another_kind_is_the_same_to_the_touch(kind: str) -> None:
    """The one kitchen with the one kind in it, and with the other."""
    text = (layouts.FOLDER / "built" / "long_galley.toml").read_text(encoding="utf-8")
    fixture = next(f for f in layouts.load("long_galley").fixtures.values() if f.kind == kind)
    other = KINDS[kind].proven_as
    table = re.escape(f"[fixtures.{fixture.name}]" if " " not in fixture.name else f'[fixtures."{fixture.name}"]')
    changed, count = re.subn(rf'({table}\nkind = )"{kind}"', rf'\1"{other}"', text)
    assert count == 1
    models = []
    for source in (text, changed):
        layout = layouts.parse(source, name="twin", file="twin", certified=False)
        model = build_model(layout, robots=(), objects={})
        models.append(colliders(model, fixture.name, kind, anchor(layout.fixtures[fixture.name])))
    assert models[0] == models[1] and models[0]


@pytest.mark.few(2)
@pytest.mark.parametrize("seed", range(8))
def test_nothing_stands_where_it_does_not_go_in(seed: int) -> None:
    spec = make(grade=2, seed=seed, template="built").spec
    env = remac_env.parallel_env(spec, robots=1, backend="symbolic")
    env.reset(seed=0)
    scene = env.start.scene
    for name, item in env.world.objects.items():
        fixture = scene.fixtures[scene.slots[item.place.where].fixture]
        assert fixture.kind not in scene.objects[name].too_big_for, f"{name} in the {fixture.name}"


def test_what_physics_refuses_is_offered_where_it_is_built() -> None:
    spec = remac_env.generate(1, 0, template="mugs into the sideboard")
    with pytest.raises(OptionError, match=re.escape("template='mugs into the sideboard (built)'")):
        remac_env.parallel_env(spec, robots=1)
    spec = remac_env.generate(1, 0, template="fruit through the galley", robots=2)
    with pytest.raises(OptionError) as caught:
        remac_env.parallel_env(spec, robots=2)
    assert "(built)" not in str(caught.value)


def test_one_of_them_in_physics() -> None:
    task = make(grade=1, seed=3, template="mugs into the sideboard (built)")
    env = remac_env.parallel_env(task.spec, robots=1)
    env.reset(seed=0)
    for joint in task.plan.rounds:
        env.step({name: env.vocabulary.encode(subtask.text) for name, subtask in joint.items()})
    assert env.goal.holds(env.start.scene, env.world)


@pytest.mark.long
@pytest.mark.parametrize("name", sorted(ROWS))
def test_each_grade_of_each_can_be_made(name: str) -> None:
    row = ROWS[name]
    for grade in row.sizes:
        try:
            make(grade=grade, seed=1, template=name, robots=2 if row.team else 1)
        except SamplingError as error:
            pytest.fail(f"grade {grade}: {error}")
