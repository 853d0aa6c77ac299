"""Pictures of a model: with OpenGL where it works, else with rays. One call for both."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Literal, Protocol

import mujoco
import numpy as np
from numpy.typing import NDArray

from remac_env.errors import OptionError, RenderingError, check_choice
from remac_env.kitchen.canvas import COARSE_GROUP, DRAWN_GROUP, FINE_GROUP, HIDDEN_GROUP
from remac_env.quoting import quoted
from remac_env.rendering import contexts, gl
from remac_env.rendering.rays import RayPainter
from remac_env.rendering.sight import out_of_view
from remac_env.simulator import load_opencv

Backend = Literal["auto", "gl", "rays"]
BACKENDS: tuple[Backend, ...] = ("auto", "gl", "rays")

_LARGEST = 4096  # pixels on a side: beyond this, software drivers refuse the buffer


@dataclass(frozen=True)
class Quality:
    """Trade of looks for speed.

    shadow_size: of the shadow map, pixels; 0 for no shadows. finer: a picture is drawn this many times as wide and high
    and averaged (multisampling leaves dashes along the edges of panels). slices, stacks: facets of MuJoCo's own round
    shapes. mirrors: whether the floor mirrors. coarse: whether boards and bars have sharp edges.
    """

    shadow_size: int
    finer: int
    slices: int
    stacks: int
    mirrors: bool
    coarse: bool = False

    @property
    def shadows(self) -> bool:
        """Whether lamps cast shadows."""
        return self.shadow_size > 0

    @property
    def groups(self) -> tuple[int, int]:
        """The groups of geoms that are drawn."""
        return DRAWN_GROUP, COARSE_GROUP if self.coarse else FINE_GROUP


OBSERVATION = Quality(shadow_size=0, finer=1, slices=12, stacks=6, mirrors=False, coarse=True)
"""For small pictures: 4 to 10 ms of CPU time for 128 by 128 pixels of a kitchen without a GPU."""

CLOSE = Quality(shadow_size=0, finer=1, slices=16, stacks=8, mirrors=False)
"""For larger ones that checkers look at: about 30 ms for 512 by 512 there."""

VIDEO = Quality(shadow_size=1024, finer=1, slices=16, stacks=8, mirrors=False)
"""For videos: about 0.2 s for 768 by 432 there, so that one of 150 frames takes 40 s."""

BEAUTY = Quality(shadow_size=2048, finer=3, slices=28, stacks=16, mirrors=True)
"""For people: about 0.8 s for 768 by 432 there."""


class Painter(Protocol):
    """What draws: OpenGL or rays."""

    def render(self, data: mujoco.MjData, camera: int) -> NDArray[np.uint8]:
        """The picture, (height, width, 3)."""

    def segment(self, data: mujoco.MjData, camera: int) -> NDArray[np.int32]:
        """Which geom is seen, (height, width); -1 for none."""

    def close(self) -> None:
        """Free what it holds."""


class Renderer:
    """Draws the cameras of one model. Close it, or use it in a `with` statement.

    Colliders (group 3) and sites are not drawn. A process that was forked after OpenGL had been used draws by rays,
    with what it inherited and with what it makes. Copies, pickled ones too, get a context of their own.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        width: int,
        height: int,
        *,
        quality: Quality = OBSERVATION,
        backend: Backend = "auto",
    ) -> None:
        """quality: OBSERVATION, CLOSE, VIDEO or BEAUTY, or another trade of looks for speed (rays know only `coarse`).

        Raises:
            OptionError: if the size is not between 1 and 4096 pixels.
            UnknownNameError: if there is no such backend.
            RenderingError: if backend="gl" and no OpenGL platform works or this process was forked after OpenGL had
                been used, or if MUJOCO_GL names one that does not work, unless backend="rays".
        """
        check_choice("rendering backend", backend, BACKENDS)
        for side, pixels in (("width", width), ("height", height)):
            if not 1 <= pixels <= _LARGEST:
                raise OptionError(f"{side} {quoted(pixels)} is not valid; valid: 1 to {_LARGEST} pixels")
        self.model, self.width, self.height = model, width, height
        self._asked: tuple[Quality, Backend] = quality, backend
        self._painter: Painter | None = self._choose(quality, backend)

    @property
    def backend(self) -> Literal["gl", "rays"]:
        """Which one draws."""
        return "gl" if isinstance(self._painter, _GlPainter) else "rays"

    def render(self, data: mujoco.MjData, camera: str | int) -> NDArray[np.uint8]:
        """What a camera sees of `data`, whose positions must be computed: uint8 (height, width, 3).

        Raises:
            UnknownNameError: if the model has no such camera; the message lists them.
            RenderingError: after close, and with backend="gl" in a process that was forked from the one that made it.
        """
        return self._ready("render").render(data, self._camera(camera))

    def segment(self, data: mujoco.MjData, camera: str | int) -> NDArray[np.int32]:
        """Which geom of the model is seen in each pixel, int32 (height, width); -1 for none. Errors as in `render`."""
        return self._ready("segment").segment(data, self._camera(camera))

    def close(self) -> None:
        """Free the OpenGL context. May be called twice."""
        if self._painter is not None:
            self._painter.close()
        self._painter = None

    def __reduce__(self) -> tuple[object, ...]:
        return _made_again, (self.model, self.width, self.height, *self._asked, self._painter is None)

    def __enter__(self) -> Renderer:
        """Nothing but itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close."""
        self.close()

    def _ready(self, call: str) -> Painter:
        if self._painter is None:
            raise RenderingError(f"{call}() after close(): make a new Renderer")
        if isinstance(self._painter, _GlPainter) and self._painter.lost:
            self._painter = self._choose(*self._asked)
        return self._painter

    def _camera(self, camera: str | int) -> int:
        names = [self.model.camera(i).name for i in range(self.model.ncam)]
        if isinstance(camera, str):
            check_choice("camera", camera, names)
            return names.index(camera)
        check_choice("camera number", camera, range(self.model.ncam))
        return camera

    def _choose(self, quality: Quality, backend: Backend) -> Painter:
        why = contexts.gone()
        if why and backend == "gl":
            raise RenderingError(f"no picture by OpenGL: {why}")
        name = None if backend == "rays" or why else gl.probe()
        if name is not None:
            try:
                return _GlPainter(self.model, self.width, self.height, quality, name)
            except _failures() as error:
                # After one failure another try would abort the process, so OpenGL is given up for good.
                gl.forget(name)
                if backend == "gl":
                    raise RenderingError(f"OpenGL ({name}) failed: {error}; {gl.advice()}") from error
                gl.probe()  # complains where MUJOCO_GL insists on what has just failed
        elif backend == "gl":
            raise RenderingError(gl.advice())
        return RayPainter(self.model, self.width, self.height, groups=quality.groups)


