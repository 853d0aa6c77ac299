"""Springs that shut doors which fall shut by themselves: forces on their joints, never a position."""

from __future__ import annotations

from collections.abc import Mapping

from remac_env.backends.physics.bodies import Bodies
from remac_env.kitchen.fixtures.door import OPEN_TO
from remac_env.kitchen.floor_plan import Layout
from remac_env.rules.facts import Process

FALL = 3.0
"""s before the end of its process at which a door is let go: from as far as robots open it, it takes 2.1 s, from as far
as it swings, 2.8 s."""

SWING = 1.45
"""s that a door takes from `OPEN_TO` at the speed at which its own damping holds the spring: our choice, 1 rad/s, with
which a cabinet's handle meets what stands there at 0.3 to 0.4 m/s and 0.1 J."""


class Closers:
    """The springs of all doors of a kitchen. They pull at those alone that `go_on` was told of, and at the end of that.

    A spring pulls as hard as the joint's dry friction and its damping at the speed of `SWING` hold against it: 1 N m at
    a cabinet's door. Whatever stands in the way keeps the door open. It differs from the closer of the quirk "falling
    door" (`quirks.doors.Falls`), a motor that keeps its speed: here a set force shuts in a time that tasks count on.
    """

    def __init__(self, bodies: Bodies, layout: Layout) -> None:
        self._bodies, self._layout = bodies, layout
        self._force: dict[int, float] = {}
        self._from: dict[int, float] = {}
        self.at_work = False

    def go_on(self, processes: Mapping[tuple[Process, str], float]) -> None:
        """Take note of what goes on, and since when, s on the clock."""
        for joint in self._from:
            self._bodies.data.qfrc_applied[joint] = 0.0
        self._from, self.at_work = {}, False
        for (process, name), since in processes.items():
            if process.does == "shut":
                for panel in self._layout.fixtures[name].door_panels:
                    joint = int(self._bodies.model.joint(panel.joint).dofadr[0])
                    self._from[joint] = since + process.seconds - FALL
                    self._force[joint] = self._pull_of(joint, panel.position(OPEN_TO))

    @property
    def armed(self) -> bool:
        """Whether any door is left alone."""
        return bool(self._from)

    def pull(self, now: float) -> None:
        """Let the springs pull whose time has come; to be called before each control period, with the clock's s."""
        for joint, begin in self._from.items():
            if now >= begin:
                self._bodies.data.qfrc_applied[joint] = -self._force[joint]
                self.at_work = True

    def _pull_of(self, joint: int, travel: float) -> float:
        """N m, or N for what slides."""
        model = self._bodies.model
        return float(model.dof_frictionloss[joint] + model.dof_damping[joint] * travel / SWING)
