"""The symbolic backend: the skill table's effects in pure Python, no physics and no MuJoCo."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from remac_env.backends.base import RoundResult, Start
from remac_env.errors import LifecycleError, OptionError
from remac_env.rules.claims import settle_claims
from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.rounds import transition
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.seeding import generator
from remac_env.state import WorldState


class SymbolicBackend:
    """Rounds by the skill table alone.

    Args:
        failure_rate: probability in 0..1 that an accepted subtask other than `wait` and `done` slips and changes
            nothing, drawn from a generator of the episode.
    """

    def __init__(self, *, failure_rate: float = 0.0) -> None:
        if not 0.0 <= failure_rate <= 1.0:
            raise OptionError(f"failure_rate {failure_rate!r} is not valid; valid: 0..1")
        self.watch: Callable[[], None] | None = None
        self._failure_rate = failure_rate
        self._start: Start | None = None
        self._world: WorldState | None = None
        self._chance = np.random.default_rng(0)

    def reset(self, start: Start) -> WorldState:
        """Take over the start's world."""
        self._start, self._world = start, start.world
        self._chance = generator(start.seed, "symbolic slips")
        return start.world

    def run_round(self, subtasks: Mapping[str, Subtask]) -> RoundResult:
        """One round by the table; seconds are the table's nominal ones."""
        if self._start is None or self._world is None:
            raise LifecycleError("the symbolic backend needs reset(start) before run_round")
        scene = self._start.scene
        slipped = self._slips(scene, self._world, subtasks)
        accepted = {robot: WAIT if robot in slipped else s for robot, s in subtasks.items()} if slipped else subtasks
        world, outcomes = transition(scene, self._world, accepted)
        outcomes |= {robot: failure("slipped", "a seeded slip") for robot in slipped}
        timed = {robot: _timed(outcome, subtasks[robot]) for robot, outcome in outcomes.items()}
        self._world = world
        if self.watch is not None:
            self.watch()
        return RoundResult(world, timed, max((o.seconds for o in timed.values()), default=0.0))

    def positions(self) -> None:
        """Nothing is simulated."""

    def close(self) -> None:
        """Forget the episode."""
        self._start = self._world = None

    def _slips(self, scene: Rules, world: WorldState, subtasks: Mapping[str, Subtask]) -> set[str]:
        """The robots whose accepted subtask slips."""
        if self._failure_rate == 0.0:
            return set()
        refused, _ = settle_claims(scene, world, subtasks)
        moving = sorted(r for r, s in subtasks.items() if r not in refused and not s.row.still)
        return {robot for robot in moving if self._chance.random() < self._failure_rate}


def _timed(outcome: Outcome, subtask: Subtask) -> Outcome:
    """An outcome with nominal seconds: a refusal takes none."""
    seconds = 0.0 if outcome.refused else SKILLS[subtask.skill].seconds
    return outcome if seconds == outcome.seconds else Outcome(outcome.status, outcome.reason, outcome.detail, seconds)
