"""What a network that looks at pictures is asked: a condition without the robot whose pictures they are.

Of two predicates one of which denies the other one alone is asked: "not open yet" is "open", turned round. Names are
told by their words ("worktop_left": worktop, left), so that a name of known words is a known name.
"""

from __future__ import annotations

from collections.abc import Collection
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


RARE = "of what was rarely met"
"""In kinds: about a name one of whose words was met in few kitchens."""


def kinds_of(question: Question, common: Collection[str]) -> tuple[str, ...]:
    """What a question is one of, the narrowest first: each kind has levels of its own from which on it is answered.

    Args:
        common: the words that were met often.
    """
    if not all(word in common for name in question.names for word in words_of(name)):
        return (f"{question.predicate} {RARE}",)
    spans = (question.names[index:] for index in range(len(question.names) + 1))
    return tuple(" ".join((question.predicate, *names)) for names in spans)


@lru_cache(maxsize=1)
def predicates() -> tuple[str, ...]:
    """What can be asked: what is seen, denies nothing and is not up to the round itself, and marks that are drawn."""
    seen = [row.name for row in PREDICATES.values() if row.kind == "seen" and not row.settled and row.denies is None]
    return (*seen, *(_marked(mark) for mark in _DRAWN_MARKS))


@lru_cache(maxsize=1)
def opposed() -> frozenset[str]:
    """What is asked for its opposite, too: a condition may be false by either answer."""
    return frozenset(row.denies for row in PREDICATES.values() if row.denies is not None)


@lru_cache(maxsize=4096)
def question_of(condition: Condition) -> Question | None:
    """The question that a condition, or what it denies, puts; None where no picture answers it. See `turned`."""
    row = PREDICATES.get(condition.predicate)
    if row is None or condition.predicate in settled():
        return None
    names = tuple(arg for arg, kind in zip(condition.args, row.about, strict=True) if kind not in ("robot", "mark"))
    marks = [arg for arg, kind in zip(condition.args, row.about, strict=True) if kind == "mark"]
    asked = _marked(marks[0]) if marks else row.denies or condition.predicate
    return Question(asked, names) if asked in predicates() else None


def turned(condition: Condition) -> bool:
    """Whether a condition is true where the answer to its question is false."""
    return PREDICATES[condition.predicate].denies is not None


def robot_of(condition: Condition) -> str | None:
    """The robot that a condition is about: none but its own pictures tell."""
    about = PREDICATES[condition.predicate].about
    return next((arg for arg, kind in zip(condition.args, about, strict=True) if kind == "robot"), None)


def words_of(name: str) -> tuple[str, ...]:
    """The words of a name."""
    return tuple(name.split("_"))


def _marked(mark: str) -> str:
    return f"marked {mark}"
