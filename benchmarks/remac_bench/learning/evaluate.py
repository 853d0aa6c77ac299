"""Measures a skill: how often it succeeds in a round of its own, from starts like those of tasks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from remac_bench.judging.statistics import wilson
from remac_bench.learning.cells import Cells
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.base import MakeController, Sensing
from remac_env.backends.physics.controllers.learned.controller import Learned
from remac_env.backends.physics.controllers.learned.weights import Weights
from remac_env.backends.physics.snapshot import UPRIGHT
from remac_env.lowlevel.starts import ROBOT, Ready, get_ready
from remac_env.robots.bodies import STANDARD
from remac_env.rules.outcomes import Outcome
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import Subtask


@dataclass(frozen=True)
class Trial:
    """One try of a skill. ``case``: see `case_of`."""

    skill: str
    target: str
    seed: int
    outcome: Outcome
    case: str = ""

    @property
    def what(self) -> str:
        """By what tries are sorted: the case, where there is one, else the target."""
        return self.case or self.target


@dataclass(frozen=True)
class Score:
    """How many tries of something succeeded, and why the others did not, the most frequent reason first."""

    name: str
    trials: int
    successes: int
    seconds: float
    reasons: tuple[tuple[str, int], ...]

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's 95% interval of the rate."""
        return wilson(self.successes, self.trials)


def evaluate(
    skill: str, weights: Weights | None, seeds: Sequence[int], cells: Cells, *, target: str | None = None,
    body: str = STANDARD,
) -> Iterable[Trial]:
    """Try a skill once a seed, with these weights; None: the scripted controller.

    Things are handled in the cases that were shown to it, seed by seed in turn, whatever was measured of them before.
    What the robot does before a trial is scripted, as in demonstrations: a vessel that it has laid badly itself would
    count against what it puts into it. A vessel that lies on its side fails, though the skill table has it where it
    was to be put: nothing can be put into it.
    """
    if weights is not None:
        weights = replace(weights, about=replace(weights.about, measured={}))
    turn = _Turn()
    controllers: dict[str, MakeController] = {} if weights is None else {skill: partial(_Tried, weights, body, turn)}
    backends: dict[str, PhysicsBackend] = {}
    shown = () if weights is None else weights.about.shown(skill)
    for seed in seeds:
        turn.come = False
        cases = (shown[seed % len(shown)],) if shown else ()
        style, layout = cells.of(seed, skill)
        ready, backend = get_ready(
            backends, SKILLS[skill], target, seed, style=style, layout=layout, body=body,
            make=partial(PhysicsBackend, controllers=controllers), cases=cases,
        )  # fmt: skip
        if weights is not None and not weights.about.plays(skill, ready.subtask.target, ready.case):
            continue  # the scripted controller would do it
        turn.come, held = True, backend.world.robots[ROBOT].holding
        outcome = backend.run_round({ROBOT: ready.subtask}).outcomes[ROBOT]
        if outcome.success and held is not None and ready.subtask.row.puts and not _stands(backend, ready, held):
            outcome = replace(outcome, status="failure", reason="slipped", detail=f"the {held} fell over")
        yield Trial(skill, ready.subtask.target, seed, outcome, ready.case)


def _stands(backend: PhysicsBackend, ready: Ready, name: str) -> bool:
    """Whether an object is no vessel, or stands upright."""
    vessel = ready.worlds.categories[ready.start.categories[name]].vessel
    return not vessel or bool(backend.data.body(name).xmat[8] >= UPRIGHT)


@dataclass
class _Turn:
    """Whether what was learnt is played now."""

    come: bool = False


class _Tried(Learned):
    """What was learnt, as it is tried; see `evaluate`."""

    def __init__(self, weights: Weights, body: str, turn: _Turn) -> None:
        super().__init__(weights, body)
        self._turn = turn

    def covers(self, subtask: Subtask, sensing: Sensing) -> bool:
        """Whether its turn has come, and it is one for it."""
        return self._turn.come and super().covers(subtask, sensing)


def score(name: str, trials: Sequence[Trial]) -> Score:
    """What tries come to."""
    good = [trial.outcome.seconds for trial in trials if trial.outcome.success]
    reasons = Counter(str(trial.outcome.reason) for trial in trials if not trial.outcome.success)
    mean = sum(good) / len(good) if good else 0.0
    return Score(name, len(trials), len(good), mean, tuple(reasons.most_common()))
