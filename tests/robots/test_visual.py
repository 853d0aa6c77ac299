"""The drawn robot changes nothing of the simulated one, is cheap to draw, and lies where its colliders are."""

from __future__ import annotations

import itertools

import mujoco
import numpy as np
import pytest

from remac_env.robots.panda import measures as panda
from remac_env.robots.panda import visual
from remac_env.robots.panda.model import add_robot
from remac_env.robots.panda.visual_parts import ACCENT, MATERIALS, SHELL, robot_parts

ROBOTS = {"robot_0": (0.1, 0.4, 0.8), "robot_1": (0.9, 0.5, 0.1)}
KINDS = ("BODY", "JOINT", "SITE", "ACTUATOR", "EQUALITY", "EXCLUDE")


def build(*, drawn: bool) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    for name, accent in ROBOTS.items():
        add_robot(spec, name, visual=drawn, accent=accent)
    return spec.compile()


@pytest.fixture(scope="module")
def bare() -> mujoco.MjModel:
    return build(drawn=False)


@pytest.fixture(scope="module")
def drawn() -> mujoco.MjModel:
    return build(drawn=True)


def drawn_geoms(model: mujoco.MjModel, robot: str) -> list[int]:
    return [
        geom
        for geom in range(model.ngeom)
        if model.geom_group[geom] == visual.DRAWN_GROUP
        and model.body(model.geom_bodyid[geom]).name.startswith(f"{robot}/")
    ]


@pytest.mark.parametrize("kind", KINDS)
def test_names_and_their_order_do_not_depend_on_looks(bare, drawn, kind: str) -> None:
    def names(model: mujoco.MjModel) -> list[str | None]:
        number = {"BODY": model.nbody, "JOINT": model.njnt, "SITE": model.nsite, "ACTUATOR": model.nu,
                  "EQUALITY": model.neq, "EXCLUDE": model.nexclude}[kind]
        return [mujoco.mj_id2name(model, getattr(mujoco.mjtObj, f"mjOBJ_{kind}"), index) for index in range(number)]

    assert names(bare) == names(drawn)


@pytest.mark.parametrize("field", ["mass", "inertia", "ipos", "iquat", "pos", "quat", "gravcomp"])
def test_bodies_do_not_depend_on_looks(bare, drawn, field: str) -> None:
    np.testing.assert_array_equal(getattr(bare, f"body_{field}"), getattr(drawn, f"body_{field}"))


def test_colliders_do_not_depend_on_looks(bare, drawn) -> None:
    solid = np.flatnonzero(drawn.geom_group != visual.DRAWN_GROUP)
    assert len(solid) == bare.ngeom
    for field in ("type", "size", "pos", "quat", "bodyid", "contype", "conaffinity", "friction", "solref"):
        np.testing.assert_array_equal(getattr(bare, f"geom_{field}"), getattr(drawn, f"geom_{field}")[solid])


@pytest.mark.parametrize("robot", ROBOTS)
def test_what_is_drawn_never_collides_and_is_cheap(drawn, robot: str) -> None:
    geoms = drawn_geoms(drawn, robot)
    assert not drawn.geom_contype[geoms].any()
    assert not drawn.geom_conaffinity[geoms].any()
    assert len(geoms) < 40
    assert sum(drawn.mesh_vertnum[drawn.geom_dataid[geom]] for geom in geoms) < 6000


def test_robots_share_meshes_and_differ_in_accent(drawn) -> None:
    meshes, colors = [], []
    for robot, accent in ROBOTS.items():
        meshes.append({int(drawn.geom_dataid[geom]) for geom in drawn_geoms(drawn, robot)})
        np.testing.assert_allclose(drawn.material(f"{robot}/{ACCENT}").rgba[:3], accent, atol=1e-6)
        colors.append([tuple(drawn.material(f"{robot}/{kind}").rgba) for kind in MATERIALS if kind != ACCENT])
    assert meshes[0] == meshes[1]
    assert len(meshes[0]) == drawn.nmesh
    assert colors[0] == colors[1]


