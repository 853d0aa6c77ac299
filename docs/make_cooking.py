"""Makes the animation of docs/time.md: one robot cooks while the other fetches, under the event clock.

    python docs/make_cooking.py [--to FILE.webp] [--task TASK] [--seed N] [--layout NAME] [--style NAME]

The task's plan of `benchmarks/timed_plans.toml` is played in physics, and drawn as a time lapse by the camera of
`make_animation.py`, with what takes its time: flames, steam, water.
"""

from __future__ import annotations

import argparse
import tomllib
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

import remac_env
from remac_env.kitchen import style
from remac_env.kitchen.builder import build_spec, show_switches
from remac_env.pictures import Moment
from remac_env.rendering.cameras import axes
from remac_env.rendering.renderer import VIDEO, Renderer
from remac_env.rendering.signs import Signs

FILE = Path(__file__).parent / "pictures" / "cooking.webp"
PLANS = Path(__file__).parent.parent / "benchmarks" / "timed_plans.toml"
SIZE = (480, 270)
"""Width and height, pixels."""


def main() -> None:
    """Play, draw and write the animation."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--to", type=Path, default=FILE)
    parser.add_argument("--task", default="HeatAndShelve")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--layout", default="one_wall_large")
    parser.add_argument("--style", default="scandinavian")
    given = parser.parse_args()
    import make_animation as animation

    env = remac_env.parallel_env(given.task, robots=2, clock="events", layout=given.layout, style=given.style)
    moments = played(env, given.task, given.seed)
    animation.write(given.to, drawn(env, moments))
    env.close()
    print(f"{given.to}: {given.to.stat().st_size / 1e6:.2f} MB")


def played(env: Any, task: str, seed: int) -> list[Moment]:
    """A plan in physics: moments evenly spread over the episode."""
    import make_animation as animation

    plan = {robot: [" ".join(part.split()) for part in text.split(";")]
            for robot, text in tomllib.loads(PLANS.read_text("utf-8"))[task].items()}
    env.start_recording()
    _, infos = env.reset(seed=seed)
    while env.agents:
        over = {s.what if s.kind == "subtask" else f"{s.what} {s.who}" for s in env.timeline if s.status == "success"}
        tokens = {}
        for robot, left in plan.items():
            while left and left[0].startswith("until ") and left[0].removeprefix("until ") in over:
                del left[0]
            command = "wait" if not left or left[0].startswith("until ") else left[0]
            if not infos[robot]["ready"]:
                command = "continue"
            elif command != "wait":
                del left[0]
            tokens[robot] = env.vocabulary.encode(command)
        _, _, _, _, infos = env.step(tokens)
    if not all(info["success"] for info in infos.values()):
        raise SystemExit(f"{task} with seed {seed} was not done")
    moments = env._pictures._tape.frames
    return [moments[at] for at in np.linspace(0, len(moments) - 1, animation.FRAMES).round().astype(int)]


def drawn(env: Any, moments: list[Moment]) -> list[NDArray[np.uint8]]:
    """The moments as pictures, uint8 (height, width, 3)."""
    import make_animation as animation

    start, layout = env.start, env.worlds.layout_of(env.start)
    objects = {noun: env.worlds.categories[name] for noun, name in start.categories.items()}
    spec = build_spec(
        layout, robots=start.scene.robots, objects=objects, style=style.load(start.style), looks=True
    )
    turn, quaternion = axes(np.array(animation.VIEW), np.array([0.0, 0.0, 1.0])), np.empty(4)
    mujoco.mju_mat2Quat(quaternion, turn.ravel())
    spec.worldbody.add_body(name="near", mocap=True).add_camera(name="near", fovy=animation.FIELD, quat=quaternion)
    signs = Signs(start.scene, layout, objects)
    signs.add_to(spec)
    model = spec.compile()
    data, pictures = mujoco.MjData(model), []
    bodies = [animation._robots(model, data, moment, start.scene.robots) for moment in moments]
    with Renderer(model, *SIZE, quality=VIDEO) as renderer:
        for moment, place in zip(moments, animation.followed(bodies, turn), strict=True):
            show_switches(model, frozenset().union(*(state.on for state in moment.world.fixtures.values())))
            signs.show(model, moment.world, moment.slow)
            data.qpos[:] = moment.positions
            data.mocap_pos[0] = place
            mujoco.mj_kinematics(model, data)
            mujoco.mj_camlight(model, data)
            pictures.append(renderer.render(data, "near").copy())
    return pictures


if __name__ == "__main__":
    main()
