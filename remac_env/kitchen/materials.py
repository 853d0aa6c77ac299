"""Materials: puts the finishes of a style into an MjSpec.

Materials are named by role ("floor", "base_door", "handle" …, see `style.roles`), textures "texture/<role>". Textures
stand for one metre of surface: meshes carry texture coordinates in metres, planes repeat them once a metre.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from remac_env.kitchen.style import Finish, Style
from remac_env.kitchen.textures import Image, texture

if TYPE_CHECKING:
    import mujoco

TEXTURE_SIZE = 512
"""Pixels a metre of surface: 2 mm each, about one pixel of a picture of the whole kitchen 1280 wide."""

# MuJoCo repeats a uniform texture texrepeat / 2 times a metre on a plane.
_ONCE_A_METRE = (2.0, 2.0)


def add_materials(spec: mujoco.MjSpec, style: Style, *, texture_size: int = TEXTURE_SIZE) -> None:
    """Add a material for every role of the style, with its texture where it has a pattern."""
    for role, finish in style.finishes.items():
        add_finish(spec, role, finish, texture_size=texture_size)


def add_finish(spec: mujoco.MjSpec, name: str, finish: Finish, *, texture_size: int = TEXTURE_SIZE) -> None:
    """Add one material under `name`."""
    image = texture(finish.pattern, texture_size, finish.color, finish.accent) if finish.pattern else None
    add_material(spec, name, finish, image)


def add_material(spec: mujoco.MjSpec, name: str, finish: Finish, image: Image | None) -> None:
    """Add one material under `name`; an image takes the place of the finish's colour."""
    color = finish.color if image is None else (finish.tint,) * 3
    material = spec.add_material(
        name=name,
        rgba=[*color, finish.opacity],
        specular=finish.specular,
        shininess=finish.shininess,
        reflectance=finish.reflectance,
        emission=finish.emission,
        texrepeat=list(_ONCE_A_METRE),
        texuniform=True,
    )
    if image is not None:
        material.textures = _texture_slots(add_texture(spec, f"texture/{name}", image))


def add_texture(spec: mujoco.MjSpec, name: str, image: Image) -> str:
    """Add an image (height, width, 3) uint8 as a texture and return its name."""
    import mujoco

    height, width, channels = image.shape
    added = spec.add_texture(
        name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, width=width, height=height, nchannel=channels
    )
    added.data = image.tobytes()
    return name


def _texture_slots(name: str) -> list[str]:
    import mujoco

    slots = [""] * int(mujoco.mjtTextureRole.mjNTEXROLE)
    slots[int(mujoco.mjtTextureRole.mjTEXROLE_RGB)] = name
    return slots
