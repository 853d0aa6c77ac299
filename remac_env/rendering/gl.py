"""Finds out which OpenGL platform works here, without ever risking the process that asks.

A platform that is only half installed breaks `import mujoco` when MUJOCO_GL names it, and a renderer that failed once
makes the next one abort the process. So platforms are tried in a subprocess, MUJOCO_GL is read but never set, and the
one that works is handed to MuJoCo afterwards. A success is remembered in a small file for as long as MuJoCo, the
environment and the installed libraries stay the same; a failure is not, so that installing a library helps at once.
"""

from __future__ import annotations

import hashlib
import importlib
import json
import os
import platform
import subprocess
import sys
import tempfile
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from remac_env.errors import RenderingError

_OFF = ("disable", "disabled", "off", "false", "0")
_ANY = ("", "enable", "enabled", "on", "true", "1")
_PLATFORMS = {"Linux": ("egl", "osmesa", "glfw"), "Darwin": ("cgl",), "Windows": ("glfw",)}
_SAME_AS = {"glx": "glfw", "wgl": "glfw"}
_INSTALL = "apt-get install --no-install-recommends libegl1 libegl-mesa0 libgl1-mesa-dri libopengl0"

# What decides whether a platform works, beside MuJoCo's version and the installed libraries.
_RELEVANT = (
    "MUJOCO_GL", "PYOPENGL_PLATFORM", "MUJOCO_EGL_DEVICE_ID", "DISPLAY", "WAYLAND_DISPLAY", "LD_LIBRARY_PATH",
    "LIBGL_DRIVERS_PATH", "CUDA_VISIBLE_DEVICES", "EGL_PLATFORM",
)  # fmt: skip
_LIBRARY_LISTS = ("/etc/ld.so.cache", "/usr/share/glvnd/egl_vendor.d", "/usr/lib/x86_64-linux-gnu/dri")

_TRIAL_SECONDS = 30.0  # a software driver's first picture takes about one
_TRIAL = """
import mujoco
model = mujoco.MjModel.from_xml_string(
    '<mujoco><worldbody><light pos="0 0 3"/><geom size=".3" rgba="1 0 0 1"/></worldbody></mujoco>')
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
renderer = mujoco.Renderer(model, 16, 16)
renderer.update_scene(data)
picture = renderer.render()
renderer.close()
raise SystemExit(0 if picture.max() > 60 else 3)
"""

_answers: dict[str, str | None] = {}
_complaints: dict[str, str] = {}


def probe() -> str | None:
    """The platform that works ("egl", "osmesa", "glfw" or "cgl"), or None where none does or MUJOCO_GL forbids it.

    Takes a second on first use, then the answer is remembered. Raises RenderingError where MUJOCO_GL names a platform
    that does not exist or does not work here.
    """
    key = _key()
    if key not in _answers:
        asked = _asked()
        if asked is None:
            return None
        candidates = (asked,) if asked else _candidates()
        _answers[key] = _remembered(key, candidates) or _try_all(key, candidates)
    answer = _answers[key]
    if answer is None and _asked():
        raise RenderingError(_wrong_value())
    return answer


def activate(name: str) -> None:
    """Make MuJoCo's renderer use a platform found by `probe`. Raises RenderingError where it cannot be loaded."""
    try:
        module: Any = importlib.import_module(f"mujoco.{name}")
        holder: Any = importlib.import_module("mujoco.rendering.classic.gl_context")
        holder.GLContext = module.GLContext
    except (ImportError, AttributeError, OSError, RuntimeError) as error:
        raise RenderingError(f"the OpenGL platform {name!r} cannot be loaded: {error}") from error


def forget(name: str) -> None:
    """Drop a remembered platform that turned out not to work; this process will not try OpenGL again."""
    key = _key()
    _answers[key] = None
    _complaints.setdefault(name, "it failed when it was used")
    path = _memory_file()
    try:
        if path is not None:
            path.unlink(missing_ok=True)
    except OSError:
        return  # an unwritable cache is no reason to fail: the answer in this process is what counts


