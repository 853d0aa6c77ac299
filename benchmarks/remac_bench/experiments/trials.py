"""The three plan-only experiments as lists of trials, and how trials are counted."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from remac_bench.experiments.book import Book
from remac_bench.experiments.desk import Desk, Result, Trial
from remac_bench.experiments.teaching import lesson, outdone, suboptimal, teachers
from remac_bench.metrics import wilson
from remac_bench.plans.ask import Cell
from remac_env.options import WORDINGS

__all__ = ["EXPERIMENTS", "Count", "counted", "faults", "reflection", "suboptimal", "validity", "wording"]


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
    reflectors: Mapping[str, object] | None = None,
    book: Book | None = None,
) -> Iterator[Result]:
    """Told an earlier suboptimal plan and its reflections, does the planner answer with an optimal one?

    Starts whose earlier plan was optimal already are passed over: they ask nothing. `reflectors`: see `teachers`;
    `book`: what was found before.
    """
    book = Book() if book is None else book
    teaching = teachers(planners, reflectors, book)
    desk = Desk(planners, book)
    for kind in starts:
        for team in robots:
            for task in tasks:
                wanted = partial(outdone, task, count=count, robots=team, starts=kind)
                by_teacher = {teacher: wanted(teacher) for teacher in dict.fromkeys(teaching.values())}
                found = {name: by_teacher[teacher] for name, teacher in teaching.items()}
                for name, cell in _in_turns(found):
                    yield desk.trial(name, cell, found[name][cell], own=reflectors is not None)


def wording(
    planners: Mapping[str, object],
    tasks: Sequence[str],
    *,
    count: int,
    robots: Sequence[int],
    starts: Sequence[str],
    reflectors: Mapping[str, object] | None = None,
    book: Book | None = None,
) -> Iterator[Result]:
    """Is the initial plan valid, by wording of the goal, with and without an earlier iteration's reflections?

    `reflectors`: see `teachers`; `book`: what was found before.
    """
    book = Book() if book is None else book
    teaching = teachers(planners, reflectors, book)
    desk = Desk(planners, book)
    for number in WORDINGS:
        for cell in _cells(tasks, count, robots, starts, wording=number):
            for name in planners:
                yield desk.trial(name, cell)
                yield desk.trial(name, cell, lesson(teaching[name], cell), own=reflectors is not None)


def validity(
    planners: Mapping[str, object],
    tasks: Sequence[str],
    *,
    count: int,
    robots: Sequence[int],
    starts: Sequence[str],
    reflectors: Mapping[str, object] | None = None,
    book: Book | None = None,
) -> Iterator[Result]:
    """What is wrong with initial plans for the simplest wording? Nothing is told, so that no reflector is asked."""
    desk = Desk(planners, Book() if book is None else book)
    for cell in _cells(tasks, count, robots, starts):
        for name in planners:
            yield desk.trial(name, cell)


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
        for team in robots:
            for task in tasks:
                for seed in range(count):
                    yield Cell(task=task, robots=team, seed=seed, starts=kind, wording=wording)


def _in_turns(cells: Mapping[str, Iterable[Cell]]) -> Iterator[tuple[str, Cell]]:
    """(name, cell): the first cell of each name, then the second of each, ..."""
    for row in itertools.zip_longest(*cells.values()):
        yield from ((name, cell) for name, cell in zip(cells, row, strict=True) if cell is not None)

