"""Pictures without OpenGL: one ray a pixel, the mean colour of each material, two lights, no shadows."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from remac_env.kitchen.canvas import HIDDEN_GROUP
from remac_env.kitchen.lights import BACKDROP
from remac_env.rendering.signs import SIGN

Floats = NDArray[np.float64]

_NO_COLOR = np.array([0.5, 0.5, 0.5, 1.0], dtype=np.float32)  # MuJoCo's default, overruled by a material
_OPAQUE = 0.99
_PASSES = 3  # an opaque object behind two panes of glass or water is still seen
_PASSES_OF_SIGNS = 8  # the same behind steam, where things take their time
_AMBIENT, _FACING = 0.42, 0.20
_LIGHTS = (((-0.35, -0.75, 0.56), 0.42), ((0.70, -0.50, 0.45), 0.12))  # direction towards the light, strength


class RayPainter:
    """Casts rays into a model. Its colours are read at each picture, so that they may be changed."""

    def __init__(self, model: mujoco.MjModel, width: int, height: int, *, groups: Sequence[int]) -> None:
        """groups: the geom groups that are drawn."""
        self._model, self._width, self._height = model, width, height
        self._groups = np.array([group in groups for group in range(mujoco.mjNGROUP)], dtype=np.uint8)
        self._textures = _mean_textures(model)
        signs = any(SIGN in model.geom(geom).name for geom in range(model.ngeom))
        self._passes = _PASSES_OF_SIGNS if signs else _PASSES

    def render(self, data: mujoco.MjData, camera: int) -> NDArray[np.uint8]:
        """The picture of a camera, (height, width, 3)."""
        colors, emission = self._geom_colors()
        origin, directions = self._rays(data, camera)
        count = len(directions)
        picture, to_come = np.zeros((count, 3)), np.ones(count)
        hidden = colors[:, 3] <= 0
        for _ in range(self._passes):
            geoms, normals = self._cast(data, origin, directions, hidden)
            hit = geoms >= 0
            shade = np.maximum(_brightness(normals, directions), emission[geoms])
            seen = np.where(hit[:, None], colors[geoms, :3] * shade[:, None], BACKDROP)
            cover = np.where(hit, colors[geoms, 3], 1.0)
            picture += (to_come * cover)[:, None] * seen
            to_come *= 1 - cover
            clear = np.unique(geoms[hit & (cover < _OPAQUE)])
            if not len(clear):
                break
            hidden[clear] = True
        return (np.clip(picture, 0, 1) * 255).astype(np.uint8).reshape(self._height, self._width, 3)

    def segment(self, data: mujoco.MjData, camera: int) -> NDArray[np.int32]:
        """Which geom each ray of a camera meets first, (height, width); -1 for none."""
        origin, directions = self._rays(data, camera)
        geoms, _ = self._cast(data, origin, directions, self._geom_colors()[0][:, 3] <= 0)
        return geoms.reshape(self._height, self._width)

    def close(self) -> None:
        """Nothing to free."""

    def _cast(
        self, data: mujoco.MjData, origin: Floats, directions: Floats, hidden: NDArray[np.bool_]
    ) -> tuple[NDArray[np.int32], Floats]:
        """The first geom on each ray, -1 for none, and the surface normal there; hidden geoms let rays pass."""
        count, groups = len(directions), self._model.geom_group
        geoms, distances, normals = np.full(count, -1, np.int32), np.zeros(count), np.zeros(3 * count)
        before = groups.copy()
        groups[hidden] = HIDDEN_GROUP
        try:
            mujoco.mj_multiRay(
                self._model, data, origin, directions.ravel(), self._groups, 1, -1, geoms, distances, normals, count,
                mujoco.mjMAXVAL,
            )  # fmt: skip
        finally:
            groups[:] = before
        return geoms, normals.reshape(-1, 3)

    def _rays(self, data: mujoco.MjData, camera: int) -> tuple[Floats, Floats]:
        """Where a camera is (3,) and the unit directions (height * width, 3) of its pixels, row by row from the top."""
        half = np.tan(np.deg2rad(self._model.cam_fovy[camera]) / 2)
        rows, columns = np.mgrid[0 : self._height, 0 : self._width]
        x = (2 * (columns + 0.5) / self._width - 1) * half * self._width / self._height
        y = (1 - 2 * (rows + 0.5) / self._height) * half
        directions = np.stack([x, y, -np.ones_like(x)], axis=-1).reshape(-1, 3) @ data.cam_xmat[camera].reshape(3, 3).T
        return data.cam_xpos[camera].copy(), directions / np.linalg.norm(directions, axis=1, keepdims=True)

    def _geom_colors(self) -> tuple[Floats, Floats]:
        """Colour with opacity (n, 4) and emission (n,) of each geom: its own colour if any, else its material's."""
        model = self._model
        colors, emission = model.geom_rgba.astype(float), np.zeros(model.ngeom)
        dressed = model.geom_matid >= 0
        plain = dressed & np.all(model.geom_rgba == _NO_COLOR, axis=1)
        materials = model.mat_rgba.astype(float)
        materials[:, :3] *= self._textures
        colors[plain] = materials[model.geom_matid[plain]]
        emission[dressed] = model.mat_emission[model.geom_matid[dressed]]
        return colors, emission


def _brightness(normals: Floats, directions: Floats) -> Floats:
    """How light a surface is, (n,), from its normal and the ray that hit it."""
    facing = np.einsum("ij,ij->i", normals, directions)
    outward = np.where(facing[:, None] > 0, -normals, normals)
    total = _AMBIENT + _FACING * np.abs(facing)
    for towards, strength in _LIGHTS:
        total = total + strength * np.clip(outward @ np.array(towards), 0, 1)
    return total


def _mean_textures(model: mujoco.MjModel) -> Floats:
    """The mean colour of each material's texture, (n, 3); 1 where it has none."""
    colors = np.ones((model.nmat, 3))
    role = int(mujoco.mjtTextureRole.mjTEXROLE_RGB)
    for material in range(model.nmat):
        texture = model.mat_texid[material, role]
        if texture >= 0:
            channels, start = model.tex_nchannel[texture], model.tex_adr[texture]
            size = model.tex_width[texture] * model.tex_height[texture] * channels
            texels = model.tex_data[start : start + size].reshape(-1, channels)[:, :3]
            colors[material] = texels.mean(axis=0) / 255
    return colors
