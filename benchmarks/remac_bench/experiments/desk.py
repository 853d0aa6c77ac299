"""Where the plans of an experiment are asked for, each once, whatever happens to whom is asked."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from remac_agents.roles import StopEpisode
from remac_bench.experiments.book import Book
from remac_bench.experiments.teaching import Lesson
from remac_bench.plans.ask import Cell, Taught, judged, no_plan
from remac_bench.plans.judge import Judgement
from remac_bench.playing.episodes import BlamedError

GIVES_UP = 3
"""Infrastructure errors of a planner in a row, after which it is not asked any more in this run."""


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
class Unscored:
    """A plan that could not be asked for, for a reason that is not the planner's."""

    planner: str
    cell: Cell
    told: bool
    why: str


Result = Trial | Unscored


class Desk:
    """Asks planners, and keeps what they answered in a book.

    An endpoint that is down leaves a plan unscored, and so are all after the third such error in a row; the next run
    asks for them again. What a planner raises is its own failure, and scored.
    """

    def __init__(self, planners: Mapping[str, object], book: Book) -> None:
        self._planners, self._book = planners, book
        self._down: Counter[str] = Counter()

    def trial(self, name: str, cell: Cell, lesson: Lesson | None = None, *, own: bool = False) -> Result:
        """The planner's plan for this cell, judged; from the book where it was asked for before.

        Args:
            lesson: what the planner is told of a first iteration; None: nothing.
            own: whether that was its own.
        """
        told = lesson is not None
        own = own and told
        of = _question(name, cell, told=told, own=own)
        lessons = lesson.reflections if isinstance(lesson, Taught) else ()
        known = self._book.find(of)
        if known is not None:
            judgement = Judgement.from_json(known)
        else:
            asked = self._asked(name, cell, lesson)
            if isinstance(asked, str):
                return Unscored(planner=name, cell=cell, told=told, why=asked)
            judgement = asked
            self._book.add(of, {**judgement.as_json(), "lessons": list(lessons)})
        return Trial(planner=name, cell=cell, told=told, own=own, lessons=lessons, judgement=judgement)

    def knows(self, name: str, cell: Cell, *, told: bool, own: bool) -> bool:
        """Whether the book holds the planner's plan for this cell."""
        return self._book.find(_question(name, cell, told=told, own=own and told)) is not None

    def _asked(self, name: str, cell: Cell, lesson: Lesson | None) -> Judgement | str:
        """The judgement, or why there is none."""
        if self._down[name] >= GIVES_UP:
            return f"not asked after {GIVES_UP} such errors in a row"
        try:
            if isinstance(lesson, StopEpisode):
                raise lesson
            if isinstance(lesson, BlamedError):
                problem = no_plan(lesson)

                def failed(request: Any) -> Any:
                    return problem

                return judged(cell, failed)
            judgement = judged(cell, self._planners[name], lesson)
        except StopEpisode as stop:
            self._down[name] += 1
            return str(stop)
        self._down[name] = 0
        return judgement


def _question(name: str, cell: Cell, *, told: bool, own: bool) -> dict[str, Any]:
    """What names a plan in the book."""
    where = {"task": cell.task, "seed": cell.seed, **cell.options}
    return {"what": "plan", "planner": name, **where, "told": told, "own": own}
