"""Which objects of a model a camera cannot see because they are beside or behind it."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray


def out_of_view(model: mujoco.MjModel, data: mujoco.MjData, camera: int, aspect: float) -> NDArray[np.bool_]:
    """Whether the ball around each geom lies wholly outside what a camera sees, (ngeom,); never so for planes.

    aspect: width of the picture by its height. Positions in `data` must be computed.
    """
    radius = model.geom_rbound
    x, y, back = ((data.geom_xpos - data.cam_xpos[camera]) @ data.cam_xmat[camera].reshape(3, 3)).T
    half = np.tan(np.deg2rad(model.cam_fovy[camera]) / 2)
    outside = back > radius
    for offset, slope in ((x, half * aspect), (y, half)):
        outside |= np.abs(offset) + back * slope > radius * np.hypot(1.0, slope)
    return outside & (radius > 0)
