"""A window for render_mode="human", where there is a display; elsewhere it says so once and shows nothing."""

from __future__ import annotations

import logging
import os
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

_LOG = logging.getLogger(__name__)


class Window:
    """Shows pictures in a window of the desktop's Tk."""

    def __init__(self, title: str) -> None:
        self._root: Any = None
        self._label: Any = None
        if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
            _LOG.warning("render_mode='human' needs a display; none is set, so nothing is shown")
            return
        try:
            import tkinter
        except ImportError as error:
            _LOG.warning("render_mode='human' needs Tk: %s", error)
            return
        try:
            self._root = tkinter.Tk()
        except tkinter.TclError as error:
            _LOG.warning("render_mode='human' needs a display: %s", error)
            return
        self._root.title(title)
        self._label = tkinter.Label(self._root)
        self._label.pack()

    def show(self, picture: NDArray[np.uint8]) -> None:
        """Replace what is shown; picture: uint8 (height, width, 3)."""
        if self._root is None:
            return
        import tkinter

        height, width, _ = picture.shape
        data = b"P6 %d %d 255 " % (width, height) + picture.tobytes()
        # Tk forgets a picture that nothing else refers to.
        self._image = tkinter.PhotoImage(width=width, height=height, data=data, format="PPM")
        self._label.configure(image=self._image)
        self._root.update()

    def close(self) -> None:
        """Close the window. May be called twice."""
        if self._root is not None:
            self._root.destroy()
        self._root = None
