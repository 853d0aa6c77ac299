"""What is seen of an environment: render(), images in observations, videos. Renderers are loaded on demand."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from remac_env.errors import LifecycleError, RenderingError
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.rendering.video import FPS, MAX_FRAMES, STILLS, Sampler, prepare, spread
from remac_env.rules.facts import Process
from remac_env.simulator import load_mujoco, load_opencv
from remac_env.start import Start
from remac_env.state import WorldState

if TYPE_CHECKING:
    from remac_env.rendering.stage import Stage
    from remac_env.rendering.window import Window

Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class Moment:
    """What there is to see: the joint positions of physics (None: posed by the world) and the world as last known.

    `round`: how many rounds are over; `slow`: what takes its time by itself, and which share of it is over, 0..1;
    `unseen`: the objects that nobody on the team has seen, which no picture shows.
    """

    start: Start
    world: WorldState
    positions: NDArray[np.float64] | None
    round: int = 0
    slow: Mapping[tuple[Process, str], float] = field(default_factory=dict)
    unseen: frozenset[str] = frozenset()


class Pictures:
    """The pictures of one environment."""

    def __init__(self, worlds: TaskWorlds) -> None:
        self._worlds = worlds
        self._shown: Stage | None = None
        self._posed: Moment | None = None
        self._window: Window | None = None
        self._tape: Sampler[Moment] | None = None

    def __getstate__(self) -> dict[str, Any]:
        """What a copy takes over: the moments kept. It makes renderers and a window of its own."""
        return {**self.__dict__, "_shown": None, "_posed": None, "_window": None}

    def render(self, moment: Moment, mode: str) -> Picture | None:
        """The whole kitchen, uint8 (height, width, 3); "work": the robots at work; "human": a window shows it."""
        stage = self._stage(moment)
        if mode != "human":
            return stage.work() if mode == "work" else stage.picture()
        from remac_env.rendering.window import Window

        self._window = self._window or Window()
        stage.show_in(self._window)
        return None

    def png(self, moment: Moment) -> bytes | None:
        """The overview as a PNG file; None where it cannot be drawn."""
        try:
            cv2 = load_opencv()
            _, data = cv2.imencode(".png", self._stage(moment).picture()[..., ::-1])
        except RenderingError:
            return None
        return bytes(data.tobytes())

    def observe(self, moment: Moment, robot: str, *, size: int, cameras: Collection[str]) -> dict[str, Picture]:
        """The pictures of these cameras (`options.CAMERAS`) of one robot, uint8 (size, size, 3)."""
        return self._stage(moment).observe(robot, moment.world, size=size, cameras=cameras)

    def record(self) -> None:
        """From now on keep moments."""
        self._tape = Sampler(2 * MAX_FRAMES)

    def rewind(self) -> None:
        """Forget the moments of the last episode, where they are being kept."""
        if self._tape is not None:
            self._tape = Sampler(2 * MAX_FRAMES)

    def film(self, moment: Callable[[], Moment]) -> None:
        """Keep the moment that the function makes, if one is wanted now."""
        if self._tape is not None and self._tape.wants():
            self._tape.add(moment())

    def save(self, path: str | Path) -> int:
        """Draw the kept moments as a video of the robots at work; returns the number of frames."""
        if self._tape is None or not self._tape.frames:
            raise LifecycleError("nothing was recorded: call start_recording(), then reset()")
        prepare(path)
        load_mujoco()
        from remac_env.rendering import video

        chosen = [self._tape.frames[index] for index in spread(len(self._tape.frames))]
        seen = [self._stage(moment).at_work() for moment in chosen]
        aimed = self._stage(chosen[-1]).aimed(seen)
        drawn = (self._stage(moment).work(at) for moment, at in zip(chosen, aimed, strict=True))
        return video.write(path, drawn, fps=_pace(chosen))

    def work(self, moment: Moment, *, whole: bool) -> Picture:
        """The robots at work, uint8 (648, 768, 3): see `rendering.stage.Stage.work`."""
        return self._stage(moment).work(whole=whole)

    def begins(self, rounds: int) -> list[float]:
        """When each of this many rounds begins in the video that `save` draws, seconds from its beginning."""
        moments = self._tape.frames if self._tape is not None else ()
        shown = [moments[index].round for index in spread(len(moments))]
        if not shown:
            return []
        # A round too short for a picture of its own begins with the next one that there is.
        firsts = (
            next((index for index, over in enumerate(shown) if over >= number), len(shown) - 1)
            for number in range(rounds)
        )
        return [round(index / _pace(moments), 3) for index in firsts]

    def close(self) -> None:
        """Free renderers and window. May be called twice."""
        if self._shown is not None:
            self._shown.close()
        if self._window is not None:
            self._window.close()
        self._shown = self._window = self._posed = None

    def _stage(self, moment: Moment) -> Stage:
        """The stage of this kitchen, posed like the moment; kept while episodes have the same objects in them."""
        load_mujoco()
        from remac_env.rendering.stage import Stage, stage_key

        start = moment.start
        layout = self._worlds.layout_of(start)
        if undrawn := [name for name in start.scene.fixtures if name not in layout.fixtures]:
            raise RenderingError(
                f"{', '.join(undrawn)}: annexes have no shape, so that a kitchen with any cannot be drawn; valid: a "
                f"task without, as those of template='physics'"
            )
        if self._shown is None or self._shown.key != stage_key(start):
            if self._shown is not None:
                self._shown.close()
            self._shown = Stage(start, layout, self._worlds.categories)
            self._posed = None
        if self._posed is not None and _looks_alike(self._posed, moment):
            return self._shown
        if moment.positions is None:
            self._shown.show_world(start, moment.world, moment.slow, moment.unseen)
        else:
            self._shown.show_positions(moment.positions, moment.world, moment.slow, moment.unseen)
        self._posed = moment
        return self._shown


def _pace(moments: Sequence[Moment]) -> float:
    """Frames a second of a video of these moments."""
    return STILLS if all(moment.positions is None for moment in moments) else FPS


def _looks_alike(one: Moment, other: Moment) -> bool:
    """Whether two moments of one kitchen are posed alike for certain, as when several robots look at one."""
    if one.start is not other.start:
        return False
    if (one.world, one.slow, one.unseen) != (other.world, other.slow, other.unseen):
        return False
    if one.positions is None or other.positions is None:
        return one.positions is other.positions
    return np.array_equal(one.positions, other.positions)
