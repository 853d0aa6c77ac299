"""Makes the pictures of README and docs: all, or those named. Needs OpenGL for shadows; draws rays without.

    python docs/make_pictures.py [kitchen.png styles.jpg layouts.jpg inside.jpg objects.png slow.jpg] [--to FOLDER]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path

import cv2
import mujoco
import numpy as np
from numpy.typing import NDArray

import remac_env
from remac_env.kitchen import layout, style
from remac_env.kitchen.objects import add_object, catalogue
from remac_env.oracle import solve
from remac_env.rendering.renderer import BEAUTY, Renderer
from remac_env.rendering.stage import Stage
from remac_env.state import Place

FOLDER = Path(__file__).parent / "pictures"
EPISODE = {"task": "OpenCabinetPnP", "seed": 4, "rounds": 2}
LAYOUT = "one_wall_large"
TILE = (480, 270)
"""Width and height of a picture on a sheet, pixels."""
INSIDE = ("cabinet", "microwave")
"""Fixtures into which side cameras look while their doors are open."""
CHECKER_SIZE = 512
"""Side of the pictures that checkers look at, pixels."""
INSIDE_TILE = (240, 240)
SLOW_TILE = (192, 192)
OBJECT_TILE = (128, 128)
"""The size at which every object must be recognisable, pixels."""


@dataclass(frozen=True)
class Slow:
    """Something that takes its time: where things are for it, what is on, and what is seen: marks, and shares."""

    task: str
    about: str
    station: str
    places: Mapping[str, tuple[str, str]]
    on: Mapping[str, str]
    steps: Sequence[tuple[tuple[str, ...], Mapping[str, float]]]


SLOW = (
    Slow(
        "HeatAndShelve", "vegetable", "stove", {"pan": ("slot", "stove.0"), "vegetable": ("vessel", "pan")},
        {"stove": "stove.0"},
        [((), {"heating": 0.1}), ((), {"heating": 0.9}), (("heated",), {"burning": 0.5}), (("heated", "burnt"), {})],
    ),
    Slow(
        "FillAndShelve", "bowl", "sink", {"bowl": ("slot", "sink.0")}, {"faucet": "faucet"},
        [((), {"filling": 0.1}), ((), {"filling": 0.9}), (("filled",), {"overflowing": 0.5}),
         (("filled", "overflowed"), {})],
    ),
    Slow(
        "FrozenInTime", "fish", "counter_right", {}, {},
        [((), {}), ((), {"melting": 0.3}), ((), {"melting": 0.7}), (("melted",), {})],
    ),
    Slow(
        "RinseAndStow", "vegetable", "sink", {"vegetable": ("slot", "sink.0")}, {"faucet": "faucet"},
        [((), {"rinsing": 0.1}), (("washed",), {})],
    ),
    Slow(
        "MicrowaveAndFill", "microwave", "microwave", {}, {"microwave": "microwave"},
        [((), {"timer": 0.0}), ((), {"timer": 0.8})],
    ),
)  # fmt: skip
"""What the sheet of processes shows."""


def main() -> None:
    """Draw the pictures that the command line names, into their folder."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"one of {', '.join(PICTURES)}; by default all")
    parser.add_argument("--to", type=Path, default=FOLDER, help="another folder than docs/pictures")
    given = parser.parse_args()
    strange = [name for name in given.names if name not in PICTURES]
    if strange:
        parser.error(f"no such picture: {', '.join(strange)}; there are {', '.join(PICTURES)}")
    given.to.mkdir(parents=True, exist_ok=True)
    for name in given.names or PICTURES:
        _write(given.to / name, PICTURES[name]())


def all_styles() -> NDArray[np.uint8]:
    """One layout in every style."""
    return sheet({name: kitchen(name, LAYOUT) for name in style.names()}, columns=3)


def all_layouts() -> NDArray[np.uint8]:
    """Every layout, each in another style."""
    styles = cycle(style.names())
    return sheet({name: kitchen(next(styles), name) for name in layout.names()}, columns=2)


def all_insides() -> NDArray[np.uint8]:
    """Side views into the fixtures of every layout."""
    styles = cycle(style.names())
    pairs = [(name, inside(next(styles), name)) for name in layout.names()]
    views = {f"{name}: {fixture}": one for name, shown in pairs for fixture, one in shown.items()}
    return sheet(views, columns=4, tile=INSIDE_TILE, letters=0.42)


def at_work(task: str, seed: int, rounds: int) -> NDArray[np.uint8]:
    """Two robots after some rounds of the shortest team plan, in physics."""
    env = remac_env.parallel_env(task, robots=2, layout=LAYOUT, render_mode="rgb_array")
    env.reset(seed=seed)
    plan = solve(env.start.scene, env.world, env.goal)
    for joint in plan.rounds[:rounds]:
        env.step({name: env.vocabulary.encode(subtask.text) for name, subtask in joint.items()})
    picture = env.render()
    env.close()
    return picture


def kitchen(look: str, plan: str) -> NDArray[np.uint8]:
    """A kitchen in a style and a layout, at its start."""
    options = {"backend": "symbolic", "style": look, "layout": plan, "render_mode": "rgb_array"}
    env = remac_env.parallel_env(EPISODE["task"], robots=2, **options)
    env.reset(seed=0)
    picture = env.render()
    env.close()
    return picture


