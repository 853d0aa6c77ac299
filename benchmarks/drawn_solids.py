"""How far what is drawn of a kitchen stands out of what is solid; `benchmarks/solids.py` prints it."""

from __future__ import annotations

from collections.abc import Iterable

import mujoco
import numpy as np
from numpy.typing import NDArray

from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.canvas import COLLIDER_GROUP, DRAWN_GROUP, FINE_GROUP, SWITCHED

Floats = NDArray[np.float64]


def standing_out(layout: str, style: str) -> dict[tuple[str, str], float]:
    """How far (m) the corners of drawn meshes stand out of all colliders, by kind of fixture and role of material.

    Water, flames and lamps, which are seen only while they are on, are left out.
    """
    made = styles.load(style)
    model = build_model(layouts.load(layout, made.models), robots=(), objects={}, style=made, visual=True)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    solid = np.flatnonzero(model.geom_group == COLLIDER_GROUP)
    found: dict[tuple[str, str], float] = {}
    for geom in np.flatnonzero(np.isin(model.geom_group, (DRAWN_GROUP, FINE_GROUP))):
        if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_MESH or SWITCHED in model.geom(geom).name:
            continue
        mesh = model.mesh(model.geom_dataid[geom])
        first, count = int(mesh.vertadr[0]), int(mesh.vertnum[0])
        corners = model.mesh_vert[first : first + count] @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        body = model.body(model.geom_bodyid[geom]).name
        key = body.partition("/")[0].partition(".")[0], model.mat(model.geom_matid[geom]).name
        found[key] = max(found.get(key, 0.0), float(_outside(model, data, solid, corners).max()))
    return found


def _outside(model: mujoco.MjModel, data: mujoco.MjData, solid: Iterable[int], points: Floats) -> Floats:
    """Distances (n,) of points (n, 3) from the nearest collider, negative inside of one."""
    return np.min([_distance(model, data, geom, points) for geom in solid], axis=0)


def _distance(model: mujoco.MjModel, data: mujoco.MjData, geom: int, points: Floats) -> Floats:
    kind, size = model.geom_type[geom], model.geom_size[geom]
    local = (points - data.geom_xpos[geom]) @ data.geom_xmat[geom].reshape(3, 3)
    if kind == mujoco.mjtGeom.mjGEOM_PLANE:
        return local[:, 2]
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        along = np.clip(local[:, 2], -size[1], size[1])
        return np.hypot(np.hypot(local[:, 0], local[:, 1]), local[:, 2] - along) - size[0]
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        beyond = np.stack([np.hypot(local[:, 0], local[:, 1]) - size[0], np.abs(local[:, 2]) - size[1]], axis=1)
    elif kind == mujoco.mjtGeom.mjGEOM_BOX:
        beyond = np.abs(local) - size
    else:
        raise ValueError(f"no furniture is made of colliders of kind {kind}")
    return np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + np.minimum(beyond.max(axis=1), 0.0)
