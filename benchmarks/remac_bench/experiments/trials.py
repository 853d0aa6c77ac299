"""The three plan-only experiments as lists of trials, and how trials are counted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from remac_bench.metrics import wilson
from remac_bench.plans.ask import Cell, judged, teach
from remac_bench.plans.judge import Judgement
from remac_env.tasks.spec import WORDINGS

STARTS_TRIED = 10
"""So many seeds are looked at for each start that is wanted, where starts are passed over."""


@dataclass(frozen=True, kw_only=True)
class Trial:
    """One plan, and what it was asked for. `planner` is its name in tables; `told`: reflections were given."""

    planner: str
    cell: Cell
    told: bool
    judgement: Judgement


@dataclass(frozen=True, kw_only=True)
class Count:
    """Successes of n trials, with Wilson's 95% interval (None without trials)."""

    successes: int
    n: int

    @property
    def interval(self) -> tuple[float, float] | None:
        """(low, high)."""
        return wilson(self.successes, self.n) if self.n else None

    def as_json(self) -> dict[str, Any]:
        """The same as values that json.dumps takes."""
        return {"successes": self.successes, "n": self.n, "interval": self.interval}


def reflection(
    planners: Mapping[str, object],
    tasks: Sequence[str],
    *,
    count: int,
    robots: Sequence[int],
    starts: Sequence[str],
) -> Iterator[Trial]:
    """Told an earlier suboptimal plan and its reflections, does the planner answer with an optimal one?

    Starts whose earlier plan was optimal already are passed over: they ask nothing.
    """
    for kind in starts:
        for crew in robots:
            for task in tasks:
                for cell in suboptimal(task, count=count, robots=crew, starts=kind):
                    for name, planner in planners.items():
                        yield _trial(name, planner, cell, told=True)


def suboptimal(task: str, *, count: int, robots: int, starts: str) -> list[Cell]:
    """The first `count` cells, by seed, in which the first iteration's plan was not optimal."""
    found: list[Cell] = []
    for seed in range(count * STARTS_TRIED):
        if len(found) == count:
            break
        cell = Cell(task=task, robots=robots, seed=seed, starts=starts)
        lessons = teach(cell)
        if judged(cell, lambda request, first=lessons.plan: dict(first)).optimal is False:
            found.append(cell)
    return found


def wording(
    planners: Mapping[str, object],
    tasks: Sequence[str],
    *,
    count: int,
    robots: Sequence[int],
    starts: Sequence[str],
) -> Iterator[Trial]:
    """Is the initial plan valid, by wording of the goal, with and without an earlier iteration's reflections?"""
    for number in WORDINGS:
        for cell in _cells(tasks, count, robots, starts, wording=number):
            for name, planner in planners.items():
                for told in (False, True):
                    yield _trial(name, planner, cell, told=told)


def validity(
    planners: Mapping[str, object],
    tasks: Sequence[str],
    *,
    count: int,
    robots: Sequence[int],
    starts: Sequence[str],
) -> Iterator[Trial]:
    """What is wrong with initial plans for the simplest wording?"""
    for cell in _cells(tasks, count, robots, starts):
        for name, planner in planners.items():
            yield _trial(name, planner, cell, told=False)


EXPERIMENTS = {"reflection": reflection, "wording": wording, "validity": validity}


def counted(successes: Iterable[bool | None]) -> Count:
    """How many of them, of how many; what is not known (None) does not count."""
    values = [value for value in successes if value is not None]
    return Count(successes=sum(values), n=len(values))


def faults(trials: Iterable[Trial]) -> Counter[str]:
    """Type of fault -> plans whose first error it is."""
    return Counter(trial.judgement.error.type for trial in trials if trial.judgement.error is not None)


def _cells(
    tasks: Sequence[str], count: int, robots: Sequence[int], starts: Sequence[str], *, wording: int = 3
) -> Iterator[Cell]:
    for kind in starts:
        for crew in robots:
            for task in tasks:
                for seed in range(count):
                    yield Cell(task=task, robots=crew, seed=seed, starts=kind, wording=wording)


def _trial(name: str, planner: object, cell: Cell, *, told: bool) -> Trial:
    judgement = judged(cell, planner, teach(cell) if told else None)
    return Trial(planner=name, cell=cell, told=told, judgement=judgement)