def inside(look: str, plan: str) -> dict[str, NDArray[np.uint8]]:
    """What a checker sees of the vegetable in the open cabinet and in the open microwave."""
    env = remac_env.parallel_env(EPISODE["task"], robots=1, backend="symbolic", style=look, layout=plan)
    env.reset(seed=0)
    stage = Stage(env.start, env.worlds.layout(plan, look), env.worlds.categories)
    views = {}
    for fixture in INSIDE:
        facts = env.start.scene.fixtures[fixture]
        world = env.world.with_fixture(fixture, door="open").with_robot("robot_0", station=facts.station)
        slot = Place("slot", facts.slots[0])
        below = next((noun for noun, item in world.objects.items() if item.place == slot), None)
        world = world.with_object("vegetable", place=Place("vessel", below) if below else slot)
        stage.show_world(env.start, world)
        views[fixture] = stage.observe("robot_0", world, size=CHECKER_SIZE)["side"]
    stage.close()
    env.close()
    return views


def objects() -> NDArray[np.uint8]:
    """Every category of the catalogue as it rests, from the side from which robots see it."""
    return sheet({name: object_picture(name) for name in catalogue.load()}, columns=10, tile=OBJECT_TILE, letters=0.36)


def object_picture(category: str, size: tuple[int, int] = OBJECT_TILE) -> NDArray[np.uint8]:
    """One object on a pale table, filling the picture."""
    facts = catalogue.get(category)
    low, high = facts.body.bounds
    middle = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
    reach = max(0.05, float(np.linalg.norm(facts.size)))
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.30] * 3, [0.15] * 3
    spec.visual.map.znear = 0.02
    spec.worldbody.add_light(pos=[-0.4, -0.6, 1.2], dir=[0.3, 0.45, -0.9], diffuse=[0.62] * 3, castshadow=True)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[2, 2, 0.1], group=1, rgba=[0.66, 0.63, 0.58, 1.0])
    add_object(spec, spec.worldbody, "object", facts, visual=True)
    away = np.array([-0.35, -0.80, 0.60]) / np.linalg.norm([-0.35, -0.80, 0.60])
    at = np.array(middle) + [0, 0, facts.rest_height] + away * reach * 4.0
    right = np.cross([0, 0, 1], away)
    right /= np.linalg.norm(right)
    turn = np.zeros(4)
    mujoco.mju_mat2Quat(turn, np.column_stack([right, np.cross(away, right), away]).ravel())
    spec.worldbody.add_camera(name="eye", pos=at, quat=turn, fovy=34)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with Renderer(model, *size, quality=BEAUTY) as renderer:
        return renderer.render(data, "eye")


def slow() -> NDArray[np.uint8]:
    """What is seen of things that take their time, by which share of it is over, and what comes of them."""
    views = {}
    for scene in SLOW:
        env = remac_env.parallel_env(scene.task, robots=1, backend="symbolic", clock="events", layout=LAYOUT)
        env.reset(seed=1)
        stage = Stage(env.start, env.worlds.layout_of(env.start), env.worlds.categories)
        rows = {process.name: process for process in env.start.scene.processes}
        for marks, share in scene.steps:
            world = env.world
            for name, place in scene.places.items():
                world = world.with_object(name, place=Place(*place))
            for name, switch in scene.on.items():
                world = world.with_fixture(name, on=frozenset([switch]))
            if marks:
                world = world.with_object(scene.about, marks=frozenset(marks))
            stage.show_world(env.start, world, {(rows[name], scene.about): over for name, over in share.items()})
            said = [*marks, *(f"{name} {over:.0%}" for name, over in share.items())]
            there = world.with_robot("robot_0", station=scene.station)
            title = f"{scene.about}: {', '.join(said) or 'frozen'}"
            views[title] = stage.observe("robot_0", there, size=CHECKER_SIZE)["side"]
        stage.close()
        env.close()
    return sheet(views, columns=4, tile=SLOW_TILE, letters=0.36)


def sheet(
    pictures: Mapping[str, NDArray[np.uint8]],
    *,
    columns: int,
    tile: tuple[int, int] = TILE,
    letters: float = 0.5,
) -> NDArray[np.uint8]:
    """Pictures in rows, each with its name in a corner; `letters` is the size of the font."""
    tiles = []
    for name, picture in pictures.items():
        one = cv2.resize(picture, tile, interpolation=cv2.INTER_AREA)
        (width, height), _ = cv2.getTextSize(name, cv2.FONT_HERSHEY_SIMPLEX, letters, 1)
        one[: height + 12, : width + 14] = 250
        cv2.putText(one, name, (7, height + 5), cv2.FONT_HERSHEY_SIMPLEX, letters, (30, 30, 30), 1, cv2.LINE_AA)
        tiles.append(one)
    tiles += [np.full_like(tiles[0], 250)] * (-len(tiles) % columns)
    return np.vstack([np.hstack(tiles[i : i + columns]) for i in range(0, len(tiles), columns)])


def _write(path: Path, picture: NDArray[np.uint8]) -> None:
    options = [cv2.IMWRITE_PNG_COMPRESSION, 9] if path.suffix == ".png" else [cv2.IMWRITE_JPEG_QUALITY, 88]
    cv2.imwrite(str(path), np.ascontiguousarray(picture[..., ::-1]), options)


PICTURES: Mapping[str, Callable[[], NDArray[np.uint8]]] = {
    "kitchen.png": lambda: at_work(**EPISODE),
    "styles.jpg": all_styles,
    "layouts.jpg": all_layouts,
    "inside.jpg": all_insides,
    "objects.png": objects,
    "slow.jpg": slow,
}
"""The pictures and what draws them."""


if __name__ == "__main__":
    main()
