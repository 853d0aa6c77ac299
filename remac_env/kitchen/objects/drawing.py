"""Puts the drawn shapes of objects into an MjSpec. Drawn geoms weigh nothing and touch nothing."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import mujoco

from remac_env.kitchen.marked import marked
from remac_env.kitchen.materials import add_material
from remac_env.kitchen.mesh import add_mesh
from remac_env.kitchen.objects.catalogue import Category
from remac_env.kitchen.objects.grains import SEASONED_GEOM, STAIN, STAINED_GEOM, finish, grains, stains
from remac_env.kitchen.objects.shapes import shape
from remac_env.kitchen.objects.tints import tint_of, tinted
from remac_env.kitchen.style import Finish

DRAWN_GROUP = 1
_DRAWN: dict[str, Any] = {"contype": 0, "conaffinity": 0, "group": DRAWN_GROUP, "mass": 0.0}


def draw(
    spec: mujoco.MjSpec, body: mujoco.MjsBody, noun: str, category: Category, *, stained: bool = False
) -> None:
    """Draw an object on its body; meshes, textures and materials are named "<noun>/<number>"."""
    if not category.look:
        _draw_colliders(spec, body, noun, category)
        return
    tint = tint_of(noun, category.name)
    parts = shape(category.look) if tint is None else tinted(shape(category.look), tint)
    for number, part in enumerate(parts):
        name = f"{noun}/{number}"
        add_mesh(spec, name, part.mesh)
        add_material(spec, name, part.finish, part.picture)
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, material=name, **_DRAWN)
    _draw_grains(spec, body, noun, category)
    if stained:
        name = f"{noun}{STAINED_GEOM}"
        add_mesh(spec, name, stains(category.name, shape(category.look)))
        add_material(spec, name, STAIN, None)
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, name=name, meshname=name, material=name, **_DRAWN)


def _draw_grains(spec: mujoco.MjSpec, body: mujoco.MjsBody, noun: str, category: Category) -> None:
    """Grains of seasoning, invisible until `show_seasoned` shows them."""
    name = f"{noun}{SEASONED_GEOM}"
    parts = shape(category.look)
    look = finish(parts)
    add_mesh(spec, name, grains(category.name, parts))
    add_material(spec, name, look, None)
    hidden = [*look.color, 0.0]
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH, name=name, meshname=name, material=name, rgba=hidden, **_DRAWN
    )


def show_seasoned(model: mujoco.MjModel, seasoned: Collection[str]) -> None:
    """Make the grains on these objects visible in a drawn model, and those on all others invisible."""
    for geom, noun in marked(model, SEASONED_GEOM):
        model.geom_rgba[geom, 3] = float(noun in seasoned)


def show_stains(model: mujoco.MjModel, clean: Collection[str]) -> None:
    """Make the stains on these objects invisible in a drawn model, and those on all others visible."""
    for geom, noun in marked(model, STAINED_GEOM):
        model.geom_rgba[geom] = [*STAIN.color, float(noun not in clean)]


def _draw_colliders(spec: mujoco.MjSpec, body: mujoco.MjsBody, noun: str, category: Category) -> None:
    """For objects without a shape of their own: their colliders once more, in the category's colour."""
    name = f"{noun}/0"
    add_material(spec, name, Finish(color=category.color), None)
    for collider in list(body.geoms):
        body.add_geom(
            type=collider.type,
            pos=collider.pos,
            quat=collider.quat,
            size=collider.size,
            fromto=collider.fromto,
            material=name,
            **_DRAWN,
        )
