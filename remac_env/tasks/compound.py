"""Goals made of goals: any of several, none, so many of a kind, all of a kind, and in an order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from remac_env.rules.facts import Rules
from remac_env.rules.marks import too_early
from remac_env.state import WorldState
from remac_env.tasks.goals import GOAL, VERBS, Goal, progress
from remac_env.tasks.shape import NAME, TEXT, WHOLE, check_fields, several
from remac_env.values import python_value

EACH = "each"
"""The field of a goal about a kind that stands for one object of it: `Inside("{each}", "cabinet")`."""

_NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")


@dataclass(frozen=True, init=False)
class AnyOf(Goal):
    """At least one of `goals`."""

    goals: tuple[Goal, ...]

    def __init__(self, *goals: Goal) -> None:
        object.__setattr__(self, "goals", tuple(goals))
        check_fields(self, {"goals": several(GOAL, least=1)}, "AnyOf")

    @property
    def text(self) -> str:
        """The goals in plain English."""
        return " or ".join(goal.text for goal in self.goals)

    def leaves(self) -> Iterator[Goal]:
        """Those of all goals."""
        for goal in self.goals:
            yield from goal.leaves()

    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Whether one of them holds."""
        return any(goal.holds(scene, world) for goal in self.goals)

    def reached(self, scene: Rules, world: WorldState) -> float:
        """As much as of the one that has come farthest."""
        return max(progress(goal, scene, world) for goal in self.goals)

    def beyond(self, scene: Rules, world: WorldState) -> bool:
        """Whether all are."""
        return all(goal.beyond(scene, world) for goal in self.goals)

    def names(self) -> tuple[str, ...]:
        """All that they speak of."""
        return tuple(dict.fromkeys(name for goal in self.goals for name in goal.names()))

    def bind(self, names: Mapping[str, str]) -> Goal:
        """A copy with `{role}` fields filled in."""
        return AnyOf(*(goal.bind(names) for goal in self.goals))

    def told(self, wording: int) -> str:
        """This or that: what all have in common is said once."""
        said = [goal.told(wording).split() for goal in self.goals]
        said = said[::-1] if wording == 2 else said
        alike = [words[0] for words in zip(*said, strict=False) if len(set(words)) == 1]
        common = alike if all(words[: len(alike)] == alike for words in said) else []
        rest = " or ".join(" ".join(words[len(common) :]) for words in said)
        return f"{' '.join(common)} {rest}" if common else f"either {rest}"


@dataclass(frozen=True)
class Not(Goal):
    """`goal` does not hold."""

    goal: Goal

    def __post_init__(self) -> None:
        """Refuse what is no goal: OptionError."""
        check_fields(self, {"goal": GOAL}, "Not")

    @property
    def text(self) -> str:
        """The goal in plain English."""
        return f"it is not so that {self.goal.text}"

    def leaves(self) -> Iterator[Goal]:
        """Those of what must not be."""
        yield from self.goal.leaves()

    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Whether it is not so."""
        return not self.goal.holds(scene, world)

    def beyond(self, scene: Rules, world: WorldState) -> bool:
        """Never: what lies on the floor is where it must not be."""
        return False

    def names(self) -> tuple[str, ...]:
        """What it speaks of."""
        return self.goal.names()

    def bind(self, names: Mapping[str, str]) -> Goal:
        """A copy with `{role}` fields filled in."""
        return Not(self.goal.bind(names))

    def told(self, wording: int) -> str:
        """The request that it be not so."""
        return self.goal.untold(wording)


@dataclass(frozen=True)
class _OfKind(Goal):
    """A goal about objects of one kind. `each` speaks of one of them as `{each}`; `among` are all that there are."""

    kind: str
    each: Goal
    among: tuple[str, ...]

    def __post_init__(self) -> None:
        """Refuse what is no kind, goal or list of names: OptionError."""
        check_fields(self, {"kind": NAME, "each": GOAL, "among": several(TEXT)}, type(self).__name__)

    @property
    def parts(self) -> tuple[Goal, ...]:
        """The goal about each of them."""
        return tuple(self.each.bind({EACH: name}) for name in self.among)

    def leaves(self) -> Iterator[Goal]:
        """Those about each of them."""
        for goal in self.parts:
            yield from goal.leaves()

    def names(self) -> tuple[str, ...]:
        """The objects, and what else it speaks of."""
        return tuple(dict.fromkeys(name for goal in self.parts for name in goal.names()))

    def _bound(self, names: Mapping[str, str]) -> tuple[Goal, tuple[str, ...]]:
        return self.each.bind({EACH: f"{{{EACH}}}", **names}), tuple(name.format(**names) for name in self.among)

    def _said(self, of: str, wording: int) -> str:
        said = self.each.bind({EACH: of}).told(wording)
        return said.replace(f"the {of}", of)


@dataclass(frozen=True)
class ForAll(_OfKind):
    """What `each` says of one object of a kind holds of all `among`."""

    @property
    def text(self) -> str:
        """The goal in plain English."""
        return " and ".join(goal.text for goal in self.parts)

    def atoms(self) -> Iterator[Goal]:
        """The parts about each of them."""
        for goal in self.parts:
            yield from goal.atoms()

    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Whether it holds of all."""
        return all(goal.holds(scene, world) for goal in self.parts)

    def beyond(self, scene: Rules, world: WorldState) -> bool:
        """Whether that is so of any."""
        return any(goal.beyond(scene, world) for goal in self.parts)

    def bind(self, names: Mapping[str, str]) -> Goal:
        """A copy with `{role}` fields filled in."""
        return ForAll(self.kind, *self._bound(names))

    def told(self, wording: int) -> str:
        """Of every one; in wording 1 of one after the other."""
        if wording == 1:
            said = [goal.told(1) for goal in self.parts]
            return ", ".join(said[:-1]) + f"{' and ' if said[1:] else ''}{said[-1]}"
        return self._said(f"all {_several(self.kind)}" if wording == 2 else f"every {self.kind}", wording)


