"""Makes the pictures of the README: `python docs/make_pictures.py`. Needs OpenGL for shadows; draws rays without."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

import remac_env
from remac_env.kitchen import style
from remac_env.oracle import solve

FOLDER = Path(__file__).parent / "pictures"
EPISODE = {"task": "OpenCabinetPnP", "seed": 4, "rounds": 2}
TILE = (480, 270)
"""Width and height of a picture on a sheet, pixels."""


def main() -> None:
    """Write kitchen.png (two robots at work) and styles.jpg (one kitchen in every style)."""
    FOLDER.mkdir(exist_ok=True)
    _write("kitchen.png", at_work(**EPISODE))
    _write("styles.jpg", sheet({name: kitchen(EPISODE["task"], name) for name in style.names()}, columns=3))


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


def kitchen(task: str, look: str) -> NDArray[np.uint8]:
    """A kitchen at its start."""
    env = remac_env.parallel_env(task, robots=2, backend="symbolic", style=look, render_mode="rgb_array")
    env.reset(seed=0)
    picture = env.render()
    env.close()
    return picture


def sheet(pictures: Mapping[str, NDArray[np.uint8]], *, columns: int) -> NDArray[np.uint8]:
    """Pictures in rows, each with its name in a corner."""
    tiles = []
    for name, picture in pictures.items():
        tile = cv2.resize(picture, TILE, interpolation=cv2.INTER_AREA)
        (width, height), _ = cv2.getTextSize(name, cv2.FONT_HERSHEY_SIMPLEX, 0.5, 1)
        tile[: height + 12, : width + 14] = 250
        cv2.putText(tile, name, (7, height + 5), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (30, 30, 30), 1, cv2.LINE_AA)
        tiles.append(tile)
    return np.vstack([np.hstack(tiles[i : i + columns]) for i in range(0, len(tiles), columns)])


def _write(name: str, picture: NDArray[np.uint8]) -> None:
    options = [cv2.IMWRITE_PNG_COMPRESSION, 9] if name.endswith("png") else [cv2.IMWRITE_JPEG_QUALITY, 88]
    cv2.imwrite(str(FOLDER / name), np.ascontiguousarray(picture[..., ::-1]), options)


if __name__ == "__main__":
    main()
