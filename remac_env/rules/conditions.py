"""A sentence about a kitchen that is true or false, as data: a predicate and its arguments.

The same value is a line of text for a language model, a question for a checker and a test on the truth.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from remac_env.rules.facts import Rules
from remac_env.rules.predicates import PREDICATES, Kind
from remac_env.rules.scene import PublicScene
from remac_env.state import WorldState


@dataclass(frozen=True, slots=True)
class Condition:
    """A `predicate` (a key of PREDICATES) with its arguments `args`, all names of robots, fixtures or objects."""

    predicate: str
    args: tuple[str, ...]

    @property
    def sentence(self) -> str:
        """The condition in plain English, as a checker or a language model reads it."""
        return _sentence(self.predicate, self.args)

    def holds(self, rules: Rules, world: WorldState) -> bool:
        """Whether the condition is true in this world."""
        return PREDICATES[self.predicate].test(rules, world, *self.args)

    @property
    def kind(self) -> Kind:
        """What its answer comes from: pictures, a robot's own gripper, knowledge of a rule, or what was run."""
        row = PREDICATES.get(self.predicate)
        return "seen" if row is None else row.kind

    def felt(self, scene: PublicScene, holding: Mapping[str, str | None]) -> bool | None:
        """The answer of the gripper, for the kind `felt`; None for other kinds, and where nothing is felt of the robot.

        Args:
            holding: robot -> the object in its gripper, None for an empty one.
        """
        row = PREDICATES.get(self.predicate)
        if row is None or row.feel is None or self.args[0] not in holding:
            return None
        robot, *others = self.args
        return row.feel(scene.shakers, holding[robot], *others)


@dataclass(frozen=True, slots=True)
class Denial(Condition):
    """That a condition does not hold, for those that no predicate is the opposite of; see `denied`."""

    @property
    def condition(self) -> Condition:
        """What is denied."""
        return Condition(self.args[0], self.args[1:])

    @property
    def sentence(self) -> str:
        """The denial in plain English."""
        return f"it is not so that {self.condition.sentence}"

    @property
    def kind(self) -> Kind:
        """That of what is denied."""
        return self.condition.kind

    def holds(self, rules: Rules, world: WorldState) -> bool:
        """Whether what is denied is false in this world."""
        return not self.condition.holds(rules, world)

    def felt(self, scene: PublicScene, holding: Mapping[str, str | None]) -> bool | None:
        """The gripper's answer to what is denied, turned round."""
        answer = self.condition.felt(scene, holding)
        return None if answer is None else not answer


def denied(condition: Condition) -> Denial:
    """The denial of a condition: a predicate "not" with the condition's predicate and arguments."""
    return Denial("not", (condition.predicate, *condition.args))


@lru_cache(maxsize=4096)
def _sentence(predicate: str, args: tuple[str, ...]) -> str:
    return PREDICATES[predicate].sentence.format(*args)


def condition(predicate: str, *args: str) -> Condition:
    """Shorthand for Condition(predicate, args)."""
    return Condition(predicate, args)
