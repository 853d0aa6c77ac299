"""What pictures show of things that take their time: steam, browning, rising water, melting ice, a timer's figures.

In kitchens without such things nothing is added. What geoms there are is settled when the model is made; a picture
changes their size, height and opacity, and the colour of food, by which share of a process is over.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from math import ceil
from types import MappingProxyType
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from remac_env.kitchen.canvas import DRAWN_GROUP
from remac_env.kitchen.fixtures.base import Display
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.objects.catalogue import Category
from remac_env.rules.facts import Process, Rules
from remac_env.state import WorldState

SIGN = "/sign_"
"""Between the name of what a sign is about and the sign's own, in the names of its geoms."""

Slow = Mapping[tuple[Process, str], float]
"""What takes its time by itself, and which share of it is over, 0..1."""

NOTHING: Slow = MappingProxyType({})

Color = tuple[float, float, float]

_STEAM, _SMOKE, _WATER, _ICE = (0.96, 0.97, 1.0), (0.30, 0.28, 0.27), (0.42, 0.68, 0.95), (0.80, 0.92, 1.0)
_BROWNED, _CHARRED = (0.62, 0.42, 0.24), (0.10, 0.08, 0.07)  # what the colours of food are multiplied by in the end
_THIN = 0.0015  # m, half the height of a film of water
_WALL = 0.004  # m from a vessel's outside to the water in it
_BRIM = 0.008  # m below a vessel's upper edge to which it is full

_CLOUDS = ((0.010, 0.035, 0.024), (-0.012, 0.080, 0.031), (0.008, 0.135, 0.038))
"""Aside, over the top of the food, and radius of each puff, m."""

_SEGMENTS = "abcdefg"
_FIGURES = ("abcdef", "bc", "abdeg", "abcdg", "bcfg", "acdfg", "acdefg", "abc", "abcdefg", "abcdfg")
"""The bars that are lit for each figure: a on top, then clockwise to f, g in the middle."""

_BARS: Mapping[str, tuple[float, float, bool]] = MappingProxyType(
    {"a": (0, 1, True), "b": (1, 0.5, False), "c": (1, -0.5, False), "d": (0, -1, True), "e": (-1, -0.5, False),
     "f": (-1, 0.5, False), "g": (0, 0, True)}
)  # fmt: skip
"""Where each bar's middle is, in half widths and half heights of a figure, and whether it lies."""


class Sign(ABC):
    """What is seen of one process of one object. ``model`` is taken at its first picture."""

    def __init__(self, process: Process, name: str) -> None:
        self.process, self.name = process, name
        self._ids: list[int] = []

    @abstractmethod
    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add its geoms, as large as they ever become."""

    @abstractmethod
    def show(self, model: mujoco.MjModel, share: float, *, goes_on: bool) -> None:
        """Show which share of it is over; 1 and not going on for what has come to its end."""

    def _geom(self, spec: mujoco.MjSpec, body: str, number: int, **shape: Any) -> None:
        name = f"{self.name}{SIGN}{self.process.shows}_{number}"
        rgba = [*shape.pop("color"), 0.0]
        spec.body(body).add_geom(name=name, rgba=rgba, contype=0, conaffinity=0, mass=0.0, group=DRAWN_GROUP, **shape)

    def _geoms(self, model: mujoco.MjModel) -> list[int]:
        if not self._ids:
            mark = f"{self.name}{SIGN}{self.process.shows}_"
            self._ids = [geom for geom in range(model.ngeom) if model.geom(geom).name.startswith(mark)]
        return self._ids


class Clouds(Sign):
    """Puffs over food that is hot: white ones denser and denser, or dark ones from a share of 0 on."""

    def __init__(self, process: Process, name: str, category: Category, *, color: Color, least: float) -> None:
        super().__init__(process, name)
        self._top, self._color, self._least = float(category.body.bounds[1][2]), color, least

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add three puffs, one over the other."""
        for number, (aside, up, radius) in enumerate(_CLOUDS):
            self._geom(
                spec, self.name, number, type=mujoco.mjtGeom.mjGEOM_SPHERE, color=self._color,
                pos=[aside, 0.0, self._top + up], size=[radius, 0, 0],
            )  # fmt: skip

    def show(self, model: mujoco.MjModel, share: float, *, goes_on: bool) -> None:
        """They stay, thinner, over what is hot and not on the heat any more."""
        opacity = self._least + 0.45 * share if goes_on else 0.25 * share
        for number, geom in enumerate(self._geoms(model)):
            model.geom_rgba[geom, 3] = opacity * (1.0 - 0.2 * number)


