"""How large robots and their work are in pictures, and how objects stand out: `python benchmarks/what_is_seen.py`.

Framing: in `front` (256 by 256 pixels) and in what `render()` returns (768 by 432), the height of a folded robot at the
farthest and at the nearest of the places where one stands; and what `front` is of at the start of an episode.
Contrast: the distance in CIE Lab of an object's pixels from the mean colour just around it, in `side` pictures of 256
pixels, of every object in every style on the worktop and in every kind of fixture that takes it; the least ones.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from itertools import product

import mujoco
import numpy as np
from numpy.typing import NDArray
from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.flags import takes
from rich.table import Table

import remac_env
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.builder import build_spec
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.objects import catalogue
from remac_env.rendering.cameras import FRONT, SIDE, WIDE, Camera, add_cameras, fixed_cameras, in_picture
from remac_env.rendering.renderer import CLOSE, Renderer
from remac_env.rendering.stage import RENDER_SIZE, Stage
from remac_env.simulator import load_opencv

TEAMS = (2, 4)
SIZE = 256
"""Pixels of a side of `front` and of `side` pictures here."""

LEAST_PIXELS = 12
"""Of an object: what less is seen of, behind an edge, is not judged."""

LAYOUT = "one_wall_large"
_TALL = 1.3  # m, a folded robot
_AWAY = (0.0, 0.0, -9.0)
_WORST = 15  # rows of the table
_OPEN = 1.45  # rad

Picture = NDArray[np.uint8]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Framing:
    """Pixels of a robot's height at the farthest and the nearest of its places, by camera, and shares of `front`."""

    tall: Mapping[str, tuple[float, float]]
    floor: float
    empty: float

    @property
    def work(self) -> float:
        """The share of fixtures, objects and robots."""
        return 1.0 - self.floor - self.empty


def framing(layout: str, robots: int) -> Framing:
    """The pictures of the whole of a layout with so many robots. `empty`: walls, and nothing at all."""
    env = remac_env.parallel_env("OpenCabinetPnP", robots=robots, backend="symbolic", layout=layout)
    env.reset(seed=0)
    plan = env.worlds.layout_of(env.start)
    stage = Stage(env.start, plan, env.worlds.categories)
    stage.show_world(env.start, env.world)
    pixels = stage.shown(env.agents[0], env.world, FRONT, size=SIZE)
    stage.close()
    env.close()
    floor = pixels.get("room/floor", 0) / SIZE**2
    seen = sum(count for body, count in pixels.items() if not body.startswith("room/")) / SIZE**2
    sizes = {FRONT: (SIZE, SIZE), WIDE: RENDER_SIZE}
    tall = {one.name: _tall(one, plan, sizes[one.name]) for one in fixed_cameras(plan) if one.name in sizes}
    return Framing(tall, floor, 1.0 - floor - seen)


def _tall(camera: Camera, layout: Layout, size: tuple[int, int]) -> tuple[float, float]:
    """Of a robot at all its places, pixels."""
    found = []
    for place in (*layout.stations.values(), *layout.asides):
        foot, top = (in_picture(camera, (place.x, place.y, z), size[0] / size[1])[1] for z in (0.0, _TALL))
        found.append((top - foot) / 2 * size[1])
    return min(found), max(found)


def contrasts(style: str, *, names: Collection[str] = ()) -> dict[tuple[str, str], float]:
    """How far every object stands out in a style, by the kind of what it is in or on, and its name.

    names: of the objects; none: all.
    """
    look, known = styles.load(style), catalogue.load()
    every = {name: known[name] for name in names or known}
    plan = layouts.load(LAYOUT, look.models)
    spec = build_spec(plan, robots=[], objects={name: name for name in every}, style=look, visual=True)
    add_cameras(spec, plan, [])
    model = spec.compile()
    data = mujoco.MjData(model)
    for panel in (panel for fixture in plan.fixtures.values() for panel in fixture.door_panels):
        data.joint(panel.joint).qpos[0] = _OPEN
    for name in every:
        data.joint(name).qpos[:3] = _AWAY
    places = {plan.fixtures[slot.fixture].noun: slot for slot in reversed(plan.slots.values())}
    found = {}
    with Renderer(model, SIZE, SIZE, quality=CLOSE) as renderer:
        for (where, slot), (name, category) in product(places.items(), every.items()):
            if slot.kind == "burner" and not category.vessel or where in category.too_big_for:
                continue
            data.joint(name).qpos[:3] = np.array(plan.middle(slot.name)) + [0.0, 0.0, category.rest_height]
            mujoco.mj_kinematics(model, data)
            mujoco.mj_camlight(model, data)
            camera = SIDE.format(station=slot.station)
            geoms = renderer.segment(data, camera)
            mask = (model.geom_bodyid[geoms] == model.body(name).id) & (geoms >= 0)
            if mask.sum() >= LEAST_PIXELS:
                found[where, name] = contrast(renderer.render(data, camera), mask)
            data.joint(name).qpos[:3] = _AWAY
    return found


def contrast(picture: Picture, mask: Mask) -> float:
    """The mean distance in CIE Lab of a thing's pixels, but for its outline, from the mean colour just around it."""
    cv2 = load_opencv()
    bits, near, far = mask.astype(np.uint8), np.ones((3, 3)), np.ones((11, 11))
    ring = (cv2.dilate(bits, far) > 0) & (cv2.dilate(bits, near) == 0)
    inner = cv2.erode(bits, near) > 0
    colors = cv2.cvtColor(picture.astype(np.float32) / 255.0, cv2.COLOR_RGB2LAB)
    return float(np.linalg.norm(colors[inner if inner.any() else mask] - colors[ring].mean(axis=0), axis=1).mean())


@takes("script.only")
def main(*, only: str) -> None:
    """Print both tables."""
    if only in "framing":
        show(_framings())
    if only in "contrast":
        show(_least())


def _framings() -> Table:
    heads = ("front: farthest", "nearest", "render(): farthest", "nearest", "work", "floor", "walls, nothing")
    table = Table("layout", "robots", *heads, title="Pixels of a robot's height, and what front is of")
    for layout, robots in product(layouts.names(), TEAMS):
        found = framing(layout, robots)
        tall = [f"{pixels:.0f}" for camera in (FRONT, WIDE) for pixels in found.tall[camera]]
        shares = [f"{share:.0%}" for share in (found.work, found.floor, found.empty)]
        table.add_row(layout, str(robots), *tall, *shares)
    return table


def _least() -> Table:
    table = Table("object", "where", "style", "distance", title="Objects that stand out least, CIE Lab")
    found = {(*key, style): far for style in styles.names() for key, far in contrasts(style).items()}
    for (where, name, style), far in sorted(found.items(), key=lambda entry: entry[1])[:_WORST]:
        table.add_row(name, where, style, f"{far:.1f}")
    return table


if __name__ == "__main__":
    run_script(main)
