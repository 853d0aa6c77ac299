"""The three plan-only experiments as lists of trials, and how trials are counted."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from remac_bench.metrics import wilson
from remac_bench.plans.ask import Cell, Taught, judged, teach, teach_by
from remac_bench.plans.judge import Judgement
from remac_env.tasks.spec import WORDINGS

STARTS_TRIED = 10
"""So many seeds are looked at for each start that is wanted, where starts are passed over."""


@dataclass(frozen=True, kw_only=True)
class Trial:
    """One plan, and what it was asked for.

    Attributes:
        planner: its name in tables.
        told: reflections were given, `lessons`; `own`: they come from the planner's own first iteration.
    """

    planner: str
    cell: Cell
    told: bool
    judgement: Judgement
    own: bool = False
    lessons: tuple[str, ...] = ()


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
) -> Iterator[Trial]:
    """Told an earlier suboptimal plan and its reflections, does the planner answer with an optimal one?

    Starts whose earlier plan was optimal already are passed over: they ask nothing. `reflectors`: see `teachers`.
    """
    teaching = teachers(planners, reflectors)
    for kind in starts:
        for crew in robots:
            for task in tasks:
                wanted = partial(outdone, task, count=count, robots=crew, starts=kind)
                by_teacher = {teacher: wanted(teacher) for teacher in dict.fromkeys(teaching.values())}
                found = {name: by_teacher[teacher] for name, teacher in teaching.items()}
                for name, cell in _in_turns(found):
                    yield _trial(name, planners[name], cell, found[name][cell], own=reflectors is not None)


Teach = Callable[[Cell], Taught]


def teachers(planners: Mapping[str, object], reflectors: Mapping[str, object] | None) -> dict[str, Teach]:
    """Planner -> how its first iteration is played.

    Args:
        reflectors: planner -> the reflector that learns from its own first iteration, which it plans itself; None: all
            are told what the rules learnt from the literal planner's.
    """
    if reflectors is None:
        return dict.fromkeys(planners, teach)
    return {
        name: partial(teach_by, planner=planner, reflector=reflectors[name]) for name, planner in planners.items()
    }


def suboptimal(task: str, *, count: int, robots: int, starts: str) -> list[Cell]:
    """The first `count` cells, by seed, in which the plan of the rules' first iteration was not optimal."""
    return list(outdone(task, teach, count=count, robots=robots, starts=starts))


def outdone(task: str, teacher: Teach, *, count: int, robots: int, starts: str) -> dict[Cell, Taught]:
    """The first `count` cells, by seed, in which the first iteration's plan was not optimal, and what it taught."""
    found: dict[Cell, Taught] = {}
    for seed in range(count * STARTS_TRIED):
        if len(found) == count:
            break
        cell = Cell(task=task, robots=robots, seed=seed, starts=starts)
        lessons = teacher(cell)
        if not judged(cell, lambda request, first=lessons.plan: dict(first)).optimal:
            found[cell] = lessons
    return found


def wording(
    planners: Mapping[str, object],
    tasks: Sequence[str],
    *,
    count: int,
    robots: Sequence[int],
    starts: Sequence[str],
    reflectors: Mapping[str, object] | None = None,
) -> Iterator[Trial]:
    """Is the initial plan valid, by wording of the goal, with and without an earlier iteration's reflections?

    `reflectors`: see `teachers`.
    """
    teaching = teachers(planners, reflectors)
    for number in WORDINGS:
        for cell in _cells(tasks, count, robots, starts, wording=number):
            for name, planner in planners.items():
                yield _trial(name, planner, cell)
                yield _trial(name, planner, cell, teaching[name](cell), own=reflectors is not None)


def validity(
    planners: Mapping[str, object],
    tasks: Sequence[str],
    *,
    count: int,
    robots: Sequence[int],
    starts: Sequence[str],
    reflectors: Mapping[str, object] | None = None,
) -> Iterator[Trial]:
    """What is wrong with initial plans for the simplest wording? Nothing is told, so that no reflector is asked."""
    for cell in _cells(tasks, count, robots, starts):
        for name, planner in planners.items():
            yield _trial(name, planner, cell)


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


def _in_turns(cells: Mapping[str, Iterable[Cell]]) -> Iterator[tuple[str, Cell]]:
    """(name, cell): the first cell of each name, then the second of each, ..."""
    for row in itertools.zip_longest(*cells.values()):
        yield from ((name, cell) for name, cell in zip(cells, row, strict=True) if cell is not None)


def _trial(name: str, planner: object, cell: Cell, taught: Taught | None = None, *, own: bool = False) -> Trial:
    told = taught is not None
    lessons = () if taught is None else taught.reflections
    judgement = judged(cell, planner, taught)
    return Trial(planner=name, cell=cell, told=told, own=own and told, lessons=lessons, judgement=judgement)
