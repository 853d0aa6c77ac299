"""Silent videos by OpenCV alone: short ones that browsers play (WebM, VP8), whole ones for learners (MP4, VP9)."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from remac_env.errors import OptionError, RenderingError
from remac_env.files import prepare_file
from remac_env.quoting import quoted
from remac_env.simulator import load_opencv

Picture = NDArray[np.uint8]
Moment = TypeVar("Moment")

MAX_FRAMES = 150
"""Frames of the longest video: ten seconds at 15 a second (50 of stills), 2 to 10 MB."""


class Sampler(Generic[Moment]):
    """Keeps an evenly spread selection of a stream of unknown length, at most `limit`: a time lapse.

    Ask `wants()` before making a moment, so that those which would be dropped need not be made. Whenever the selection
    is full every second moment is dropped, and from then on only every second one is wanted.
    """

    def __init__(self, limit: int = MAX_FRAMES) -> None:
        """Raises OptionError unless limit is 2 or more."""
        if limit < 2:
            raise OptionError(f"limit {quoted(limit)} is not valid; valid: 2 or more")
        self._limit, self._stride, self._seen = limit, 1, 0
        self._kept: list[Moment] = []

    def wants(self) -> bool:
        """Count one moment; True if it shall be given to `add`."""
        self._seen += 1
        return (self._seen - 1) % self._stride == 0

    def add(self, moment: Moment) -> None:
        """Keep the moment that `wants` just asked for."""
        if len(self._kept) == self._limit:
            self._kept = self._kept[::2]
            self._stride *= 2
            # With an even limit the newcomer is the next of the thinned series, with an odd one it lies between.
            if (self._seen - 1) % self._stride:
                return
        self._kept.append(moment)

    @property
    def frames(self) -> tuple[Moment, ...]:
        """The moments kept, in order."""
        return tuple(self._kept)


FPS = 15.0
"""Frames a second of a video."""

STILLS = 3.0
"""The same where nothing moves from one to the next, as in the symbolic backend: long enough to be looked at."""


def spread(count: int, limit: int = MAX_FRAMES) -> NDArray[np.int64]:
    """Indices of at most `limit` of `count` things, evenly spread, the first and the last among them."""
    if count <= limit:
        return np.arange(count)
    return np.linspace(0, count - 1, limit).round().astype(np.int64)


def write(path: str | os.PathLike[str], frames: Iterable[Picture], *, fps: float = FPS) -> int:
    """Write pictures, uint8 (height, width, 3) and all of one size, as a WebM file; more than 150 are thinned evenly.

    Returns the number of frames written. The file appears whole or not at all.

    Raises:
        OptionError: if the path does not end in .webm or cannot be written, there are no frames, or they differ in
            size or type.
        RenderingError: if OpenCV cannot write the file.
    """
    target = prepare(path)
    pictures = list(frames)
    _check(pictures)
    chosen = [pictures[i] for i in spread(len(pictures))]
    handle, draft = tempfile.mkstemp(dir=target.parent, suffix=".webm")
    os.close(handle)
    try:
        _encode(draft, chosen, fps)
        os.chmod(draft, 0o644)  # drafts are private, videos are for others too
        os.replace(draft, target)
    except BaseException:
        Path(draft).unlink(missing_ok=True)
        raise
    return len(chosen)


def write_whole(path: str | os.PathLike[str], frames: Iterable[Picture], *, fps: float) -> None:
    """Write every picture, uint8 (height, width, 3) and all of one size, as MP4 with VP9, without thinning.

    Raises:
        OptionError: if there are no frames, or they differ in size or type.
        RenderingError: if OpenCV cannot write the file.
    """
    pictures = list(frames)
    _check(pictures)
    _encode(str(path), pictures, fps, codec="vp09")


def prepare(path: str | os.PathLike[str]) -> Path:
    """See that a video can be written there, before its pictures are drawn; its folder is made.

    Raises:
        OptionError: if it cannot, or the path does not end in .webm.
        RenderingError: if OpenCV is missing.
    """
    target = Path(path)
    if target.suffix.lower() != ".webm":
        raise OptionError(f"{target.name!r} is not a valid video file name; valid: names that end in .webm")
    made = prepare_file(target, "video")
    load_opencv()
    return made


def _check(pictures: list[Picture]) -> None:
    if not pictures:
        raise OptionError("a video needs at least one frame, got none")
    shape = pictures[0].shape
    for number, picture in enumerate(pictures):
        if picture.dtype != np.uint8 or picture.ndim != 3 or picture.shape[2] != 3 or picture.shape != shape:
            raise OptionError(
                f"frame {number} has type {picture.dtype} and shape {picture.shape}; valid: uint8 {(*shape[:2], 3)}"
            )


def _encode(path: str, pictures: list[Picture], fps: float, codec: str = "VP80") -> None:
    cv2 = load_opencv()
    height, width = pictures[0].shape[:2]
    with _quiet():
        writer = cv2.VideoWriter(path, cv2.VideoWriter.fourcc(*codec), fps, (width, height))
        try:
            if not writer.isOpened():
                raise RenderingError(f"{path}: OpenCV cannot write {codec} here; valid: a build with FFmpeg")
            for picture in pictures:
                writer.write(np.ascontiguousarray(picture[:, :, ::-1]))
        finally:
            writer.release()
    if os.path.getsize(path) == 0:
        raise RenderingError(f"{path}: OpenCV wrote an empty file")


@contextmanager
def _quiet() -> Iterator[None]:
    """Send what FFmpeg writes to the error stream (a harmless remark about the codec's tag) to nowhere."""
    kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)
