"""Things that take their time are seen to: each where it is, and nowhere else."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import mujoco
import numpy as np
import pytest

import remac_env
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.rendering.cameras import SIDE
from remac_env.rendering.renderer import OBSERVATION, Renderer
from remac_env.rendering.signs import NOTHING, Signs
from remac_env.rendering.stage import Stage
from remac_env.rules.facts import Process
from remac_env.start import Start
from remac_env.state import Place, WorldState
from remac_env.tasks.goals import Inside
from remac_env.tasks.spec import Role, TaskSpec

SIZE = 96
REACH = 0.30
"""m from an object's middle to the farthest part of what is seen of it: the smoke over it, the puddle around it."""

SLOW = ("heating", "burning", "rinsing", "filling", "overflowing", "melting", "timer")
SPEC = TaskSpec(
    "Slow", ("", "", ""), Inside("{fish}", "cabinet"),
    tuple(Role(noun, (noun,)) for noun in ("fish", "vegetable", "pan", "bowl")), (), distractors=(0, 0),
    processes=tuple((name, {"melting": ("{fish}",), "timer": ("microwave",)}.get(name, ())) for name in SLOW),
)  # fmt: skip


@pytest.fixture(scope="module")
def kitchen() -> Iterator[tuple[Stage, Start]]:
    worlds = TaskWorlds(SPEC)
    start, _ = worlds.start(
        1, style="modern_1", layout="one_wall_large", starts="paper", robots=("robot_0",), perception_noise=0.0
    )
    stage = Stage(start, worlds.layout_of(start), worlds.categories)
    yield stage, start
    stage.close()


def laid(world: WorldState, noun: str) -> tuple[WorldState, str, str]:
    """The world with a thing where it has its process, the thing, and the station beside it."""
    if noun == "vegetable":
        world = world.with_object("pan", place=Place("slot", "stove.0")).with_object(noun, place=Place("vessel", "pan"))
        return world.with_fixture("stove", on=frozenset({"stove.0"})), noun, "stove"
    if noun in ("bowl", "washed"):
        name = "bowl" if noun == "bowl" else "vegetable"
        world = world.with_object(name, place=Place("slot", "sink.0"))
        return world.with_fixture("faucet", on=frozenset({"faucet"})), name, "sink"
    if noun == "microwave":
        return world.with_fixture(noun, on=frozenset({noun})), noun, noun
    return world.with_object(noun, place=Place("slot", "sink.0")), noun, "sink"


CASES = [
    ("vegetable", (), {"heating": 0.5}), ("vegetable", (), {"heating": 1.0}), ("vegetable", ("heated",), {}),
    ("vegetable", ("heated",), {"burning": 0.5}), ("vegetable", ("heated", "burnt"), {}),
    ("washed", (), {"rinsing": 0.5}),
    ("bowl", (), {"filling": 0.1}), ("bowl", (), {"filling": 0.9}), ("bowl", ("filled",), {}),
    ("bowl", ("filled",), {"overflowing": 0.5}), ("bowl", ("filled", "overflowed"), {}),
    ("fish", (), {"melting": 0.5}), ("fish", ("melted",), {}),
    ("microwave", (), {"timer": 0.0}), ("microwave", (), {"timer": 0.75}),
]  # fmt: skip


def picture(stage: Stage, station: str, by: Renderer | None) -> np.ndarray:
    camera = SIDE.format(station=station)
    return stage._render(camera, (SIZE, SIZE), OBSERVATION) if by is None else by.render(stage._data, camera).copy()


def beside(stage: Stage, station: str, about: str) -> np.ndarray:
    """The pixels whose rays pass a thing by more than `REACH`, (height, width)."""
    data, model = stage._data, stage._model
    camera = model.camera(SIDE.format(station=station)).id
    body = about if about != "microwave" else "microwave/button"
    half = np.tan(np.deg2rad(model.cam_fovy[camera]) / 2)
    rows, columns = np.mgrid[0:SIZE, 0:SIZE]
    x, y = ((2 * (columns + 0.5) / SIZE - 1) * half, (1 - 2 * (rows + 0.5) / SIZE) * half)
    rays = np.stack([x, y, -np.ones_like(x)], axis=-1) @ data.cam_xmat[camera].reshape(3, 3).T
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    away = data.body(body).xpos + [0, 0, 0.05] - data.cam_xpos[camera]
    return np.linalg.norm(np.cross(rays, away), axis=-1) > REACH


def slow(start: Start, about: str, share: dict[str, float]) -> dict[tuple[Process, str], float]:
    rows = {process.name: process for process in start.scene.processes}
    return {(rows[name], about): over for name, over in share.items()}


@pytest.mark.parametrize("backend", ["auto", pytest.param("rays", marks=pytest.mark.long)])
def test_each_is_seen_where_it_is_and_nowhere_else(kitchen: tuple[Stage, Start], backend: Any) -> None:
    stage, start = kitchen
    by = Renderer(stage._model, SIZE, SIZE, backend="rays") if backend == "rays" else None
    seen: dict[str, list[np.ndarray]] = {}
    for noun, marks, share in CASES:
        world, about, station = laid(start.world, noun)
        if noun not in seen:
            stage.show_world(start, world)
            seen[noun] = [picture(stage, station, by)]
        if marks:
            world = world.with_object(about, marks=frozenset(marks))
        stage.show_world(start, world, slow(start, about, share))
        now = picture(stage, station, by)
        for before in seen[noun]:
            changed = np.abs(now.astype(int) - before.astype(int)).max(axis=2) > 6
            assert changed.sum() >= 3, f"{noun} {marks} {share} looks like before"
            assert not (changed & beside(stage, station, about)).any(), f"{noun} {marks} {share} is seen elsewhere"
        seen[noun].append(now)
    stage.show_world(start, laid(start.world, "vegetable")[0])
    assert np.array_equal(picture(stage, "stove", by), seen["vegetable"][0]), "nothing of it stays"


def test_kitchens_without_such_things_have_no_signs() -> None:
    env = remac_env.parallel_env("HeatOnStove", robots=1, backend="symbolic", clock="events")
    env.reset(seed=0)
    spec = mujoco.MjSpec()
    Signs(env.start.scene, env.worlds.layout_of(env.start), {}).add_to(spec)
    assert not spec.geoms and env._moment().slow == NOTHING


def test_an_episode_s_pictures_show_what_goes_on() -> None:
    env = remac_env.parallel_env("FrozenInTime", robots=1, backend="symbolic", clock="events", layout="one_wall_large")
    env.reset(seed=1)
    assert set(env._moment().slow.values()) == {0.0}
    env.step({"robot_0": env.vocabulary.encode("wait")})
    assert {each.name: share for (each, _), share in env._moment().slow.items()} == {"melting": 5.0 / 100.0}
    assert {name for _, name in env._moment().slow} == {"fish", "meat"}
