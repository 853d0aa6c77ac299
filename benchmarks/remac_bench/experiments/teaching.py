"""First iterations, from which planners are told in experiments: the rules' own or the planner's."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from remac_agents.roles import StopEpisode
from remac_bench.experiments.book import Book
from remac_bench.plans.ask import Cell, Taught, judged, teach, teach_by
from remac_bench.playing.episodes import BlamedError

STARTS_TRIED = 10
"""So many seeds are looked at for each start that is wanted, where starts are passed over."""

Lesson = Taught | BlamedError | StopEpisode
"""What a first iteration taught; or what the planner raised in it; or why it could not be played."""

Teach = Callable[[Cell], Taught]


def teachers(
    planners: Mapping[str, object], reflectors: Mapping[str, object] | None, book: Book | None = None
) -> dict[str, Teach]:
    """Planner -> how its first iteration is played.

    Args:
        reflectors: planner -> the reflector that learns from its own first iteration, which it plans itself; None: all
            are told what the rules learnt from the literal planner's.
        book: holds what planners' own first iterations taught before.
    """
    if reflectors is None:
        return dict.fromkeys(planners, teach)
    kept = Book() if book is None else book
    return {
        name: partial(_own, name, planner=planner, reflector=reflectors[name], book=kept)
        for name, planner in planners.items()
    }


def _own(name: str, cell: Cell, *, planner: object, reflector: object, book: Book) -> Taught:
    of = {"what": "first iteration", "planner": name, "task": cell.task, "seed": cell.seed, **cell.options}
    known = book.find(of)
    if known is not None:
        return Taught.from_json(known)
    taught = teach_by(cell, planner=planner, reflector=reflector)
    book.add(of, taught.as_json())
    return taught


def lesson(teacher: Teach, cell: Cell) -> Lesson:
    """What a first iteration teaches, or what kept it from teaching anything."""
    try:
        return teacher(cell)
    except (BlamedError, StopEpisode) as problem:
        return problem


def suboptimal(task: str, *, count: int, robots: int, starts: str) -> list[Cell]:
    """The first `count` cells, by seed, in which the plan of the rules' first iteration was not optimal."""
    return list(outdone(task, teach, count=count, robots=robots, starts=starts))


def outdone(task: str, teacher: Teach, *, count: int, robots: int, starts: str) -> dict[Cell, Lesson]:
    """The first `count` cells, by seed, in which the first iteration's plan was not optimal, and what it taught.

    One that could not be played, or in which the planner failed by what it raised, is among them.
    """
    found: dict[Cell, Lesson] = {}
    for seed in range(count * STARTS_TRIED):
        if len(found) == count:
            break
        cell = Cell(task=task, robots=robots, seed=seed, starts=starts)
        lessons = lesson(teacher, cell)
        if not isinstance(lessons, Taught) or not _optimal(cell, lessons):
            found[cell] = lessons
    return found


def _optimal(cell: Cell, lessons: Taught) -> bool | None:
    def first(request: Any) -> dict[str, tuple[str, ...]]:
        return dict(lessons.plan)

    return judged(cell, first).optimal
