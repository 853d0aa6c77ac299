"""Goals are values: they state themselves, judge a WorldState and report progress."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import get_args

from remac_env.rules.facts import Rules
from remac_env.state import FLOOR, Door, WorldState, base_place, inside, supports
from remac_env.tasks.shape import NAME, TEXT, Shape, check_fields, one_of, optional, several

_NAME_FIELDS = ("name", "container", "fixture", "under")

_DOORS: tuple[str, ...] = get_args(Door)
_NAMES = {
    "only_on": optional(several(TEXT)),
    "under": optional(TEXT),
    "door": Shape(", ".join(_DOORS), lambda value: isinstance(value, str) and value in _DOORS),
}
"""Fields that take something else than a name."""

VERBS = {"washed": "wash", "seasoned": "season", "heated": "heat", "cooled": "cool", "dried": "dry", "filled": "fill"}
"""What is asked for where a mark is wanted."""


class Goal(ABC):
    """What has to be true at the end."""

    @property
    @abstractmethod
    def text(self) -> str:
        """The goal in plain English."""

    @abstractmethod
    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Whether the goal is reached."""

    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """The objects and fixtures that it speaks of."""

    @abstractmethod
    def bind(self, names: Mapping[str, str]) -> Goal:
        """A copy with `{role}` fields filled in."""

    def atoms(self) -> Iterator[Goal]:
        """The parts that all have to hold, each true or false by itself."""
        yield self

    def leaves(self) -> Iterator[Goal]:
        """The smallest goals in it, whether or not all of them have to hold."""
        yield self

    def told(self, wording: int) -> str:
        """The goal as a request in wording 1, 2 or 3 (`Options.wording`), without a stop; "" where it goes unsaid."""
        return f"see to it that {self.text}"

    def untold(self, wording: int) -> str:
        """The request that it be not so."""
        return f"see to it that it is not so that {self.text}"

    def reached(self, scene: Rules, world: WorldState) -> float:
        """How much of it is reached, 0..1; 1 where it holds."""
        return float(self.holds(scene, world))

    def beyond(self, scene: Rules, world: WorldState) -> bool:
        """Whether an object that it cannot do without lies where no robot can reach it: a rule, not a search."""
        objects = scene.objects
        return any(base_place(world, name).relation == FLOOR.relation for name in self.names() if name in objects)


GOAL = one_of(Goal, "a value of remac_env.tasks.goals")
"""What the fields of goals made of goals take."""


@dataclass(frozen=True)
class _Atom(Goal):
    """A goal with no parts; its fields are names."""

    def __post_init__(self) -> None:
        """Refuse what is no name: OptionError."""
        check_fields(self, {name: _NAMES.get(name, NAME) for name in self._fields()}, type(self).__name__)

    def _fields(self) -> dict[str, object]:
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def bind(self, names: Mapping[str, str]) -> Goal:
        """A copy with `{role}` fields filled in."""
        return type(self)(**{key: _filled(value, names) for key, value in self._fields().items()})

    def names(self) -> tuple[str, ...]:
        """The objects and fixtures that the goal speaks of."""
        return self._names

    @cached_property
    def _names(self) -> tuple[str, ...]:
        return tuple(str(v) for k, v in self._fields().items() if k in _NAME_FIELDS and v)


def _filled(value: object, names: Mapping[str, str]) -> object:
    if isinstance(value, tuple):
        return tuple(_filled(part, names) for part in value)
    return value.format(**names) if isinstance(value, str) else value


@dataclass(frozen=True)
class Inside(_Atom):
    """`name` is on or in `container`; where `only_on` is given, on nothing else than these vessels on the way."""

    name: str
    container: str
    only_on: tuple[str, ...] | None = None

    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Whether it is there."""
        if not inside(scene, world, self.name, self.container):
            return False
        vessels = [other for other in supports(scene, world, self.name) if other in scene.objects]
        return self.only_on is None or all(vessel in self.only_on for vessel in vessels)

    def told(self, wording: int) -> str:
        """To put it there."""
        how = ("pick up the {0} and place it into the {1}", "place the {0} into the {1}", "put the {0} into the {1}")
        return how[wording - 1].format(self.name, self.container)

    def untold(self, wording: int) -> str:
        """To keep it out."""
        return f"keep the {self.name} out of the {self.container}"

    @property
    def text(self) -> str:
        """The goal in plain English."""
        return f"the {self.name} is on or in the {self.container}"


@dataclass(frozen=True)
class Released(_Atom):
    """No robot holds `name`."""

    name: str

    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Whether every gripper has let go of it."""
        return all(robot.holding != self.name for robot in world.robots.values())

    def told(self, wording: int) -> str:
        """Nothing: who is asked to put something down lets go of it."""
        return ""

    @property
    def text(self) -> str:
        """The goal in plain English."""
        return f"no robot holds the {self.name}"


