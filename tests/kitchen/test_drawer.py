"""A drawer slides, what lies in it comes along, and hands open, fill, shut and empty it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import mujoco
import pytest

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.fixtures.door import OPEN_TO
from remac_env.kitchen.fixtures.drawer import TRAVEL, Drawer
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.scene import build_scene
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.state import Place, door_state
from remac_env.tasks.goals import Inside
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.vocabulary import Noun

FILE = Path(__file__).resolve().parents[2] / "examples" / "drawer_kitchen.toml"
LAYOUT = layouts.read(FILE)
ROBOT = "robot_0"


def kitchen(seed: int, *things: str) -> tuple[PhysicsBackend, TaskWorlds]:
    spec = TaskSpec(
        "Chain", ("", "", ""), Inside(f"{{{things[0]}}}", "fridge"), tuple(Role(n, (n,)) for n in things), (),
        distractors=(0, 0), nouns=(Noun("drawer", "fixture", ("place to", "open door", "close door")),),
        layouts=("drawer_kitchen",), layout_files={"drawer_kitchen": str(FILE)},
    )  # fmt: skip
    worlds = TaskWorlds(spec)
    start, _ = worlds.start(seed, style=None, layout=None, starts="paper", robots=(ROBOT,), perception_noise=0.0)
    backend = PhysicsBackend(worlds)
    backend.reset(start)
    return backend, worlds


def run(backend: PhysicsBackend, worlds: TaskWorlds, texts: Sequence[str]) -> list[str | None]:
    words = worlds.vocabulary
    return [backend.run_round({ROBOT: words.subtask(words.encode(text))}).outcomes[ROBOT].reason for text in texts]


FILL = ["navigate to drawer", "open drawer door", "navigate to tomato", "pick up tomato", "navigate to drawer"]


def test_it_slides_and_is_told_as_if_it_were_hinged() -> None:
    model = build_model(LAYOUT, robots=(), objects={})
    data, drawer = mujoco.MjData(model), LAYOUT.fixtures["drawer"]
    assert model.joint("drawer/drawer").type[0] == mujoco.mjtJoint.mjJNT_SLIDE
    for opened, state in ((0.0, "closed"), (0.04, "closed"), (0.4, "ajar"), (1.0, "open"), (OPEN_TO, "open")):
        ((joint, value),) = drawer.joints(opened, frozenset()).items()
        data.joint(joint).qpos[0] = value
        mujoco.mj_forward(model, data)
        reading = drawer.read(model, data)
        assert reading.door_angles[0] == pytest.approx(opened) and reading.door == state
        assert data.site("drawer/handle").xpos[1] == pytest.approx(-0.045 - TRAVEL * opened / OPEN_TO)
        assert drawer.shift(opened) == pytest.approx((0.0, -TRAVEL * opened / OPEN_TO, 0.0))


def test_what_lies_in_it_comes_along() -> None:
    backend, worlds = kitchen(120800, "tomato")
    assert run(backend, worlds, [*FILL, "place to drawer"]) == [None] * 6
    assert backend.world.objects["tomato"].place == Place("slot", "drawer.0")
    out = backend.data.body("tomato").xpos.copy()
    assert run(backend, worlds, ["close drawer door"]) == [None]
    assert backend.world.objects["tomato"].place == Place("slot", "drawer.0"), "shut in"
    assert backend.data.body("tomato").xpos[1] - out[1] == pytest.approx(TRAVEL, abs=0.03)
    assert run(backend, worlds, ["pick up tomato"]) == ["door_closed"]
    assert run(backend, worlds, ["open drawer door", "pick up tomato"]) == [None, None]
    assert backend.world.robots[ROBOT].holding == "tomato"


def test_a_slot_that_stays_behind_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Drawer, "shift", lambda self, opened: (0.0, 0.0, 0.0))
    backend, worlds = kitchen(120800, "tomato")
    assert run(backend, worlds, [*FILL, "place to drawer"]) != [None] * 6


def test_what_is_too_big_is_kept_out() -> None:
    things = {name: catalogue.get(name) for name in ("tomato", "mug", "bottle", "bowl")}
    facts = build_scene(LAYOUT, things, (ROBOT,)).objects
    assert {name: "drawer" in facts[name].too_big_for for name in things} == {
        "tomato": False, "mug": False, "bottle": True, "bowl": True,
    }  # fmt: skip
    elsewhere = build_scene(layouts.load("one_wall_large"), things, (ROBOT,)).objects
    assert not any("drawer" in kinds.too_big_for for kinds in elsewhere.values())
    backend, worlds = kitchen(120801, "bottle")
    fill = [text.replace("tomato", "bottle") for text in FILL]
    assert run(backend, worlds, [*fill, "place to drawer"]) == [None] * 5 + ["blocked"]
    assert backend.world.robots[ROBOT].holding == "bottle"


def test_a_start_may_have_things_in_a_drawer_that_stands_open() -> None:
    backend, worlds = kitchen(120802, "tomato")
    spec = replace(worlds.spec, roles=(Role("tomato", ("tomato",), at="drawer"),))
    start, _ = TaskWorlds(spec).start(
        120802, style=None, layout=None, starts="paper", robots=(ROBOT,), perception_noise=0.0
    )
    for opened in (0.0, 0.4, OPEN_TO):
        world = start.world.with_fixture("drawer", door=door_state(opened))
        after = backend.reset(replace(start, world=world, doors={**start.doors, "drawer": opened}))
        assert after.objects["tomato"].place == Place("slot", "drawer.0"), opened
