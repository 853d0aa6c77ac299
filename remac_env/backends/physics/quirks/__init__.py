"""What each kind of quirk is in physics: a catch, a spring, glue, a hand that lets go of what is hot. A row each.

A quirk acts by forces on joints and objects, or by a motor of its own; nothing is put anywhere. Those that only mark
objects (a dirty vessel) are left to the rules, and what is full is so from the start (`kitchen.builder`).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Protocol

from remac_env.backends.physics.quirks import doors, objects, switches
from remac_env.backends.physics.quirks.mechanisms import Surroundings
from remac_env.backends.physics.truth import Truth
from remac_env.kitchen.floor_plan import Layout
from remac_env.rules.facts import Quirk, Rules
from remac_env.rules.subtasks import Subtask


class Mechanism(Protocol):
    """One quirk at work. `struck`: the targets of subtasks that it has kept from succeeding."""

    struck: set[str]

    @property
    def at_work(self) -> bool:
        """Whether `push` has anything to do."""

    def watch(self) -> None:
        """Look on, after every control period."""

    def push(self) -> None:
        """Apply forces, before every step of 5 ms."""


class Oddities:
    """The quirks of a kitchen, and the interlocks of what runs only shut."""

    def __init__(self, around: Surroundings, truth: Truth) -> None:
        self._around, self._simulation = around, around.simulation
        self._all: list[Mechanism] = [
            *(switches.Interlock(around, n) for n, f in around.layout.fixtures.items() if switches.Interlock.wanted(f)),
            *(ROWS[q.kind](around, q, truth) for q in around.scene.quirks if q.kind in ROWS),
        ]

    @staticmethod
    def wanted(scene: Rules, layout: Layout) -> bool:
        """Whether a kitchen has any."""
        return bool(scene.quirks) or any(switches.Interlock.wanted(each) for each in layout.fixtures.values())

    def watch(self) -> None:
        """Look on, after every control period."""
        if not self._all:
            return
        self._around.watch()
        for mechanism in self._all:
            mechanism.watch()
        self._simulation.forces = self._push if any(mechanism.at_work for mechanism in self._all) else None

    @property
    def pending(self) -> bool:
        """Whether one of them waits to act, so that the kitchen is not at rest yet."""
        waiting = (each for each in self._all if isinstance(each, doors.Falls | switches.Attended))
        return any(each.pending for each in waiting)

    def began(self, subtasks: Collection[Subtask]) -> None:
        """Note that subtasks begin."""
        for mechanism in self._all:
            mechanism.struck.difference_update(subtask.target for subtask in subtasks)

    def hindered(self, subtask: Subtask) -> bool:
        """Whether a quirk had to do with its failure."""
        return any(subtask.target in mechanism.struck for mechanism in self._all)

    def _push(self) -> None:
        for mechanism in self._all:
            mechanism.push()


Make = Callable[[Surroundings, Quirk, Truth], Mechanism]

ROWS: Mapping[str, Make] = {
    "jammed door": doors.Jams,
    "stuck object": objects.Sticks,
    "cold burner": switches.Refuses,
    "dead switch": switches.Refuses,
    "enabling switch": switches.Enabled,
    "guard door": switches.Guarded,
    "fuse": switches.Fuse,
    "spring switch": switches.Springs,
    "falling door": doors.Falls,
    "swinging door": doors.Swings,
    "hot vessel": objects.Hot,
    "two hands": switches.Attended,
}
"""Kind -> what it is in physics."""
