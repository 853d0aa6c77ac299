"""What an environment offers to whoever wants a video of its episodes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from remac_env.episode import Episode
from remac_env.pictures import Moment, Pictures


class Recordings(ABC):
    """Draws the robots at work, now, or afterwards what was kept of their motion."""

    _pictures: Pictures

    @abstractmethod
    def _running(self) -> Episode:
        """The episode under way."""

    @abstractmethod
    def _check_open(self) -> None:
        """Raise LifecycleError after close."""

    @abstractmethod
    def _moment(self) -> Moment:
        """What there is to see now."""

    def render_work(self, *, whole: bool = False) -> NDArray[np.uint8]:
        """The robots at work as videos show them, uint8 (648, 768, 3), with or without a render mode.

        The upper two thirds are the picture of a camera that follows the robots; below stands each robot's hand from
        near by, in the robots' order.

        Args:
            whole: the whole kitchen stands above, as `render` shows it.

        Raises:
            LifecycleError: before reset or after close.
            RenderingError: if no picture can be made with the settings at hand.
        """
        self._check_open()
        self._running()
        return self._pictures.work(self._moment(), whole=whole)

    def start_recording(self) -> None:
        """Keep the motion of the next episodes, each from its reset on, for `save_recording`. Draws nothing yet."""
        self._pictures.record()

    def save_recording(self, path: str | Path) -> int:
        """Draw what was recorded since the last reset as a time-lapse WebM video; returns its frames, at most 150.

        Raises:
            LifecycleError: without start_recording and reset before.
            OptionError: if the path does not end in .webm or cannot be written.
            RenderingError: if no picture can be made with the settings at hand.
        """
        return self._pictures.save(path)

    def recorded_rounds(self) -> list[float]:
        """When each round begins in that video, seconds from its beginning; empty where nothing was recorded."""
        return self._pictures.begins(self._running().rounds)
