"""Conditions in a model's own words, which no rule can decide: only a checker with a model judges them."""

from __future__ import annotations

from dataclasses import dataclass

from remac_env.conditions import Condition
from remac_env.state import Scene, WorldState

_PREDICATE = "free text"


@dataclass(frozen=True, slots=True)
class FreeText(Condition):
    """A condition whose only argument is its sentence."""

    @classmethod
    def of(cls, sentence: str) -> FreeText:
        """The condition that a sentence states."""
        return cls(_PREDICATE, (sentence,))

    @property
    def sentence(self) -> str:
        """The words themselves."""
        return self.args[0]


def truth_of(condition: Condition, scene: Scene, world: WorldState | None) -> bool | None:
    """Whether a condition is true; None where the world is not known, or the words are a model's own."""
    if world is None or isinstance(condition, FreeText):
        return None
    return condition.holds(scene, world)
