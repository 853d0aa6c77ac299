"""OpenGL contexts have an owner: the process that made them, until it ends.

A forked child inherits contexts that it can neither use nor free: it would wait for ever for the driver's threads,
which were not forked. And at the interpreter's end contexts must go before their display does.
"""

from __future__ import annotations

import atexit
import ctypes
import logging
import os
import sys
import weakref
from typing import Any

_LOG = logging.getLogger(__name__)

_held: weakref.WeakSet[Any] = weakref.WeakSet()
_gone = ""
_told = True
_watched = False


def hold(renderer: Any) -> None:
    """Take note of a renderer of MuJoCo that has just been made: it is closed when the interpreter ends."""
    global _watched
    _held.add(renderer)
    if not _watched:
        # Not before: MuJoCo asks for the end of the display when it makes its first context, and what is registered
        # last comes first.
        atexit.register(_end)
        if hasattr(os, "register_at_fork"):
            os.register_at_fork(after_in_child=_after_fork)
        _watched = True


def gone() -> str:
    """Why OpenGL cannot be used by this process any more; "" where it can. What a fork took away is logged once."""
    global _told
    if not _told:
        _told = True
        _LOG.warning("pictures are made by rays in this process: %s", _gone)
    return _gone


def lost(renderer: Any) -> bool:
    """Whether a renderer belongs to the process that this one was forked from, or was closed at the end."""
    return bool(_gone) and renderer not in _held


def _end() -> None:
    global _gone
    _gone = "the interpreter is about to end"
    for renderer in list(_held):
        renderer.close()
    _held.clear()


def _after_fork() -> None:
    global _gone, _told
    _told = False
    _gone = (
        "OpenGL was used before this process was forked; start processes by \"spawn\" instead (AsyncVectorEnv(..., "
        'context="spawn"), multiprocessing.get_context("spawn")), or draw nothing before they are forked'
    )
    for renderer in list(_held):
        # Never freed: that, too, would wait for the driver.
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(renderer))
    _held.clear()
    atexit.unregister(_end)
    egl: Any = sys.modules.get("mujoco.egl")
    if egl is not None:
        atexit.unregister(egl.EGL.eglTerminate)