def advice() -> str:
    """What to do where no platform works."""
    if _asked() is None:
        return "MUJOCO_GL forbids OpenGL: unset it to have one looked for"
    tried = "; ".join(f"{name}: {problem}" for name, problem in _complaints.items())
    return f"no OpenGL platform works here ({tried}); on Debian: {_INSTALL}; without one pictures are made by rays"


def _asked() -> str | None:
    """What MUJOCO_GL asks for: a platform, "" for any, None for no OpenGL at all."""
    value = os.environ.get("MUJOCO_GL", "").lower().strip()
    if value in _OFF:
        return None
    return "" if value in _ANY else _SAME_AS.get(value, value)


def _candidates() -> tuple[str, ...]:
    names = _PLATFORMS.get(platform.system(), ("glfw",))
    if platform.system() == "Linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return tuple(name for name in names if name != "glfw")
    return names


def _wrong_value() -> str:
    value = os.environ.get("MUJOCO_GL", "")
    problem = _complaints.get(_asked() or "", "it gives no picture")
    return (
        f"MUJOCO_GL={value!r} does not work here ({problem}); unset it to let a working one be found, choose one of "
        f"{', '.join(_candidates())}, or set MUJOCO_GL=disable for rays; on Debian: {_INSTALL}"
    )


def _try_all(key: str, candidates: tuple[str, ...]) -> str | None:
    valid = _PLATFORMS.get(platform.system(), ("glfw",))
    for name in candidates:
        if name not in valid:
            _complaints[name] = f"valid values: {', '.join(valid)}"
        elif _works(name):
            _remember(key, name)
            return name
    return None


def _works(name: str) -> bool:
    """Draw one picture with the platform in a process of its own."""
    if not sys.executable:
        _complaints[name] = "there is no Python executable to try it with"
        return False
    command = [sys.executable, "-P", "-c", _TRIAL]
    environment = {**os.environ, "MUJOCO_GL": name}
    try:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, errors="replace", timeout=_TRIAL_SECONDS,
            stdin=subprocess.DEVNULL, check=False,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        _complaints[name] = str(error)
        return False
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines()
        _complaints[name] = lines[-1][:200] if lines else f"exit status {done.returncode}"
    return done.returncode == 0


def _key() -> str:
    """A digest of everything on which the answer depends."""
    try:
        mujoco_version = version("mujoco")
    except PackageNotFoundError:
        mujoco_version = "none"
    facts = [mujoco_version, sys.executable, platform.node(), platform.release()]
    facts += [f"{name}={os.environ.get(name)}" for name in _RELEVANT]
    facts += [f"{path}@{_changed(path)}" for path in _LIBRARY_LISTS]
    return hashlib.sha256("\n".join(facts).encode()).hexdigest()[:32]


def _changed(path: str) -> int:
    try:
        return os.stat(path).st_mtime_ns
    except OSError:
        return 0


def _memory_file() -> Path | None:
    """Where the answer is remembered; None for a user without a folder."""
    home = os.path.expanduser("~")
    cache = os.environ.get("XDG_CACHE_HOME") or (os.path.join(home, ".cache") if os.path.isabs(home) else None)
    return None if cache is None else Path(cache) / "remac_env" / "gl.json"


def _remembered(key: str, candidates: tuple[str, ...]) -> str | None:
    """The platform remembered under this key, if the file is sound and the platform one that would be tried."""
    path = _memory_file()
    try:
        stored = None if path is None else json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    name = stored.get(key) if isinstance(stored, dict) else None
    return name if isinstance(name, str) and name in candidates else None


def _remember(key: str, name: str) -> None:
    """Write the one answer, whole or not at all; a cache that cannot be written is not needed."""
    path = _memory_file()
    if path is None:
        return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, draft = tempfile.mkstemp(dir=path.parent, prefix="gl-")
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            json.dump({key: name}, stream)
        os.replace(draft, path)
    except OSError:
        return
