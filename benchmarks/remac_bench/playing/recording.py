"""Videos of episodes: which are wanted, and a recorder that never lets a picture spoil an episode."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, Literal

from remac_bench.records import VideoEntry
from remac_bench.store import VIDEOS
from remac_env.errors import RemacError, RenderingError

VideoMode = Literal["none", "failed", "all", "last"]
"""Within a job: no episode, those that failed, every one, or the last iteration alone."""


class Recorder:
    """Films one episode where wanted; a problem is kept in the record's `video` and the episode goes on."""

    def __init__(self, env: Any, folder: str | Path, name: str, mode: VideoMode, *, last: bool) -> None:
        """Args: folder: the records'; name: of the file; last: whether this is the job's last iteration."""
        self.folder = Path(folder)
        self._env, self._mode = env, mode
        self._name = f"{VIDEOS}/{re.sub(r'[^A-Za-z0-9_.-]+', '-', name).strip('-')}.webm"
        self._wanted = mode in ("failed", "all") or (mode == "last" and last)
        self._problem: str | None = None

    def start(self) -> None:
        """Call before reset."""
        if self._wanted:
            try:
                self._method("start_recording")()
            except (RemacError, OSError) as error:
                self._problem = f"{type(error).__name__}: {error}"

    def finish(self, *, success: bool) -> VideoEntry | None:
        """Call after the episode; None where no video was wanted."""
        if not self._wanted or (self._mode == "failed" and success):
            return None
        if self._problem is None:
            try:
                path = self.folder / self._name
                path.parent.mkdir(parents=True, exist_ok=True)
                self._method("save_recording")(path)
                return VideoEntry(path=self._name, rounds=self._method("recorded_rounds")())
            except (RemacError, OSError) as error:
                self._problem = f"{type(error).__name__}: {error}"
        return VideoEntry(error=self._problem)

    def _method(self, name: str) -> Any:
        method = getattr(self._env, name, None)
        if method is None:
            raise RenderingError(f"this kitchen cannot be filmed: it has no {name}()")
        return method