@dataclass(frozen=True)
class Count(_OfKind):
    """What `each` says of one object of a kind holds of at least `least` of those `among`, whichever they are."""

    least: int = field(kw_only=True)

    def __post_init__(self) -> None:
        """Refuse what is no number, too: OptionError."""
        super().__post_init__()
        object.__setattr__(self, "least", python_value(self.least))
        check_fields(self, {"least": WHOLE}, "Count")

    @property
    def text(self) -> str:
        """The goal in plain English."""
        each = self.each.bind({EACH: self.kind}).text
        return f"of {self.least} or more {_several(self.kind)} it is so that {each}"

    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Whether it holds of so many."""
        return sum(goal.holds(scene, world) for goal in self.parts) >= self.least

    def reached(self, scene: Rules, world: WorldState) -> float:
        """The fraction of those that are wanted."""
        best = sorted((progress(goal, scene, world) for goal in self.parts), reverse=True)
        return 1.0 if self.holds(scene, world) else sum(best[: self.least]) / self.least

    def beyond(self, scene: Rules, world: WorldState) -> bool:
        """Whether fewer are left."""
        return sum(not goal.beyond(scene, world) for goal in self.parts) < self.least

    def bind(self, names: Mapping[str, str]) -> Goal:
        """A copy with `{role}` fields filled in."""
        return Count(self.kind, *self._bound(names), least=self.least)

    def told(self, wording: int) -> str:
        """Of so many, whichever they are."""
        number = _NUMBERS[self.least] if self.least < len(_NUMBERS) else str(self.least)
        kinds = _several(self.kind)
        some = {1: f"{number} of the {kinds}", 2: f"any {number} {kinds}", 3: f"{number} {kinds}"}
        return self._said(some[wording] if self.least > 1 else f"a {self.kind}", wording)


@dataclass(frozen=True)
class Before(Goal):
    """To `name` the mark `first` has happened before the mark `then`, and both have (washed before it is heated).

    A kitchen in which it is judged keeps note of what comes too early (`TaskSpec.orders`).
    """

    name: str
    first: str
    then: str

    def __post_init__(self) -> None:
        """Refuse what is no name or mark: OptionError."""
        check_fields(self, dict.fromkeys(("name", "first", "then"), NAME), "Before")

    @property
    def text(self) -> str:
        """The goal in plain English."""
        return f"the {self.name} has been {self.first} before it was {self.then}"

    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Whether both have happened, in this order."""
        marks = world.objects[self.name].marks
        return {self.first, self.then} <= marks and too_early(self.first, self.then) not in marks

    def reached(self, scene: Rules, world: WorldState) -> float:
        """Half for the first of them."""
        marks = world.objects[self.name].marks
        wrong = too_early(self.first, self.then) in marks
        return 0.0 if wrong else ((self.first in marks) + (self.then in marks)) / 2

    def beyond(self, scene: Rules, world: WorldState) -> bool:
        """Whether it has happened too early, or the object lies on the floor."""
        return too_early(self.first, self.then) in world.objects[self.name].marks or super().beyond(scene, world)

    def names(self) -> tuple[str, ...]:
        """The object."""
        return (self.name,)

    def bind(self, names: Mapping[str, str]) -> Goal:
        """A copy with `{role}` fields filled in."""
        return Before(self.name.format(**names), self.first, self.then)

    def told(self, wording: int) -> str:
        """First the one, then the other."""
        first, then = VERBS.get(self.first, self.first), VERBS.get(self.then, self.then)
        how = (
            f"{first} the {self.name}, then {then} the {self.name}",
            f"{then} the {self.name} after it has been {self.first}",
            f"{first} the {self.name} and {then} it after that",
        )
        return how[wording - 1]


def _several(kind: str) -> str:
    return f"{kind}es" if kind.endswith("s") else f"{kind}s"