@dataclass(frozen=True)
class SwitchedOn(_Atom):
    """`fixture` is on; with `under`, the switch of the very slot in which that object stands."""

    fixture: str
    under: str = ""

    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Whether it is on."""
        on = world.fixtures[self.fixture].on
        return bool(on) if not self.under else world.objects[self.under].place.where in on

    def told(self, wording: int) -> str:
        """To turn it on."""
        return f"turn on the {self.fixture}"

    def untold(self, wording: int) -> str:
        """To have it off."""
        return f"turn off the {self.fixture}" if wording < 3 else f"leave the {self.fixture} off"

    @property
    def text(self) -> str:
        """The goal in plain English."""
        return f"the {self.fixture} is on" + (f" under the {self.under}" if self.under else "")


@dataclass(frozen=True)
class DoorIs(_Atom):
    """The door of `fixture` is closed or open."""

    fixture: str
    door: Door

    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Whether the door is so."""
        return world.fixtures[self.fixture].door == self.door

    def told(self, wording: int) -> str:
        """To open or close it."""
        return f"{'close' if self.door == 'closed' else 'open'} the {self.fixture} door"

    @property
    def text(self) -> str:
        """The goal in plain English."""
        return f"the {self.fixture} door is {self.door}"


@dataclass(frozen=True)
class Marked(_Atom):
    """`mark` has happened to `name` (seasoned, washed)."""

    name: str
    mark: str

    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Whether it has happened."""
        return self.mark in world.objects[self.name].marks

    def told(self, wording: int) -> str:
        """To do it."""
        verb = VERBS.get(self.mark)
        return f"{verb} the {self.name}" if verb else super().told(wording)

    @property
    def text(self) -> str:
        """The goal in plain English."""
        return f"the {self.name} has been {self.mark}"


@dataclass(frozen=True, init=False)
class All(Goal):
    """Every one of `goals`."""

    goals: tuple[Goal, ...]

    def __init__(self, *goals: Goal) -> None:
        object.__setattr__(self, "goals", tuple(goals))
        check_fields(self, {"goals": several(GOAL)}, "All")

    def atoms(self) -> Iterator[Goal]:
        """The parts of all parts."""
        for goal in self.goals:
            yield from goal.atoms()

    def leaves(self) -> Iterator[Goal]:
        """Those of all parts."""
        for goal in self.goals:
            yield from goal.leaves()

    def told(self, wording: int) -> str:
        """One request after the other; in wording 2 the last comes first."""
        said = [told for goal in self.goals if (told := goal.told(wording))]
        said = said[::-1] if wording == 2 else said
        return ", ".join(said[:-1]) + f"{' and ' if said[1:] else ''}{said[-1]}" if said else ""

    def beyond(self, scene: Rules, world: WorldState) -> bool:
        """Whether that is so of any part."""
        return any(goal.beyond(scene, world) for goal in self.goals)

    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Whether all hold."""
        return all(goal.holds(scene, world) for goal in self.goals)

    def names(self) -> tuple[str, ...]:
        """The objects and fixtures that the goals speak of, each once."""
        return self._names

    @cached_property
    def _names(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(name for goal in self.goals for name in goal.names()))

    def bind(self, names: Mapping[str, str]) -> Goal:
        """A copy with `{role}` fields filled in."""
        return All(*(goal.bind(names) for goal in self.goals))

    @property
    def text(self) -> str:
        """The goals in plain English."""
        return " and ".join(goal.text for goal in self.goals)


def progress(goal: Goal, scene: Rules, world: WorldState) -> float:
    """How much of the goal's parts is reached, 0..1."""
    reached = [atom.reached(scene, world) for atom in goal.atoms()]
    return sum(reached) / len(reached)


def lost(goal: Goal, scene: Rules, world: WorldState) -> bool:
    """True when what the goal cannot do without lies where no robot can reach it: a rule, not a search."""
    return goal.beyond(scene, world)
