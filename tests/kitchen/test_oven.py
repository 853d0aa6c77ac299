"""An oven's door is hinged below, hands open, fill, shut and empty it, and rich layouts have one."""

from __future__ import annotations

import math
from collections.abc import Sequence

import mujoco
import pytest

import remac_env
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.fixtures.door import OPEN_TO
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.scene import build_scene
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.state import Place
from remac_env.tasks.goals import Inside
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.vocabulary import built_in

RICH = layouts.names("rich")
ROBOT = "robot_0"


def kitchen(seed: int, layout: str, *things: str) -> tuple[PhysicsBackend, TaskWorlds]:
    roles = tuple(Role(noun, (noun,)) for noun in things)
    spec = TaskSpec("Chain", ("", "", ""), Inside(f"{{{things[0]}}}", "fridge"), roles, (), distractors=(0, 0))
    worlds = TaskWorlds(spec, layout)
    start, _ = worlds.start(seed, style=None, layout=layout, starts="paper", robots=(ROBOT,), perception_noise=0.0)
    backend = PhysicsBackend(worlds)
    backend.reset(start)
    return backend, worlds


def run(backend: PhysicsBackend, worlds: TaskWorlds, texts: Sequence[str]) -> list[str | None]:
    words = worlds.vocabulary
    return [backend.run_round({ROBOT: words.subtask(words.encode(text))}).outcomes[ROBOT].reason for text in texts]


def test_its_door_comes_down_level() -> None:
    layout = layouts.load("rich_one_wall")
    model = build_model(layout, robots=(), objects={})
    data, oven = mujoco.MjData(model), layout.fixtures["oven"]
    handle = {}
    for opened, state in ((0.0, "closed"), (0.4, "ajar"), (OPEN_TO, "open")):
        for joint, value in oven.joints(opened, frozenset()).items():
            data.joint(joint).qpos[0] = value
        mujoco.mj_forward(model, data)
        reading = oven.read(model, data)
        assert reading.door_angles[0] == pytest.approx(opened) and reading.door == state
        (flap,) = oven.door_panels
        handle[opened] = data.site("oven/handle").xpos.copy()
        assert handle[opened] - handle[0.0] == pytest.approx(flap.way(flap.position(opened)), abs=1e-9)
    assert handle[OPEN_TO][2] < 0.95 < handle[0.0][2] and handle[OPEN_TO][1] < -0.3
    for _ in range(200):
        mujoco.mj_step(model, data)
    assert oven.read(model, data).door == "open", "springs hold it where it is left"
    assert data.joint("oven/door").qpos[0] == pytest.approx(0.5 * math.pi, abs=0.02)


def test_food_is_put_in_heated_and_taken_out() -> None:
    backend, worlds = kitchen(120810, "rich_one_wall", "tomato")
    steps = ["navigate to oven", "open oven door", "navigate to tomato", "pick up tomato", "navigate to oven"]
    assert run(backend, worlds, [*steps, "place to oven"]) == [None] * 6
    assert backend.world.objects["tomato"].place == Place("slot", "oven.0")
    assert run(backend, worlds, ["turn on oven"]) == ["blocked"], "its door is open"
    assert run(backend, worlds, ["turn off oven"]) == ["already_done"], "its knob came back"
    assert run(backend, worlds, ["close oven door", "turn on oven"]) == [None, None]
    assert backend.world.fixtures["oven"].on == {"oven"}
    assert run(backend, worlds, ["pick up tomato"]) == ["door_closed"]
    assert run(backend, worlds, ["open oven door", "pick up tomato"]) == [None, None]
    assert backend.world.robots[ROBOT].holding == "tomato"


def test_what_no_hand_puts_into_a_microwave_is_kept_out_of_an_oven() -> None:
    things = {name: catalogue.get(name) for name in ("tomato", "plate", "bottle")}
    facts = build_scene(layouts.load("rich_galley"), things, (ROBOT,)).objects
    assert {name for name in things if "oven" in facts[name].too_big_for} == {"plate", "bottle"}
    elsewhere = build_scene(layouts.load("galley"), things, (ROBOT,)).objects
    assert not any("oven" in facts.too_big_for for facts in elsewhere.values())


def test_rich_layouts_are_had_by_name_alone() -> None:
    """No task and no suite draws them; whoever asks for one gets tokens for what is in it, after all others."""
    assert len(RICH) >= 4 and not set(RICH) & set(layouts.names())
    assert not any(set(RICH) & set(remac_env.parallel_env(name).worlds.spec.layouts) for name in remac_env.tasks())
    usual = remac_env.parallel_env("HeatOnStove").vocabulary
    assert len(usual) == len(built_in())
    env = remac_env.parallel_env("HeatOnStove", layout=RICH[0], backend="symbolic")
    words = env.vocabulary
    assert [words.decode(token) for token in range(len(usual))] == [usual.decode(token) for token in range(len(usual))]
    seen, _ = env.reset(seed=3)
    wanted = {"open drawer door", "place to oven", "turn on oven", "close cupboard door", "navigate to cupboard"}
    assert wanted <= set(env.vocabulary.commands(env.start.scene))
    assert seen[env.agents[0]]["action_mask"].sum() == len(env.vocabulary.commands(env.start.scene))


@pytest.mark.parametrize("name", RICH)
def test_a_rich_layout_has_a_drawer_an_oven_and_two_cabinets_in_every_style(name: str) -> None:
    for style in styles.names()[:: 1 if name == RICH[0] else 5]:
        layout = layouts.load(name, styles.load(style).models)
        kinds = [fixture.kind for fixture in layout.fixtures.values() if fixture.door]
        assert sorted(kinds) == ["cabinet", "cabinet", "drawer", "microwave", "oven"]
    scene = build_scene(layouts.load(name), {}, ())
    assert len(scene.fixtures["counter"].slots) >= 11 and not scene.conflicts
