"""What anybody may know of a kitchen: names, and what can be said to them. The commands and the text say no more.

Three kinds of facts are told apart. `PublicScene`: which robots, fixtures, objects and stations exist. `Rules`: what
the skill table enforces or advises about them (what needs a vessel, what has to be shut to run, what is too big).
`WorldState`: what is true now.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Literal

from remac_env.frozen import FrozenMap
from remac_env.rules.facts import ASIDE, Rules

NameKind = Literal["robot", "thing", "object", "food", "vessel", "surface", "fixture", "door", "switch"]
"""A kind of names."""

NAME_KINDS: tuple[NameKind, ...] = NameKind.__args__  # type: ignore[attr-defined]
"""Kinds of names: what commands and sentences are about."""


@dataclass(frozen=True, slots=True)
class PublicFixture:
    """Something that stays where it is, by `name`: the `stations` where robots stand to use it, and whether it has a
    `door` or a `switch`.

    `room`: how many objects it takes side by side, what they carry not counted; 0 for one that takes none.
    """

    name: str
    stations: tuple[str, ...]
    door: bool = False
    switch: bool = False
    room: int = 0


@dataclass(frozen=True, slots=True)
class PublicObject:
    """An object that can be carried, by `name`. `vessel`: other objects can be placed on or in it; `seasons`: it is a
    shaker."""

    name: str
    vessel: bool = False
    seasons: bool = False


@dataclass(frozen=True)
class PublicScene:
    """A kitchen without its rules: the names of `robots`, and `fixtures` and `objects` by name.

    `conflicts`: pairs of stations that two robots cannot use at the same time.
    """

    robots: tuple[str, ...]
    fixtures: FrozenMap[PublicFixture]
    objects: FrozenMap[PublicObject]
    conflicts: frozenset[frozenset[str]] = frozenset()

    def stations_of(self, fixture: str) -> tuple[str, ...]:
        """The stations from which a fixture can be used."""
        return self.fixtures[fixture].stations

    @property
    def stations(self) -> tuple[str, ...]:
        """All stations, in the order of the fixtures, without `aside`."""
        return tuple(dict.fromkeys(name for fixture in self.fixtures.values() for name in fixture.stations))

    def used_from(self, station: str) -> tuple[str, ...]:
        """The fixtures that can be used from a station."""
        return tuple(name for name, fixture in self.fixtures.items() if station in fixture.stations)

    @cached_property
    def shakers(self) -> frozenset[str]:
        """The objects that season."""
        return frozenset(name for name, obj in self.objects.items() if obj.seasons)

    def names(self, kind: NameKind) -> tuple[str, ...]:
        """Every name of a kind, fixtures before objects."""
        return self._names[kind]

    @cached_property
    def _names(self) -> dict[NameKind, tuple[str, ...]]:
        fixtures, objects = self.fixtures, self.objects
        vessels = tuple(name for name, obj in objects.items() if obj.vessel)
        return {
            "robot": self.robots,
            "thing": (*fixtures, *objects),
            "object": tuple(objects),
            "food": tuple(objects),  # anything can be seasoned
            "vessel": vessels,
            "surface": (*(name for name, fixture in fixtures.items() if fixture.room), *vessels),
            "fixture": tuple(fixtures),
            "door": tuple(name for name, fixture in fixtures.items() if fixture.door),
            "switch": tuple(name for name, fixture in fixtures.items() if fixture.switch),
        }

    def conflicting(self, first: str, second: str) -> bool:
        """True when two robots cannot stand at these stations at the same time."""
        if first == second:
            return first != ASIDE
        return frozenset((first, second)) in self.conflicts and ASIDE not in (first, second)


@lru_cache(maxsize=64)
def public_scene(rules: Rules) -> PublicScene:
    """The public part of a kitchen."""
    return PublicScene(
        robots=rules.robots,
        fixtures=FrozenMap(
            {
                name: PublicFixture(
                    name, rules.stations_of(name), facts.door, bool(facts.switches), len(facts.slots)
                )
                for name, facts in rules.fixtures.items()
            }
        ),
        objects=FrozenMap(
            # In the order of their names: in the order of the draw the task's own objects would come first.
            {n: PublicObject(n, facts.holds > 0, facts.seasons) for n, facts in sorted(rules.objects.items())}
        ),
        conflicts=rules.conflicts,
    )
