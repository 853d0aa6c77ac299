"""Loads MuJoCo and OpenCV when they are needed, and says what to do where they cannot be loaded."""

from __future__ import annotations

import os
from typing import Any

from remac_env.errors import RenderingError


def load_mujoco() -> None:
    """Import mujoco.

    Raises:
        RenderingError: if MUJOCO_GL names a platform that does not exist or is not installed; MuJoCo then cannot even
            be imported, so that physics does not run either.
    """
    try:
        import mujoco  # noqa: F401
    except (RuntimeError, AttributeError, ImportError) as error:
        value = os.environ.get("MUJOCO_GL")
        if value is None:
            raise
        raise RenderingError(
            f"MuJoCo cannot be imported with MUJOCO_GL={value!r} ({error}); unset MUJOCO_GL and start again: a "
            "platform that works is then found, and where none does pictures are made by rays (MUJOCO_GL=disable "
            "forces rays)"
        ) from error


def load_opencv() -> Any:
    """The module cv2, for whatever draws; what draws nothing runs without it.

    Raises:
        RenderingError: if it is not installed.
    """
    try:
        import cv2
    except ImportError as error:
        raise RenderingError(
            "pictures and videos need OpenCV, which is not installed; install it: opencv-python-headless"
        ) from error
    return cv2