def _made_again(
    model: mujoco.MjModel, width: int, height: int, quality: Quality, backend: Backend, closed: bool
) -> Renderer:
    """A copy of a renderer, with a context of its own."""
    made = Renderer(model, width, height, quality=quality, backend=backend)
    if closed:
        made.close()
    return made


def _failures() -> tuple[type[Exception], ...]:
    """What a platform that does not work after all may raise."""
    from OpenGL.error import Error

    return RenderingError, RuntimeError, ImportError, mujoco.FatalError, Error


class _GlPainter:
    """MuJoCo's own renderer with a quality preset."""

    def __init__(self, model: mujoco.MjModel, width: int, height: int, quality: Quality, platform: str) -> None:
        gl.activate(platform)
        self._model, self._size = model, (width, height)
        self._finer = max(1, min(quality.finer, _LARGEST // max(width, height)))
        self._culls = not quality.shadows and not quality.mirrors  # which may come from objects out of view
        with _buffers(model, width * self._finer, height * self._finer, quality):
            self._renderer: Any = mujoco.Renderer(
                model, height * self._finer, width * self._finer, max_geom=2 * model.ngeom + 200
            )
        contexts.hold(self._renderer)
        flags = self._renderer.scene.flags
        flags[mujoco.mjtRndFlag.mjRND_SHADOW] = quality.shadows
        flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = quality.mirrors
        self._option = mujoco.MjvOption()
        self._option.geomgroup[:] = [group in quality.groups for group in range(len(self._option.geomgroup))]
        self._option.sitegroup[:] = 0

    def render(self, data: mujoco.MjData, camera: int) -> NDArray[np.uint8]:
        """The picture, (height, width, 3)."""
        with self._culled(data, camera):
            self._renderer.update_scene(data, camera, self._option)
        picture: NDArray[np.uint8] = self._renderer.render()
        if self._finer == 1:
            return picture
        cv2 = load_opencv()
        return cv2.resize(picture, self._size, interpolation=cv2.INTER_AREA).astype(np.uint8, copy=False)

    def segment(self, data: mujoco.MjData, camera: int) -> NDArray[np.int32]:
        """Which geom is seen, (height, width)."""
        with self._culled(data, camera):
            self._renderer.update_scene(data, camera, self._option)
        self._renderer.enable_segmentation_rendering()
        try:
            found = self._renderer.render()[:: self._finer, :: self._finer]
        finally:
            self._renderer.disable_segmentation_rendering()
        return np.where(found[..., 1] == mujoco.mjtObj.mjOBJ_GEOM, found[..., 0], -1).astype(np.int32)

    @property
    def lost(self) -> bool:
        """Whether the context is not this process's own."""
        return contexts.lost(self._renderer)

    def close(self) -> None:
        """Free the context, unless it is another process's."""
        if not self.lost:
            self._renderer.close()

    @contextmanager
    def _culled(self, data: mujoco.MjData, camera: int) -> Iterator[None]:
        """The model with everything hidden that is out of the camera's view: drivers in software are slow at it."""
        if not self._culls:
            yield
            return
        groups = self._model.geom_group
        before = groups.copy()
        groups[out_of_view(self._model, data, camera, self._size[0] / self._size[1])] = HIDDEN_GROUP
        try:
            yield
        finally:
            groups[:] = before


@contextmanager
def _buffers(model: mujoco.MjModel, width: int, height: int, quality: Quality) -> Iterator[None]:
    """The model with the buffer sizes of a preset, which are read once when a context is made; put back afterwards."""
    screen, detail = model.vis.global_, model.vis.quality
    before = (
        screen.offwidth,
        screen.offheight,
        detail.shadowsize,
        detail.offsamples,
        detail.numslices,
        detail.numstacks,
    )
    screen.offwidth, screen.offheight = width, height
    detail.shadowsize, detail.offsamples = quality.shadow_size, 0
    detail.numslices, detail.numstacks = quality.slices, quality.stacks
    try:
        yield
    finally:
        screen.offwidth, screen.offheight, detail.shadowsize, detail.offsamples = before[:4]
        detail.numslices, detail.numstacks = before[4:]