def test_every_part_is_dressed_and_the_accent_is_high_and_low() -> None:
    parts = set(robot_parts())
    arm = ["base", "lift", "link0", *(link.name for link in panda.LINKS), "hand"]
    assert {(body, SHELL) for body in arm} <= parts
    assert {body for body, kind in parts if kind == ACCENT} == {"base", "link3", "link5", "hand"}


@pytest.mark.parametrize("part", ["link0", *(link.name for link in panda.LINKS), "hand", *panda.FINGERS])
def test_drawn_shape_lies_about_where_the_colliders_are(bare, part: str) -> None:
    """No drawn point stands out of the body's colliders by more than 2.5 cm, and the drawing is about as large."""
    vertices = np.concatenate([mesh.vertices for (body, _), mesh in robot_parts().items() if body == part])
    owner = bare.body(f"robot_0/{part}").id
    geoms = [geom for geom in range(bare.ngeom) if bare.geom_bodyid[geom] == owner]
    outside = np.min([distance(bare, geom, vertices) for geom in geoms], axis=0)
    assert outside.max() < 0.025
    if part == "link0":  # its capsule also reaches down through the plate that carries it
        return
    corners = np.concatenate([box(bare, geom) for geom in geoms])
    np.testing.assert_allclose(vertices.min(axis=0), corners.min(axis=0), atol=0.06)
    np.testing.assert_allclose(vertices.max(axis=0), corners.max(axis=0), atol=0.06)


def test_base_has_the_outline_of_its_collider(bare) -> None:
    owner = bare.body("robot_0/base").id
    corners = np.concatenate([box(bare, geom) for geom in range(bare.ngeom) if bare.geom_bodyid[geom] == owner])
    vertices = np.concatenate([mesh.vertices for (body, _), mesh in robot_parts().items() if body == "base"])
    np.testing.assert_allclose(vertices.min(axis=0)[:2], corners.min(axis=0)[:2], atol=0.005)
    np.testing.assert_allclose(vertices.max(axis=0), corners.max(axis=0), atol=0.005)


def distance(model: mujoco.MjModel, geom: int, points: np.ndarray) -> np.ndarray:
    """Signed distance (n,) of points in the body's frame from a capsule or box of that body."""
    local = in_geom(model, geom, points)
    size = model.geom_size[geom]
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_CAPSULE:
        local[:, 2] -= np.clip(local[:, 2], -size[1], size[1])
        return np.linalg.norm(local, axis=1) - size[0]
    over = np.abs(local) - size
    return np.linalg.norm(np.maximum(over, 0.0), axis=1) + np.minimum(over.max(axis=1), 0.0)


def box(model: mujoco.MjModel, geom: int) -> np.ndarray:
    """Lowest and highest corner (2, 3) of a capsule, cylinder or box, in the body's frame."""
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, model.geom_quat[geom])
    turn = turn.reshape(3, 3)
    size = model.geom_size[geom]
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_CAPSULE:
        reach = np.abs(turn[:, 2]) * size[1] + size[0]
    elif model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_CYLINDER:
        reach = np.abs(turn[:, 2]) * size[1] + size[0] * np.sqrt(1 - np.minimum(turn[:, 2] ** 2, 1.0))
    else:
        reach = np.max([np.abs(turn @ (size * sign)) for sign in itertools.product((1, -1), repeat=3)], axis=0)
    return np.stack([model.geom_pos[geom] - reach, model.geom_pos[geom] + reach])


def in_geom(model: mujoco.MjModel, geom: int, points: np.ndarray) -> np.ndarray:
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, model.geom_quat[geom])
    return (points - model.geom_pos[geom]) @ turn.reshape(3, 3)


def test_meshes_are_sound() -> None:
    for key, mesh in robot_parts().items():
        assert np.isfinite(mesh.vertices).all(), key
        np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-6)
        corners = mesh.vertices[mesh.faces]
        facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert (np.einsum("ij,ikj->ik", facing, mesh.normals[mesh.faces]) > 0).all(), key


def test_column_stays_in_its_sleeve_when_all_the_way_up() -> None:
    column, sleeve = robot_parts()["lift", "metal"], robot_parts()["base", SHELL]
    bottom = panda.MOUNT_HEIGHT + panda.TORSO_RANGE[1] + column.bounds[0][2]
    assert bottom < sleeve.bounds[1][2]
