"""Measures a skill: how often it succeeds in a round of its own, from starts like those of tasks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from remac_bench.judging.statistics import wilson
from remac_bench.learning.cells import Cells
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.base import MakeController
from remac_env.backends.physics.controllers.learned.controller import Learned
from remac_env.backends.physics.controllers.learned.weights import Weights
from remac_env.lowlevel.starts import ROBOT, get_ready
from remac_env.robots.bodies import STANDARD
from remac_env.rules.outcomes import Outcome
from remac_env.rules.skills import SKILLS


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
    """
    if weights is not None:
        weights = replace(weights, about=replace(weights.about, measured={}))
    controllers: dict[str, MakeController] = {} if weights is None else {skill: partial(Learned, weights, body)}
    backends: dict[str, PhysicsBackend] = {}
    shown = () if weights is None else weights.about.shown(skill)
    for seed in seeds:
        cases = (shown[seed % len(shown)],) if shown else ()
        style, layout = cells.of(seed, skill)
        ready, backend = get_ready(
            backends, SKILLS[skill], target, seed, style=style, layout=layout, body=body,
            make=partial(PhysicsBackend, controllers=controllers), cases=cases,
        )  # fmt: skip
        if weights is not None and not weights.about.plays(skill, ready.subtask.target, ready.case):
            continue  # the scripted controller would do it
        outcome = backend.run_round({ROBOT: ready.subtask}).outcomes[ROBOT]
        yield Trial(skill, ready.subtask.target, seed, outcome, ready.case)


def score(name: str, trials: Sequence[Trial]) -> Score:
    """What tries come to."""
    good = [trial.outcome.seconds for trial in trials if trial.outcome.success]
    reasons = Counter(str(trial.outcome.reason) for trial in trials if not trial.outcome.success)
    mean = sum(good) / len(good) if good else 0.0
    return Score(name, len(trials), len(good), mean, tuple(reasons.most_common()))
