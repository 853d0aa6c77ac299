"""What the two backends share: an exact start going in, the result of a round coming out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from remac_env.rules.outcomes import Outcome
from remac_env.rules.subtasks import Subtask
from remac_env.start import Offset, Start
from remac_env.state import WorldState


@dataclass(frozen=True)
class Counters:
    """What a round cost and whether robots came near one another; all zero in the symbolic backend.

    `robot_contacts` and `near_misses` count control steps in which two robots touched, or were within 0.05 m.
    """

    control_steps: int = 0
    physics_steps: int = 0
    robot_contacts: int = 0
    near_misses: int = 0

    def __add__(self, other: Counters) -> Counters:
        return Counters(
            self.control_steps + other.control_steps,
            self.physics_steps + other.physics_steps,
            self.robot_contacts + other.robot_contacts,
            self.near_misses + other.near_misses,
        )


@dataclass(frozen=True)
class RoundResult:
    """The kitchen at rest after a round. `seconds` is the round's simulated time, as long as its slowest robot."""

    world: WorldState
    outcomes: Mapping[str, Outcome]
    seconds: float
    counters: Counters = field(default_factory=Counters)


class Backend(Protocol):
    """A kitchen that can be put into a start and run round by round.

    `watch` is called once a control period (in the symbolic backend once a round) while something moves.
    """

    watch: Callable[[], None] | None

    def reset(self, start: Start) -> WorldState:
        """Put the kitchen into this start; the world that results."""

    def run_round(self, subtasks: Mapping[str, Subtask]) -> RoundResult:
        """Every robot runs its subtask at the same time, until each has ended and the kitchen is at rest."""

    def positions(self) -> NDArray[np.float64] | None:
        """Joint positions now (qpos, rad and m), or None where nothing is simulated."""

    def close(self) -> None:
        """Free what the backend holds; may be called twice."""


__all__ = ["Backend", "Counters", "Offset", "RoundResult", "Start"]
