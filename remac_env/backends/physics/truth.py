"""What is true in a simulated episode: what geometry shows, and what has happened by now."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from remac_env.backends.physics.bodies import Bodies
from remac_env.backends.physics.happened import Happened
from remac_env.backends.physics.snapshot import hands, read_world, touching
from remac_env.kitchen.layout import Layout
from remac_env.kitchen.objects.catalogue import Category
from remac_env.rules.facts import Process
from remac_env.rules.quirks import QUIRKS
from remac_env.rules.rounds import at_rest
from remac_env.start import Start
from remac_env.state import WorldState, switches_on

GRASP_LASTS = 4
"""Control periods in one of which both fingers have to touch what is held: a pad may bounce off what is jolted in a
hand, for a period and seldom for two. What left the hand 0.15 s ago has fallen 0.1 m."""


class Truth:
    """The world of an episode, kept by looking on: ``update`` is to be called after every control step of 0.05 s.

    ``happened``: what was pressed and seasoned by now.
    """

    def __init__(self, bodies: Bodies, start: Start, layout: Layout, objects: Mapping[str, Category]) -> None:
        self._bodies, self._scene, self._layout, self._objects = bodies, start.scene, layout, objects
        self._rest = replace(start.scene, quirks=tuple(q for q in start.scene.quirks if QUIRKS[q.kind].marks_alone))
        self._marks = {name: state.marks for name, state in start.world.objects.items()}
        self._touched: deque[NDArray[np.int32]] = deque(maxlen=GRASP_LASTS)
        self.happened = Happened(bodies, start.scene, layout, objects, switches_on(start.world))

    def update(self) -> None:
        """Take the last control step into account."""
        self.happened.update()
        self._touched.append(touching(self._bodies))

    def happen(self, process: Process, name: str) -> None:
        """Note what came of a process: a mark of the object, or that the fixture's switches went off.

        A door has fallen by itself by then, see `closers`, or something is in its way.
        """
        if process.does == "mark":
            self._marks[name] = self._marks[name] | {process.mark}
        elif process.does == "off":
            self.happened.running -= set(self._scene.fixtures[name].switches)

    def marks_of(self, name: str) -> frozenset[str]:
        """The marks of an object, as they were when the world was read last."""
        return self._marks[name]

    def mark(self, name: str, mark: str) -> None:
        """Note what has happened to an object."""
        self._marks[name] = self._marks[name] | {mark}

    def seen(self, *, lately: bool = False) -> WorldState:
        """What geometry shows now, with what happened; nothing is kept of it.

        ``lately``: hands hold as well what they have held in one of the last `GRASP_LASTS` control periods.
        """
        happened, moments = self.happened, (touching(self._bodies), *(reversed(self._touched) if lately else ()))
        marks = {name: had | happened.marks.get(name, frozenset()) for name, had in self._marks.items()}
        return read_world(
            self._bodies, self._scene, self._layout, self._objects,
            held=hands(self._bodies, self._objects, moments), marks=marks, running=happened.running,
        )  # fmt: skip

    def read(self) -> WorldState:
        """The world now. Marks that it shows stay from now on."""
        world = at_rest(self._rest, self.seen(lately=True))
        self._marks = {name: item.marks for name, item in world.objects.items()}
        return world
