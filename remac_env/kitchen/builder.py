"""Turns a layout, robots and objects into a MuJoCo model: of bare colliders for physics, or one to be looked at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import mujoco

from remac_env.kitchen.canvas import SWITCHED, Canvas
from remac_env.kitchen.fixtures.filling import fill
from remac_env.kitchen.fixtures.room import Face
from remac_env.kitchen.floor_plan import Layout, Wall
from remac_env.kitchen.marked import marked
from remac_env.kitchen.style import Style, load
from remac_env.robots import bodies
from remac_env.robots.body import Body
from remac_env.rules.facts import Quirk
from remac_env.rules.quirks import QUIRKS
from remac_env.sights import ACCENTS, accents

if TYPE_CHECKING:
    from remac_env.kitchen.objects import Category

TIMESTEP = 0.005  # s; ten steps make one control step of 20 Hz
DEFAULT_STYLE = "modern_1"

_MEMORY = 64 << 20  # bytes of a model's arena


def build_model(
    layout: Layout,
    *,
    robots: Sequence[str],
    objects: Mapping[str, str | Category],
    style: Style | None = None,
    visual: bool = False,
    body: Body | None = None,
    quirks: Sequence[Quirk] = (),
) -> mujoco.MjModel:
    """Return the compiled kitchen.

    robots: their names, such as "robot_0"; body: theirs, the standard one where None. objects: noun -> category of the
    catalogue. style: materials, used only with `visual`; the default style where None. quirks: those that show
    from the start are built in. Bodies, joints and actuators are the same and in the same order with `visual` and
    without, so that a qpos copies over.
    """
    return build_spec(
        layout, robots=robots, objects=objects, style=style, visual=visual, body=body, quirks=quirks
    ).compile()


def build_spec(
    layout: Layout,
    *,
    robots: Sequence[str],
    objects: Mapping[str, str | Category],
    style: Style | None = None,
    visual: bool = False,
    body: Body | None = None,
    quirks: Sequence[Quirk] = (),
) -> mujoco.MjSpec:
    """Return the description that `build_model` compiles, for callers that add cameras."""
    spec = mujoco.MjSpec()
    spec.modelname = layout.name
    spec.compiler.degree = False
    _set_physics(spec)
    style = load(DEFAULT_STYLE) if style is None else style
    if visual:
        _set_materials(spec, style, ceiling=layout.room.ceiling)
    canvas = Canvas(spec, visual=visual, fronts=(style.panel, style.pull))
    filled = {quirk.about for quirk in quirks if QUIRKS[quirk.kind].fills}
    stained = {quirk.about for quirk in quirks if QUIRKS[quirk.kind].stains}
    layout.room.build(canvas, {wall.side: _face(layout, wall) for wall in layout.walls.values() if wall.side})
    for wall in layout.walls.values():
        canvas.stand(f"wall/{wall.name}", wall.frame)
        for fixture in layout.at_wall(wall.name):
            fixture.build(canvas)
            if fixture.name in filled:
                fill(canvas, fixture)
    canvas.finish()
    if objects:
        from remac_env.kitchen.objects import add_object

        for noun, category in objects.items():
            add_object(spec, spec.worldbody, noun, category, visual=visual, stained=noun in stained)
    if robots:
        for name, color in accents(robots).items():
            (body or bodies.get()).add_to(spec, name, accent=ACCENTS[color], visual=visual)
    return spec


def _face(layout: Layout, wall: Wall) -> Face:
    """How a side of the room is drawn: with the tiles of its wall and the openings of its windows."""
    return Face(wall.tiles, tuple(f.opening for f in layout.at_wall(wall.name) if f.opening is not None))


def show_switches(model: mujoco.MjModel, on: frozenset[str]) -> None:
    """Make water, flames and lamps of the switches in `on` visible in a drawn model, and all others invisible."""
    for geom, switch in marked(model, SWITCHED):
        material = model.geom_matid[geom]
        model.geom_rgba[geom, 3] = model.mat_rgba[material, 3] if switch in on else 0.0


def _set_physics(spec: mujoco.MjSpec) -> None:
    """The setting under which every skill was measured. Fewer line-search steps make objects explode."""
    option = spec.option
    option.timestep = TIMESTEP
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.impratio = 10
    option.iterations = 100
    option.ls_iterations = 50
    # Few constraint rows at a time (15 on average): sparse algebra, MuJoCo's choice from 60 degrees of freedom on, is
    # the slower one.
    option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    spec.memory = _MEMORY


def _set_materials(spec: mujoco.MjSpec, style: Style, *, ceiling: bool) -> None:
    """Add materials and lights."""
    from remac_env.kitchen.lights import add_lights
    from remac_env.kitchen.materials import add_materials

    add_materials(spec, style)
    add_lights(spec, style, ceiling=ceiling)
