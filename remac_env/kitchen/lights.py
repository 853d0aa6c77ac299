"""The light of the kitchen and what the classic renderer needs to know about the size of the scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import mujoco

    from remac_env.kitchen.style import Style

# Spots under the ceiling stand in for the room's lamps. They are inside the room because ceiling and side walls would
# keep a directional light out. All lights together light a white wall with about 1.0, so that whites do not burn out.
_LAMP_X = (-2.0, 0.2, 2.1)
_LAMP_Y, _LAMP_Z = -2.1, 2.42
_LAMP_STRENGTH, _OPEN_LAMP_STRENGTH = 0.165, 0.11
_LAMP_HIGHLIGHT = 0.10
_SKY_STRENGTH = 0.26
_FILL_STRENGTH, _OPEN_FILL_STRENGTH = 0.13, 0.17

BACKDROP = (0.90, 0.90, 0.89)
"""Colour of what lies outside the room, red, green, blue."""


def add_lights(spec: mujoco.MjSpec, style: Style | None = None, *, ceiling: bool = True) -> None:
    """Add head light, lamps, soft fills and a backdrop, and set clipping and shadow range for a kitchen.

    Without a style the lamps are warm white; without a ceiling light falls in from above. Call it once for a
    description.
    """
    import mujoco

    tint = (1.0, 0.97, 0.90) if style is None else style.lamp
    _set_scale(spec)
    _set_backdrop(spec)
    lamps, fill = (_LAMP_STRENGTH, _FILL_STRENGTH) if ceiling else (_OPEN_LAMP_STRENGTH, _OPEN_FILL_STRENGTH)
    head = spec.visual.headlight
    head.ambient, head.diffuse, head.specular = [0.42, 0.42, 0.43], [0.14] * 3, [0.02] * 3
    for number, x in enumerate(_LAMP_X):
        spec.worldbody.add_light(
            name=f"lamp_{number}",
            type=mujoco.mjtLightType.mjLIGHT_SPOT,
            pos=[x, _LAMP_Y, _LAMP_Z],
            dir=[-0.12 * x, 1.0, -0.62],
            cutoff=62,
            exponent=1.2,
            attenuation=[0.72, 0.03, 0.02],
            diffuse=[lamps * part for part in tint],
            specular=[_LAMP_HIGHLIGHT * part for part in tint],
            ambient=[0, 0, 0],
            castshadow=True,
        )
    if not ceiling:
        spec.worldbody.add_light(
            name="sky",
            type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
            pos=[0, -4, 6],
            dir=[0.15, 0.35, -1.0],
            diffuse=[_SKY_STRENGTH] * 3,
            specular=[0.02] * 3,
            ambient=[0, 0, 0],
            castshadow=False,
        )
    for side, name in ((1, "fill_left"), (-1, "fill_right")):
        spec.worldbody.add_light(
            name=name,
            type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
            pos=[-3 * side, -4, 3],
            dir=[0.65 * side, 0.60, -0.47],
            diffuse=[fill * part for part in (0.97, 1.0, 1.06)],
            specular=[0, 0, 0],
            ambient=[0, 0, 0],
            castshadow=False,
        )


def _set_scale(spec: mujoco.MjSpec) -> None:
    """Extent and centre drive clipping planes and shadow range."""
    spec.stat.extent = 4.5
    spec.stat.center = [0.0, -0.3, 1.0]
    depth = spec.visual.map
    depth.znear, depth.zfar = 0.002, 40.0
    depth.shadowclip, depth.shadowscale = 0.75, 0.9


def _set_backdrop(spec: mujoco.MjSpec) -> None:
    """What is seen where the room is open, instead of black."""
    import mujoco

    spec.add_texture(
        name="backdrop",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        rgb1=list(BACKDROP),
        rgb2=list(BACKDROP),
        width=8,
        height=48,
    )
