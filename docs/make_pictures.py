"""Makes the pictures of the README: `python docs/make_pictures.py`. Needs OpenGL for shadows; draws rays without."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

import remac_env
from remac_env.oracle import solve

FOLDER = Path(__file__).parent / "pictures"
EPISODE = {"task": "OpenCabinetPnP", "seed": 4, "rounds": 2}
STYLES = {
    "OpenCabinetPnP": "modern_1",
    "OpenMicrowavePnP": "farmhouse",
    "DefrostInBowl": "coastal",
    "HeatOnStove": "industrial",
}


def main() -> None:
    """Write kitchen.png (two robots at work) and styles.png (the four kitchens)."""
    FOLDER.mkdir(exist_ok=True)
    _write("kitchen.png", at_work(**EPISODE))
    tiles = [kitchen(task, style) for task, style in STYLES.items()]
    _write("styles.png", np.vstack([np.hstack(tiles[:2]), np.hstack(tiles[2:])]))


def at_work(task: str, seed: int, rounds: int) -> NDArray[np.uint8]:
    """Two robots after some rounds of the shortest team plan, in physics."""
    env = remac_env.parallel_env(task, robots=2, render_mode="rgb_array")
    env.reset(seed=seed)
    plan = solve(env.start.scene, env.world, env.goal)
    for joint in plan.rounds[:rounds]:
        env.step({name: env.vocabulary.encode(subtask.text) for name, subtask in joint.items()})
    picture = env.render()
    env.close()
    return picture


def kitchen(task: str, style: str) -> NDArray[np.uint8]:
    """A kitchen at its start."""
    env = remac_env.parallel_env(task, robots=2, backend="symbolic", style=style, render_mode="rgb_array")
    env.reset(seed=0)
    picture = env.render()
    env.close()
    return picture


def _write(name: str, picture: NDArray[np.uint8]) -> None:
    cv2.imwrite(str(FOLDER / name), np.ascontiguousarray(picture[..., ::-1]), [cv2.IMWRITE_PNG_COMPRESSION, 9])


if __name__ == "__main__":
    main()