class Film(Sign):
    """Water that runs over food."""

    def __init__(self, process: Process, name: str, category: Category) -> None:
        super().__init__(process, name)
        self._half = [1.15 * half + 0.004 for half in category.size]

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add a coat."""
        shape = mujoco.mjtGeom.mjGEOM_ELLIPSOID
        self._geom(spec, self.name, 0, type=shape, color=_WATER, size=self._half)

    def show(self, model: mujoco.MjModel, share: float, *, goes_on: bool) -> None:
        """Seen while it runs."""
        for geom in self._geoms(model):
            model.geom_rgba[geom, 3] = 0.3 + 0.3 * share if goes_on else 0.0


class Level(Sign):
    """Water in a vessel: its surface, which rises."""

    def __init__(self, process: Process, name: str, category: Category) -> None:
        super().__init__(process, name)
        self._floor, self._height = category.inside_height, float(category.body.bounds[1][2])
        self._widest = min(category.size[:2])
        self._narrowest = float(category.body.measures.get("base_radius", self._widest))

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add a disc."""
        self._geom(
            spec, self.name, 0, type=mujoco.mjtGeom.mjGEOM_CYLINDER, color=_WATER,
            pos=[0.0, 0.0, self._height / 2], size=[self._widest, _THIN, 0],
        )  # fmt: skip

    def show(self, model: mujoco.MjModel, share: float, *, goes_on: bool) -> None:
        """As high and as wide as the vessel is there."""
        up = self._floor + share * (self._height - _BRIM - self._floor)
        (geom,) = self._geoms(model)
        model.geom_pos[geom, 2] = up
        model.geom_size[geom, 0] = self._narrowest + (self._widest - self._narrowest) * up / self._height - _WALL
        model.geom_rgba[geom, 3] = 0.8 if goes_on or share > 0 else 0.0


class Spill(Sign):
    """Water that runs over a vessel's edge, into a puddle around it."""

    def __init__(self, process: Process, name: str, category: Category) -> None:
        super().__init__(process, name)
        self._radius, self._height = min(category.size[:2]), float(category.body.bounds[1][2])

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add what stands over the edge, and the puddle."""
        for number, (up, widest) in enumerate(((self._height, 1.03), (_THIN, 1.6))):
            self._geom(
                spec, self.name, number, type=mujoco.mjtGeom.mjGEOM_CYLINDER, color=_WATER, pos=[0.0, 0.0, up],
                size=[widest * self._radius, _THIN, 0],
            )  # fmt: skip

    def show(self, model: mujoco.MjModel, share: float, *, goes_on: bool) -> None:
        """The puddle grows; at the edge it is seen while it runs."""
        edge, puddle = self._geoms(model)
        model.geom_rgba[edge, 3] = 0.6 if goes_on else 0.0
        model.geom_rgba[puddle, 3] = 0.8 if share > 0 else 0.0
        model.geom_size[puddle, 0] = (1.0 + 0.6 * share) * self._radius


class Ice(Sign):
    """A coat of ice that becomes a puddle."""

    def __init__(self, process: Process, name: str, category: Category) -> None:
        super().__init__(process, name)
        self._half = np.array([1.25 * half + 0.008 for half in category.size])
        self._under, self._widest = category.rest_height, 1.5 * max(category.size[:2])

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add the coat and the puddle."""
        box, disc = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CYLINDER
        self._geom(spec, self.name, 0, type=box, color=_ICE, size=self._half.tolist())
        low = [0.0, 0.0, _THIN - self._under]
        self._geom(spec, self.name, 1, type=disc, color=_WATER, pos=low, size=[self._widest, _THIN, 0])

    def show(self, model: mujoco.MjModel, share: float, *, goes_on: bool) -> None:
        """The coat is there before it melts."""
        coat, puddle = self._geoms(model)
        model.geom_size[coat] = self._half * (1.0 - 0.35 * share)
        model.geom_rgba[coat, 3] = 0.6 * (1.0 - share)
        model.geom_size[puddle, 0] = self._widest * (0.3 + 0.7 * share)
        model.geom_rgba[puddle, 3] = 0.7 if share > 0 else 0.0


