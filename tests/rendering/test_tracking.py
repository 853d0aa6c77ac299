"""Cameras of videos: the robots' work fills the picture, whatever they do, and the picture goes with them evenly."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest

import remac_env
from remac_env.rendering.cameras import CLOSE, FOLLOW, WHOLE_FIELD, WIDE_ASPECT, Camera, in_picture, wide_camera
from remac_env.rendering.stage import Stage
from remac_env.rendering.tracking import Aim, Seen, aimed, look, place

LAYOUTS = ("one_wall_small", "l_shaped_large", "galley")


def posed(layout: str, robots: int, *commands: str) -> tuple[Stage, Any]:
    """A kitchen without a renderer, after some commands of the first robot."""
    env = remac_env.parallel_env("HeatOnStove", robots=robots, layout=layout, backend="symbolic")
    env.reset(seed=3)
    for command in commands:
        env.step({name: env.vocabulary.encode(command if name == "robot_0" else "wait") for name in env.agents})
    stage = Stage(env.start, env.worlds.layout(env.start.layout, env.start.style), env.worlds.categories)
    stage.show_world(env.start, env.world)
    return stage, env


def seen(aim: Aim, field: float, points: np.ndarray, aspect: float) -> np.ndarray:
    eye = tuple(float(part) for part in aim.place)
    target = tuple(float(part) for part in aim.place - aim.back)
    camera = Camera("x", eye, target, field)  # type: ignore[arg-type]
    return np.array([in_picture(camera, tuple(point), aspect) for point in points])  # type: ignore[arg-type]


def bodies(stage: Stage, robot: str) -> np.ndarray:
    model = stage._model
    names = [model.body(index).name for index in range(model.nbody)]
    return np.array([stage._data.body(name).xpos for name in names if name.startswith(f"{robot}/")])


@pytest.mark.few(1)
@pytest.mark.parametrize("robots", [2, 1])
def test_every_robot_is_in_the_picture_and_fills_much_of_it(robots: int) -> None:
    for layout in LAYOUTS:
        stage, env = posed(layout, robots)
        aims = stage.aimed([stage.at_work()])[0]
        height, more = [], []
        for robot in env.start.scene.robots:
            points = bodies(stage, robot)
            follow = seen(aims[FOLLOW], WHOLE_FIELD, points, WIDE_ASPECT)
            assert np.abs(follow).max() <= 1.0, (layout, robot)
            wide = np.array([in_picture(wide_camera(stage._layout), tuple(p), WIDE_ASPECT) for p in points])  # type: ignore[arg-type]
            height.append(np.ptp(follow[:, 1]) / 2)
            more.append(np.ptp(follow[:, 1]) / np.ptp(wide[:, 1]))
            hand = stage._data.body(f"{robot}/hand").xpos[None]
            assert np.abs(seen(aims[CLOSE.format(robot=robot)], 46.0, hand, 1.0)).max() < 0.2
        assert min(height) > (0.72 if robots == 1 else 0.46), (layout, height)
        # Two that stand at both ends of a kitchen are as far apart as everything in it.
        assert min(more) > (1.3 if robots == 1 else 0.9), (layout, more)
        stage.close()


def test_cameras_stand_where_they_are_aimed() -> None:
    stage, env = posed("one_wall_small", 1)
    robots = env.start.scene.robots
    before = stage.aimed([stage.at_work()])[0]
    place(stage._data, before)
    for name, aim in before.items():
        camera = stage._data.camera(name)
        assert np.allclose(camera.xpos, aim.place) and np.allclose(camera.xmat.reshape(3, 3)[:, 2], aim.back)
    stage._data.qpos[stage._model.joint("robot_0/base_x").qposadr[0]] += 1.0
    mujoco.mj_kinematics(stage._model, stage._data)
    after = aimed([look(stage._data, stage._layout, robots)], stage._layout)[0]
    assert after[FOLLOW].place[0] == pytest.approx(before[FOLLOW].place[0] + 1.0, abs=0.05)
    stage.close()


def film(steps: np.ndarray, hand: np.ndarray) -> list[Seen]:
    """A robot whose middle is at these places along the room, its hand before it."""
    box = np.array([(x, y, z) for x in (-0.4, 0.4) for y in (-2.4, -1.6) for z in (0.0, 1.5)])
    back = np.array([0.8, -0.4, 0.62]) / np.linalg.norm([0.8, -0.4, 0.62])
    return [
        Seen({"a": box + (x, 0.0, 0.0)}, {"a": np.array([x, -1.2, 1.0]) + at}, {"a": back})
        for x, at in zip(steps, hand, strict=True)
    ]


def test_who_drives_across_the_room_stays_in_the_picture_and_who_works_does_not_move_it() -> None:
    """A mean of aims alone loses whoever drives: it lags behind."""
    layout = posed("one_wall_small", 1)[0]._layout
    drive = np.concatenate([np.zeros(40), np.linspace(0.0, 2.5, 8), np.full(40, 2.5)])
    works = 0.1 * np.sin(np.arange(len(drive)))[:, None] * np.array([1.0, 0.0, 1.0])
    moments = film(drive, works)
    aims = aimed(moments, layout)
    for moment, aim in zip(moments, aims, strict=True):
        assert np.abs(seen(aim[FOLLOW], WHOLE_FIELD, moment.work["a"], WIDE_ASPECT)).max() <= 0.95
    moved = np.linalg.norm(np.diff([aim[FOLLOW].place for aim in aims], axis=0), axis=1)
    assert moved.max() < 0.5 and moved[:24].max() < 1e-9 and moved[-24:].max() < 1e-9
    near = [seen(aim["a/close"], 46.0, moment.hands["a"][None], 1.0) for moment, aim in zip(moments, aims, strict=True)]
    assert np.abs(near[:24]).max() < 0.5 and np.abs(near[-24:]).max() < 0.9
    assert aimed([], layout) == []


def test_who_only_waits_for_long_leaves_the_picture_to_who_works() -> None:
    layout = posed("one_wall_small", 1)[0]._layout
    drive = np.concatenate([np.zeros(30), np.linspace(0.0, 2.5, 8), 2.5 + 0.1 * np.sin(np.arange(40))])
    alone = film(drive, np.zeros((len(drive), 1)))
    still = alone[0].work["a"] - (1.0, 0.0, 0.0)
    team = [Seen({**each.work, "b": still}, each.hands, each.backs) for each in alone]
    aims = aimed(team, layout)

    def there(at: int, robot: str) -> bool:
        return bool(np.abs(seen(aims[at][FOLLOW], WHOLE_FIELD, team[at].work[robot], WIDE_ASPECT)).max() <= 0.95)

    # At the beginning both wait; once one works, the other is in its picture only where it happens to stand near.
    assert there(0, "a") and there(0, "b")
    assert all(there(at, "a") for at in range(len(team))) and not there(len(team) - 1, "b")
    assert np.allclose(aims[-1][FOLLOW].place, aimed(alone, layout)[-1][FOLLOW].place)


@pytest.mark.long
def test_a_picture_of_work_has_the_hands_below() -> None:
    stage, _ = posed("one_wall_small", 2)
    follow, whole = stage.work(), stage.work(whole=True)
    assert follow.shape == whole.shape == (648, 768, 3)
    assert np.array_equal(follow[432:], whole[432:]) and not np.array_equal(follow[:432], whole[:432])
    stage.close()
