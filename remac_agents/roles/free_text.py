"""Conditions in a model's own words, which no rule can decide: only a checker with a model judges them."""

from __future__ import annotations

import re
from dataclasses import dataclass

from remac_env.rules.conditions import Condition
from remac_env.rules.facts import Rules
from remac_env.rules.predicates import Kind
from remac_env.state import WorldState

_PREDICATE = "free text"

_OUGHT = re.compile(
    r"\b(may|might|can|could|cannot|allowed|permitted|safe|suitable|appropriate|right|correct|proper|fits?|"
    r"too (big|large|small|deep|heavy|hot)|(big|large|small|deep) enough)\b"
    r"|\b(must|should|ought|has to|needs?|requires?|required)\b.*\b(before|without|unless|until|never|first)\b",
    re.I,
)
"""Words of a sentence about what is right or possible, which no picture shows. "The lid must be shut" is none: as a
condition it says that the lid is shut."""


@dataclass(frozen=True, slots=True)
class FreeText(Condition):
    """A condition whose only argument is its sentence: no predicate says the same."""

    @classmethod
    def of(cls, sentence: str) -> FreeText:
        """The condition that a sentence states."""
        return cls(_PREDICATE, (sentence,))

    @property
    def sentence(self) -> str:
        """The words themselves."""
        return self.args[0]

    @property
    def kind(self) -> Kind:
        """Known where the words are about what is right or possible, else seen."""
        return "known" if _OUGHT.search(self.sentence) else "seen"


def truth_of(condition: Condition, rules: Rules | None, world: WorldState | None) -> bool | None:
    """Whether a condition is true; None where the world is not known, or the words are a model's own."""
    if world is None or rules is None or isinstance(condition, FreeText):
        return None
    return condition.holds(rules, world)
