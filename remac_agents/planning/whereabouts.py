"""Where robots and objects are as far as a plan itself says: labels that are equal for one and the same place.

A fixture used from one station has that station as its label. An object that no step has moved yet has a label
of its own: where it stands is not told. From which of several stations a fixture will be used is not told either; each
visit that was made there has a label of its own.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable

from remac_env.rules.facts import ASIDE
from remac_env.rules.scene import PublicScene
from remac_env.rules.subtasks import Subtask


class Whereabouts:
    """Follows the steps of a plan, for one robot or several."""

    def __init__(self, facts: PublicScene) -> None:
        """Nobody has moved: every robot is aside with an empty hand."""
        self._facts = facts
        self._visits = itertools.count()
        self.station: dict[str, str] = {}
        self.hand: dict[str, str | None] = {}
        self._objects: dict[str, str] = {}

    def of(self, target: str) -> str | None:
        """The label of the place from which a fixture or object is used; None: one of several, and not told which."""
        if target not in self._facts.fixtures:
            return self._objects.get(target, f"by the {target}")
        stations = self._facts.stations_of(target)
        return stations[0] if len(stations) == 1 else None

    def is_at(self, robot: str, target: str) -> bool:
        """Whether the robot is known to stand where a fixture or object is used."""
        place = self.of(target)
        return place is not None and self.station.get(robot) == place

    def goal(self, robot: str, step: Subtask) -> str | None:
        """The label at which this step would leave the robot; None as for `of`."""
        if not step.moves:
            return self.station.get(robot, ASIDE)
        return self.of(step.target) if step.target else ASIDE

    def run(self, robot: str, step: Subtask, goal: str | None = None) -> None:
        """The step succeeds; `goal` is its label if it was asked for before."""
        here = goal or self.goal(robot, step) or f"{step.target}, visit {next(self._visits)}"
        self.station[robot] = here
        if step.row.takes:
            self.hand[robot] = step.target
            self._objects.pop(step.target, None)
        elif step.row.puts and (held := self.hand.get(robot)) is not None:
            self._objects[held] = here
            self.hand[robot] = None


def way_to(target: str) -> Subtask:
    """The drive there."""
    return Subtask("navigate to", target)


def hands(steps: Iterable[Subtask]) -> list[str | None]:
    """For each step, what one robot that runs them all holds just before it."""
    held: str | None = None
    found: list[str | None] = []
    for step in steps:
        found.append(held)
        held = step.target if step.row.takes else None if step.row.puts else held
    return found
