"""Puts the drawn shapes of things into an MjSpec. Drawn geoms weigh nothing and touch nothing."""

from __future__ import annotations

from typing import Any

import mujoco

from remac_env.kitchen.materials import add_material
from remac_env.kitchen.mesh import add_mesh
from remac_env.kitchen.objects.catalogue import Category
from remac_env.kitchen.objects.shapes import shape
from remac_env.kitchen.style import Finish

DRAWN_GROUP = 1
_DRAWN: dict[str, Any] = {"contype": 0, "conaffinity": 0, "group": DRAWN_GROUP, "mass": 0.0}


def draw(spec: mujoco.MjSpec, body: mujoco.MjsBody, noun: str, category: Category) -> None:
    """Draw a thing on its body; meshes, textures and materials are named "<noun>/<number>"."""
    if not category.look:
        _draw_colliders(spec, body, noun, category)
        return
    for number, part in enumerate(shape(category.look)):
        name = f"{noun}/{number}"
        add_mesh(spec, name, part.mesh)
        add_material(spec, name, part.finish, part.picture)
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, material=name, **_DRAWN)


def _draw_colliders(spec: mujoco.MjSpec, body: mujoco.MjsBody, noun: str, category: Category) -> None:
    """For things without a shape of their own: their colliders once more, in the category's colour."""
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
