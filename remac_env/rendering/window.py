"""A window for render_mode="human": MuJoCo's viewer where there is a display; elsewhere it says so once."""

from __future__ import annotations

import logging
import os
import sys
from typing import Any

import mujoco

_LOG = logging.getLogger(__name__)


class Window:
    """MuJoCo's passive viewer, which can be turned and zoomed with the mouse; closing it ends no episode."""

    def __init__(self) -> None:
        self._viewer: Any = None
        self._model: mujoco.MjModel | None = None
        self._dark = sys.platform.startswith("linux") and not os.environ.get("DISPLAY")
        if self._dark:
            _LOG.warning("render_mode='human' needs a display; none is set, so nothing is shown")

    def show(self, model: mujoco.MjModel, data: mujoco.MjData, camera: str) -> None:
        """Show the model as `data` pose it, at first from the named camera; another model gets another window."""
        if self._dark:
            return
        if self._model is not model:
            self.close()
            self._model = model
            self._viewer = self._opened(model, data, camera)
        if self._viewer is not None and self._viewer.is_running():
            self._viewer.sync()

    def close(self) -> None:
        """Close the window. May be called twice."""
        if self._viewer is not None:
            self._viewer.close()
        self._viewer = self._model = None

    def _opened(self, model: mujoco.MjModel, data: mujoco.MjData, camera: str) -> Any:
        """A viewer, or None where the system has none to offer (said once)."""
        try:
            # Needs glfw, which wants a display to initialise.
            import glfw
            import mujoco.viewer

            if not glfw.init():
                raise RuntimeError("GLFW finds no display")
            viewer = mujoco.viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False)
        except (ImportError, RuntimeError) as error:
            self._dark = True
            _LOG.warning("render_mode='human' needs a display for MuJoCo's viewer: %s", error)
            return None
        with viewer.lock():
            viewer.cam.type = mujoco.mjtCamera.mjCAMERA_FIXED
            viewer.cam.fixedcamid = model.camera(camera).id
        return viewer
