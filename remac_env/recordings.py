"""What an environment offers to whoever wants a video of its episodes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path

from remac_env.episode import Episode
from remac_env.pictures import Pictures


class Recordings(ABC):
    """Keeps the motion of episodes and draws it afterwards."""

    _pictures: Pictures

    @abstractmethod
    def _running(self) -> Episode:
        """The episode under way."""

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