class Digits(Sign):
    """How many seconds a timer has left, in figures of seven bars."""

    def __init__(self, process: Process, name: str, display: Display) -> None:
        super().__init__(process, name)
        self._display = display

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add a dark field and two figures before it."""
        (left, front, bottom), (right, _, top) = self._display.low, self._display.high
        width, height, box = right - left, top - bottom, mujoco.mjtGeom.mjGEOM_BOX
        at = [(left + right) / 2, front - 0.002, (bottom + top) / 2]
        body = self._display.body
        self._geom(spec, body, 0, type=box, color=(0.02, 0.02, 0.02), pos=at, size=[width / 2, 0.001, height / 2])
        half_x, half_z, thick = 0.12 * width, 0.38 * height, 0.045 * width
        for place in (0, 1):
            for number, bar in enumerate(_SEGMENTS):
                x, z, lies = _BARS[bar]
                size = [half_x - thick, 0.001, thick] if lies else [thick, 0.001, half_z / 2 - thick / 2]
                middle = [at[0] + (place - 0.5) * 0.44 * width + x * half_x, front - 0.004, at[2] + z * half_z]
                self._geom(
                    spec, body, 1 + 7 * place + number, type=box, color=(1.0, 0.45, 0.15), pos=middle, size=size,
                    material="glow",
                )  # fmt: skip

    def show(self, model: mujoco.MjModel, share: float, *, goes_on: bool) -> None:
        """Dark where no timer runs."""
        field, *bars = self._geoms(model)
        left = min(99, ceil(round((1.0 - share) * self.process.seconds, 3)))
        figures = (_FIGURES[left // 10], _FIGURES[left % 10])
        model.geom_rgba[field, 3] = 1.0 if goes_on else 0.0
        for number, geom in enumerate(bars):
            lit = goes_on and _SEGMENTS[number % 7] in figures[number // 7]
            model.geom_rgba[geom, 3] = 1.0 if lit else 0.0


SIGNS: Mapping[str, Callable[[Process, str, Category], Sign]] = MappingProxyType({
    "steam": lambda process, name, category: Clouds(process, name, category, color=_STEAM, least=0.15),
    "smoke": lambda process, name, category: Clouds(process, name, category, color=_SMOKE, least=0.35),
    "film": Film,
    "level": Level,
    "spill": Spill,
    "ice": Ice,
})
"""By `Process.shows`, those of objects."""

TINTS: Mapping[str, tuple[Color, float]] = MappingProxyType({"steam": (_BROWNED, 0.8), "smoke": (_CHARRED, 1.0)})
"""What food turns to, and how far."""


class Signs:
    """All signs of a kitchen. ``objects``: what there is by name."""

    def __init__(self, scene: Rules, layout: Layout, objects: Mapping[str, Category]) -> None:
        self._signs: list[Sign] = []
        self._colors: dict[str, tuple[list[int], NDArray[np.float32]]] = {}
        for process in scene.processes:
            for name in process.about or (*scene.objects, *scene.fixtures):
                if name in objects and process.shows in SIGNS and _suits(scene, process, name):
                    self._signs.append(SIGNS[process.shows](process, name, objects[name]))
                elif name in scene.fixtures and process.shows == "digits":
                    display = layout.fixtures[name].display
                    self._signs += [] if display is None else [Digits(process, name, display)]

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add what they are drawn by."""
        for sign in self._signs:
            sign.add_to(spec)

    def show(self, model: mujoco.MjModel, world: WorldState, slow: Slow) -> None:
        """Show what goes on, and what has come of it. Positions are to be computed afterwards."""
        tints: dict[str, list[tuple[Color, float]]] = {}
        for sign in self._signs:
            process, name = sign.process, sign.name
            marked = bool(process.mark) and process.mark in world.objects[name].marks
            share = slow.get((process, name), float(marked))
            sign.show(model, share, goes_on=(process, name) in slow)
            if process.shows in TINTS:
                color, most = TINTS[process.shows]
                tints.setdefault(name, []).append((color, most * share))
        for name, colors in tints.items():
            self._tint(model, name, colors)

    def _tint(self, model: mujoco.MjModel, name: str, colors: list[tuple[Color, float]]) -> None:
        """Give an object's materials its own colours, turned by so much towards others."""
        if name not in self._colors:
            own = [n for n in range(model.nmat) if model.mat(n).name.partition("/")[0] == name]
            self._colors[name] = own, model.mat_rgba[own, :3].copy()
        own, before = self._colors[name]
        factor = np.ones(3)
        for color, share in colors:
            factor *= 1.0 - share * (1.0 - np.array(color))
        model.mat_rgba[own, :3] = before * factor


def _suits(scene: Rules, process: Process, name: str) -> bool:
    """Whether an object can show it: water stands in vessels, and all else is about what is put into them."""
    return (scene.objects[name].holds > 0) == (process.shows in ("level", "spill"))
