"""Draws a mobile Panda (meshes in geom group 1, never colliding, massless).

White shells over dark joints, as the manufacturer's arm. The accent colour tells robots apart from all sides: a band
around the base and a panel on its deck, the column, rings on upper arm and forearm, and a band around the hand.
All but the last are 4 cm wide or more, about a pixel of a picture of 128 by 128 of a whole kitchen.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from remac_env.kitchen.materials import add_finish
from remac_env.kitchen.meshes import add_mesh
from remac_env.kitchen.style import Finish
from remac_env.robots.panda.visual_parts import ACCENT, JOINT, METAL, RUBBER, SHELL, robot_parts

if TYPE_CHECKING:
    import mujoco

DRAWN_GROUP = 1

_FINISHES = {
    SHELL: Finish(color=(0.93, 0.94, 0.95), specular=0.45, shininess=0.6),
    JOINT: Finish(color=(0.15, 0.16, 0.18), specular=0.35, shininess=0.5),
    METAL: Finish(color=(0.56, 0.58, 0.61), specular=0.7, shininess=0.7),
    RUBBER: Finish(color=(0.07, 0.07, 0.08), specular=0.1, shininess=0.2),
}


def dress(
    spec: mujoco.MjSpec, name: str, bodies: dict[str, mujoco.MjsBody], accent: tuple[float, float, float]
) -> None:
    """Draw the robot ``name`` on its bodies (by short name), in white with ``accent`` (RGB, 0..1).

    Materials are called ``<robot>/<material>``; meshes ``panda/<body>/<material>``, and all robots of ``spec``
    share them.
    """
    import mujoco

    red, green, blue = (float(part) for part in accent)
    finishes = {**_FINISHES, ACCENT: Finish(color=(red, green, blue), specular=0.4, shininess=0.6)}
    for material, finish in finishes.items():
        add_finish(spec, f"{name}/{material}", finish)
    for (body, material), mesh in robot_parts().items():
        mesh_name = f"panda/{body}/{material}"
        if spec.mesh(mesh_name) is None:
            add_mesh(spec, mesh_name, mesh)
        bodies[body].add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh_name, material=f"{name}/{material}", mass=0.0,
            contype=0, conaffinity=0, group=DRAWN_GROUP,
        )
