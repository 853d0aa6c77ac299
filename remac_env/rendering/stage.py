"""One kitchen ready to be looked at: a model with visual geometry, its data and its renderers."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from remac_env.kitchen import style as styles
from remac_env.kitchen.builder import build_spec, show_switches
from remac_env.kitchen.canvas import HIDDEN_GROUP
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.objects.catalogue import Category
from remac_env.kitchen.objects.drawing import show_seasoned, show_stains
from remac_env.rendering.cameras import CLOSE, FOLLOW, FRONT, HELD, ROOM, SIDE, WIDE, WRIST, add_cameras
from remac_env.rendering.following import follow
from remac_env.rendering.posing import pose
from remac_env.rendering.renderer import BEAUTY, OBSERVATION, VIDEO, Quality, Renderer
from remac_env.rendering.renderer import CLOSE as NEAR
from remac_env.rendering.signs import NOTHING, Signs, Slow
from remac_env.rendering.tracking import Aim, Seen, aimed, look, place
from remac_env.rendering.window import Window
from remac_env.robots import bodies
from remac_env.rules.facts import ASIDE
from remac_env.rules.marks import SEASONED, WASHED
from remac_env.start import Start
from remac_env.state import FixtureState, ObjectState, WorldState, switches_on

RENDER_SIZE = (768, 432)
"""Width and height of `render()` and of videos, pixels."""

HANDS = 216
"""Height of the pictures of hands below it, pixels."""

RULE = 4
"""Width of the black lines between them, pixels."""

SMALL = 256
"""Pixels on a side up to which observation images are drawn with few triangles."""

Picture = NDArray[np.uint8]
Shot = tuple[str, int, int, Quality]
"""A camera, the width and height of its picture, and its quality."""

NONE: frozenset[str] = frozenset()


class Stage:
    """Draws episodes of one kitchen: the same layout, style and objects.

    The pose comes either from physics (`show_positions`) or from a WorldState (`show_world`). Objects that are `unseen`
    are in no picture of it: a window of an oven or microwave would show them.
    """

    def __init__(
        self, start: Start, layout: Layout, categories: Mapping[str, Category], *, style: styles.Style | None = None
    ) -> None:
        """style: how it looks, instead of as the start says."""
        self.key = stage_key(start)
        self._layout, self._categories, self._robots = layout, categories, start.scene.robots
        spec = build_spec(
            layout,
            robots=start.scene.robots,
            objects={noun: categories[name] for noun, name in start.categories.items()},
            style=styles.load(start.style) if style is None else style,
            visual=True,
            body=bodies.get(start.body),
            quirks=start.scene.quirks,
        )
        add_cameras(spec, layout, start.scene.robots)
        self._signs = Signs(start.scene, layout, {noun: categories[name] for noun, name in start.categories.items()})
        self._signs.add_to(spec)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self._state: tuple[Mapping[str, FixtureState], Mapping[str, ObjectState]] | None = None  # that is shown
        self._renderers: dict[tuple[int, int, Quality], Renderer] = {}
        self._groups, self._left_out = self._model.geom_group.copy(), NONE
        self._drawn: dict[Shot, Picture] = {}  # of the present pose: robots share the view of the whole kitchen

    def show_positions(
        self, positions: NDArray[np.float64], world: WorldState, slow: Slow = NOTHING, unseen: frozenset[str] = NONE
    ) -> None:
        """Take over joint positions, qpos of the physics model; switches as `world` says.

        `slow`: what takes its time by itself, and which share of it is over.
        """
        self._drawn.clear()
        self._leave_out(unseen)
        self._data.qpos[:] = positions
        self._show_state(world, slow)
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        follow(self._model, self._data, self._layout, world)

    def show_world(
        self, start: Start, world: WorldState, slow: Slow = NOTHING, unseen: frozenset[str] = NONE
    ) -> None:
        """Pose the kitchen by what is true in it; `slow` as above."""
        self._drawn.clear()
        self._leave_out(unseen)
        self._show_state(world, slow)
        pose(self._model, self._data, self._layout, self._categories, start, world)
        follow(self._model, self._data, self._layout, world)

    def picture(self, *, quality: Quality = BEAUTY, size: tuple[int, int] = RENDER_SIZE) -> Picture:
        """The whole kitchen, uint8 (height, width, 3)."""
        return self._render(WIDE, size, quality)

    def look(self, camera: str, *, size: int, quality: Quality = NEAR) -> Picture:
        """What one of its cameras sees, uint8 (size, size, 3)."""
        return self._render(camera, (size, size), quality)

    def at_work(self) -> Seen:
        """What the cameras that follow the robots are to show of the present pose."""
        return look(self._data, self._layout, self._robots)

    def aimed(self, moments: Sequence[Seen]) -> list[dict[str, Aim]]:
        """Where these cameras stand at each moment of a film."""
        return aimed(moments, self._layout)

    def work(self, aims: Mapping[str, Aim] | None = None, *, whole: bool = False) -> Picture:
        """The robots at work, uint8 (648, 768, 3): followed by a camera, and below it each hand from near by.

        Args:
            aims: where the cameras stand; None: as `aimed` says for the present pose alone.
            whole: the whole kitchen stands above, as `picture` shows it.
        """
        place(self._data, self.aimed([self.at_work()])[0] if aims is None else aims)
        self._drawn.clear()
        width = RENDER_SIZE[0]
        each = width // len(self._robots) // 2 * 2
        hands = [self._render(CLOSE.format(robot=robot), (each, HANDS), NEAR) for robot in self._robots]
        hands.append(np.zeros((HANDS, width - each * len(hands), 3), np.uint8))
        above = self.picture() if whole else self._render(FOLLOW, RENDER_SIZE, VIDEO)
        below = np.concatenate(hands, axis=1)
        below[:RULE] = 0
        for number in range(1, len(self._robots)):
            below[:, number * each - RULE // 2 : number * each + RULE // 2] = 0
        return np.concatenate([above, below])

    def show_in(self, window: Window) -> None:
        """Show the kitchen in a window that can be looked around in."""
        window.show(self._model, self._data, WIDE)

    def observe(
        self, robot: str, world: WorldState, *, size: int, cameras: Collection[str] = ("front", "wrist", "side")
    ) -> dict[str, Picture]:
        """The robot's pictures, uint8 (size, size, 3): the kitchen, from its hand, and of its station.

        "side" is of its hand and its station while it holds something, "station" of its station whatever it holds;
        both are of the whole kitchen while it is away from all stations, "side" with an empty hand.
        """
        quality = OBSERVATION if size <= SMALL else NEAR
        every = _cameras(robot, world)
        return {name: self._render(every[name], (size, size), quality) for name in cameras}

    def shown(self, robot: str, world: WorldState, camera: str, *, size: int) -> dict[str, int]:
        """How many pixels of each body are seen in one of the robot's pictures, where any are: body -> pixels."""
        renderer = self._renderer((size, size), OBSERVATION)
        geoms, pixels = np.unique(renderer.segment(self._data, _cameras(robot, world)[camera]), return_counts=True)
        found: dict[str, int] = {}
        for geom, count in zip(geoms, pixels, strict=True):
            if geom >= 0:
                body = self._model.body(self._model.geom_bodyid[geom]).name
                found[body] = found.get(body, 0) + int(count)
        return found

    def close(self) -> None:
        """Free the renderers. May be called twice."""
        for renderer in self._renderers.values():
            renderer.close()
        self._renderers.clear()
        self._drawn.clear()

    def _leave_out(self, objects: frozenset[str]) -> None:
        """Leave these objects, and no others, out of the pictures from now on."""
        if objects != self._left_out:
            bodies_of = [self._model.body(name).id for name in objects]
            out = np.isin(self._model.geom_bodyid, bodies_of)
            self._model.geom_group[:] = np.where(out, HIDDEN_GROUP, self._groups)
            self._left_out = objects

    def _render(self, camera: str, size: tuple[int, int], quality: Quality) -> Picture:
        shot: Shot = (camera, *size, quality)
        if shot not in self._drawn:
            self._drawn[shot] = self._renderer(size, quality).render(self._data, camera).copy()
        return self._drawn[shot].copy()

    def _renderer(self, size: tuple[int, int], quality: Quality) -> Renderer:
        key = (*size, quality)
        if key not in self._renderers:
            self._renderers[key] = Renderer(self._model, *size, quality=quality)
        return self._renderers[key]

    def _show_state(self, world: WorldState, slow: Slow) -> None:
        """Water, flames and lamps of what is on, grains and stains, and what takes its time."""
        state = world.fixtures, world.objects
        if state != self._state:
            self._state = state
            show_switches(self._model, switches_on(world))
            show_seasoned(self._model, {noun for noun, item in world.objects.items() if SEASONED in item.marks})
            show_stains(self._model, {noun for noun, item in world.objects.items() if WASHED in item.marks})
        self._signs.show(self._model, world, slow)


def _cameras(robot: str, world: WorldState) -> dict[str, str]:
    """Picture of an observation -> the camera that takes it."""
    state = world.robots[robot]
    away = state.station == ASIDE
    near = SIDE.format(station=state.station)
    station, side = (ROOM, FRONT) if away else (near, near)
    side = side if state.holding is None else HELD.format(robot=robot)
    return {"front": FRONT, "wrist": WRIST.format(robot=robot), "side": side, "station": station}


def stage_key(start: Start) -> Any:
    """What a stage is made for; episodes with the same key share one."""
    facts = start.scene.processes, start.scene.quirks
    return start.layout, start.style, tuple(start.categories.items()), start.scene.robots, start.body, facts
