"""Makes the looping animation at the top of the README: two robots at work, seen from near.

    python docs/make_animation.py [--to FILE.webp] [--task TASK] [--seed N] [--layout NAME] [--style NAME]

A team's shortest plan is played in physics and drawn with OpenGL, or with rays where there is none, from a camera
that follows the robots, as near as it can be while all that do not stand aside are in the picture.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import mujoco
import numpy as np
from numpy.typing import NDArray

import remac_env
from remac_env.kitchen import style
from remac_env.kitchen.builder import build_spec, show_switches
from remac_env.oracle import solve
from remac_env.pictures import Moment
from remac_env.rendering.cameras import axes, fitted
from remac_env.rendering.renderer import BEAUTY, Quality, Renderer
from remac_env.rendering.signs import Signs
from remac_env.state import switches_on

FILE = Path(__file__).parent / "pictures" / "team.webp"
SIZE = (640, 360)
"""Width and height, pixels."""

FRAMES, MILLISECONDS, LAST = 90, 80, 1600
"""Pictures, how long each is shown, and how long the last one, before it begins anew."""

QUALITY = 50
"""Of WebP's 100; with it the file stays below 1.5 MB."""

VIEW = (0.30, -1.0, 0.40)
"""Right of, before and above what the camera looks at."""

FIELD = 36.0
"""Vertical field of view, degrees."""

FRAMED = 0.76
"""How much of the picture the middles of the robots' bodies may fill."""

ASIDE = 0.7
"""m from a place to stand aside at; who is nearer waits, or has made room."""

AROUND, SMOOTH = 10, 6.0
"""Pictures before and after one that its camera has in view too; standard deviation of its smoothing, pictures."""


def main() -> None:
    """Play, draw and write the animation."""
    kitchen = {"task": "OpenCabinetPnP", "seed": 4, "layout": "one_wall_large"}
    make(carried_out, __doc__, view=VIEW, size=SIZE, quality=BEAUTY, to=FILE, **kitchen)


def make(
    play: Callable[[Any, str, int], None],
    told: str | None,
    *,
    clock: str = "rounds",
    view: tuple[float, float, float],
    size: tuple[int, int],
    quality: Quality,
    **usual: Any,
) -> None:
    """Let `play` play the episode that the command line names, in physics; draw and write it.

    `view`: from where the camera looks, as a direction in the kitchen's frame. `usual`: what is made where the command
    line says nothing.
    """
    parser = argparse.ArgumentParser(description=told, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, value in {**usual, "style": "scandinavian"}.items():
        parser.add_argument(f"--{name}", type=type(value), default=value)
    given = parser.parse_args()
    env = remac_env.parallel_env(given.task, robots=2, clock=clock, layout=given.layout, style=given.style)
    env.start_recording()
    play(env, given.task, given.seed)
    moments = env._pictures._tape.frames
    spread = [moments[at] for at in np.linspace(0, len(moments) - 1, FRAMES).round().astype(int)]
    write(given.to, drawn(env, spread, view=view, size=size, quality=quality))
    env.close()
    print(f"{given.to}: {given.to.stat().st_size / 1e6:.2f} MB")


def carried_out(env: Any, task: str, seed: int) -> None:
    """A team's shortest plan."""
    env.reset(seed=seed)
    for joint in solve(env.start.scene, env.world, env.goal).rounds:
        env.step({name: env.vocabulary.encode(subtask.text) for name, subtask in joint.items()})


def drawn(
    env: Any, moments: list[Moment], *, view: tuple[float, float, float], size: tuple[int, int], quality: Quality
) -> list[NDArray[np.uint8]]:
    """The moments as pictures, uint8 (height, width, 3), with water, flames and what takes its time."""
    start, layout = env.start, env.worlds.layout_of(env.start)
    categories = {noun: env.worlds.categories[name] for noun, name in start.categories.items()}
    spec = build_spec(
        layout, robots=start.scene.robots, objects=categories, style=style.load(start.style), visual=True
    )
    turn = axes(np.array(view), np.array([0.0, 0.0, 1.0]))
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, turn.ravel())
    holder = spec.worldbody.add_body(name="near", mocap=True)
    holder.add_camera(name="near", fovy=FIELD, quat=quaternion)
    signs = Signs(start.scene, layout, categories)
    signs.add_to(spec)
    model = spec.compile()
    data, pictures = mujoco.MjData(model), []
    asides = np.array([(place.x, place.y) for place in layout.asides])
    places = followed([_at_work(model, data, moment, start.scene.robots, asides) for moment in moments], turn)
    with Renderer(model, *size, quality=quality) as renderer:
        for moment, place in zip(moments, places, strict=True):
            show_switches(model, switches_on(moment.world))
            signs.show(model, moment.world, moment.slow)
            data.qpos[:] = moment.positions
            data.mocap_pos[0] = place
            mujoco.mj_kinematics(model, data)
            mujoco.mj_camlight(model, data)
            pictures.append(renderer.render(data, "near").copy())
    return pictures


def _at_work(
    model: Any, data: Any, moment: Moment, robots: tuple[str, ...], asides: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Where the bodies are of the robots that do not stand aside at a moment, or of all, if all do; m, (n, 3)."""
    data.qpos[:] = moment.positions
    mujoco.mj_kinematics(model, data)
    bodies = [model.body(at) for at in range(model.nbody)]
    found = [np.array([data.xpos[b.id] for b in bodies if b.name.partition("/")[0] == robot]) for robot in robots]
    busy = [one for one in found if np.linalg.norm(one[0, :2] - asides, axis=1).min() > ASIDE]
    return np.concatenate(busy or found)


def followed(points: list[NDArray[np.float64]], turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where the camera is at each moment: with the robots of all moments about it in its picture, and in no hurry."""
    aspect, count = SIZE[0] / SIZE[1], len(points)
    near = [np.concatenate(points[max(0, at - AROUND) : at + AROUND + 1]) for at in range(count)]
    places = np.array([fitted(one, turn, FIELD, aspect=aspect, framed=FRAMED) for one in near])
    away = np.arange(count)[:, None] - np.arange(count)[None, :]
    weights = np.exp(-0.5 * (away / SMOOTH) ** 2)
    smoothed: NDArray[np.float64] = weights @ places / weights.sum(axis=1, keepdims=True)
    return smoothed


def write(path: Path, pictures: list[NDArray[np.uint8]]) -> None:
    """A WebP file that begins anew when it has ended."""
    animation = cv2.Animation()
    animation.frames = [np.ascontiguousarray(picture[..., ::-1]) for picture in pictures]
    animation.durations = np.array([MILLISECONDS] * (len(pictures) - 1) + [LAST])
    animation.loop_count = 0
    if not cv2.imwriteanimation(str(path), animation, [cv2.IMWRITE_WEBP_QUALITY, QUALITY]):
        raise SystemExit(f"{path} could not be written")


if __name__ == "__main__":
    main()
