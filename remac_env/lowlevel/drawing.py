"""What a skill's start looks like: pictures of whichever task the skill is tried in."""

from __future__ import annotations

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.manual import Manual
from remac_env.lowlevel.starts import ROBOT, Ready
from remac_env.pictures import Moment, Picture, Pictures

CAMERAS = ("front", "side", "wrist")


class Drawing:
    """Draws starts; one renderer, made anew where the task changes."""

    def __init__(self) -> None:
        self._pictures: Pictures | None = None
        self._task = ""

    def of(self, ready: Ready) -> Pictures:
        """The pictures of this start's kitchen."""
        task = ready.worlds.spec.name
        if self._pictures is None or self._task != task:
            self.close()
            self._pictures, self._task = Pictures(ready.worlds), task
        return self._pictures

    def observe(self, ready: Ready, manual: Manual, backend: PhysicsBackend, *, size: int) -> dict[str, Picture]:
        """What the robot's CAMERAS show now, uint8 (size, size, 3) each."""
        return self.of(ready).observe(moment(ready, manual, backend), ROBOT, size=size, cameras=CAMERAS)

    def close(self) -> None:
        """Free the renderer. May be called twice."""
        if self._pictures is not None:
            self._pictures.close()
        self._pictures = None


def moment(ready: Ready, manual: Manual, backend: PhysicsBackend) -> Moment:
    """What there is to see now."""
    return Moment(ready.start, manual.world, backend.positions())
