"""What a network that looks at pictures is asked: a condition without the robot whose pictures they are.

Names are told by their words ("worktop_left": worktop, left), so that a name of known words is a known name.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from remac_env.rules.claims import settled
from remac_env.rules.conditions import Condition
from remac_env.rules.marks import SEASONED
from remac_env.rules.predicates import PREDICATES

MOST_NAMES = 2
"""Names in a question at most."""

_DRAWN_MARKS = (SEASONED,)
"""Marks that pictures show: seasoned food is drawn with grains on it."""


@dataclass(frozen=True, slots=True)
class Question:
    """A predicate ("marked seasoned" for a mark) and the names of fixtures and objects in it."""

    predicate: str
    names: tuple[str, ...] = ()


@lru_cache(maxsize=1)
def predicates() -> tuple[str, ...]:
    """What can be asked: what is seen and is not up to the round itself, and marks that are drawn."""
    seen = [row.name for row in PREDICATES.values() if row.kind == "seen" and not row.settled]
    return (*seen, *(_marked(mark) for mark in _DRAWN_MARKS))


@lru_cache(maxsize=4096)
def question_of(condition: Condition) -> Question | None:
    """The question that a condition puts; None where no picture answers it."""
    row = PREDICATES.get(condition.predicate)
    if row is None or condition.predicate in settled():
        return None
    names = tuple(arg for arg, kind in zip(condition.args, row.about, strict=True) if kind not in ("robot", "mark"))
    marks = [arg for arg, kind in zip(condition.args, row.about, strict=True) if kind == "mark"]
    asked = _marked(marks[0]) if marks else condition.predicate
    return Question(asked, names) if asked in predicates() else None


def robot_of(condition: Condition) -> str | None:
    """The robot that a condition is about: none but its own pictures tell."""
    about = PREDICATES[condition.predicate].about
    return next((arg for arg, kind in zip(condition.args, about, strict=True) if kind == "robot"), None)


def words_of(name: str) -> tuple[str, ...]:
    """The words of a name."""
    return tuple(name.split("_"))


def _marked(mark: str) -> str:
    return f"marked {mark}"
