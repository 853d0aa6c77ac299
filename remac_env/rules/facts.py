"""What cannot change in a kitchen during an episode, with all that the skill table reads: the rules' side of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from remac_env.frozen import FrozenMap

ASIDE = "aside"
"""The station away from everything. Any number of robots may stand there."""


@dataclass(frozen=True, slots=True)
class SlotFacts:
    """A place on a surface that can hold one object: its `name`, its `fixture`, the `station` from which it is used.

    `across`: the station on its other side, "" for none.
    """

    name: str
    fixture: str
    station: str
    across: str = ""

    @property
    def stations(self) -> tuple[str, ...]:
        """Where robots stand to use it."""
        return (self.station, self.across) if self.across else (self.station,)


@dataclass(frozen=True, slots=True)
class FixtureFacts:
    """Something that stays where it is: its `name`, its `kind`, the `station` from which it is used, and whether it
    has a `door`. `switches` are what `turn on` and `turn off` act on; `slots` what it can hold.

    A fixture that has one switch per slot (a stove) lists its slots. `shut_to_run`: it can only be switched on with its
    door closed. `wets`: where its water runs. `gives`: the mark that it leaves on what is in it while it works.
    """

    name: str
    kind: str
    station: str
    door: bool = False
    switches: tuple[str, ...] = ()
    slots: tuple[str, ...] = ()
    shut_to_run: bool = False
    wets: tuple[str, ...] = ()
    gives: str = ""

    @property
    def switch_per_slot(self) -> bool:
        """True where each slot has a switch of its own, as the burners of a stove."""
        return bool(self.switches) and self.switches == self.slots


@dataclass(frozen=True, slots=True)
class ObjectFacts:
    """An object that can be carried: its `name`, and the `category` that it is of.

    `needs_vessel_in`, `vessel_in`, `too_big_for`, `too_deep_in` name fixture kinds: meat needs a vessel in a sink, a
    bowl is one, a plate leaves no room for a hand in a microwave, and no hand reaches into a bowl in a cabinet.
    `holds`: how many objects fit on or in it; `seasons`: a shaker; `small`: it fits into a vessel; `washable`: water
    leaves it washed.
    """

    name: str
    category: str
    needs_vessel_in: frozenset[str] = frozenset()
    vessel_in: frozenset[str] = frozenset()
    holds: int = 0
    seasons: bool = False
    small: bool = True
    washable: bool = False
    too_big_for: frozenset[str] = frozenset()
    too_deep_in: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Quirk:
    """A fact about one kitchen that nobody can guess: its `kind`, a row of `remac_env.rules.quirks`, and what it is
    `about`, with the `other` thing where there are two."""

    kind: str
    about: str
    other: str = ""


@dataclass(frozen=True, slots=True)
class Process:
    """Something that takes its time by itself: a row of `remac_env/rules/processes.toml`, by `name`.

    Attributes:
        during: while what is so; where that ends, it begins anew. needs: marks that the object must have.
        does: "mark", "shut" or "off", after so many `seconds` (simulated). mark: the one that it leaves.
        spoils: what is so marked is lost for every goal that names it.
        shows: what pictures show of it. text, told: it in words, and what is said of it while it goes on.
        about: the objects or fixtures that it is about, all where empty.
    """

    name: str
    during: str
    does: str
    seconds: float
    mark: str = ""
    needs: frozenset[str] = frozenset()
    spoils: bool = False
    shows: str = ""
    text: str = ""
    told: str = ""
    about: tuple[str, ...] = ()

    def of(self, about: tuple[str, ...]) -> Process:
        """The same about these objects or fixtures alone."""
        return replace(self, about=about)


@dataclass(frozen=True)
class Rules:
    """Everything about a kitchen that an episode cannot change.

    Attributes:
        robots: their names.
        fixtures, slots, objects: by name.
        conflicts: pairs of stations that two robots cannot use at the same time.
        quirks: facts of this kitchen alone. Only who is given the truth is given them (`without_quirks`).
        orders: pairs of marks, (first, then), of which it is noted where they come the other way round.
        processes: what takes its time by itself; what else marks objects does so at once.
        hides: nobody knows what is behind a shut door before it was open.
    """

    robots: tuple[str, ...]
    fixtures: FrozenMap[FixtureFacts]
    slots: FrozenMap[SlotFacts]
    objects: FrozenMap[ObjectFacts]
    conflicts: frozenset[frozenset[str]] = frozenset()
    quirks: tuple[Quirk, ...] = ()
    orders: tuple[tuple[str, str], ...] = ()
    hides: bool = False
    processes: tuple[Process, ...] = ()

    @cached_property
    def slow(self) -> frozenset[str]:
        """The marks that take their time."""
        return frozenset(process.mark for process in self.processes if process.mark)

    @cached_property
    def without_quirks(self) -> Rules:
        """The same kitchen as everybody takes it to be; itself where it has no quirks."""
        return replace(self, quirks=()) if self.quirks else self

    @cached_property
    def givers(self) -> tuple[FixtureFacts, ...]:
        """The fixtures that leave a mark on what is in them."""
        return tuple(facts for facts in self.fixtures.values() if facts.gives)

    @cached_property
    def stations(self) -> tuple[str, ...]:
        """All stations, in the order of the fixtures and then of the slots, without `aside`."""
        names = [fixture.station for fixture in self.fixtures.values()]
        names += [station for slot in self.slots.values() for station in slot.stations]
        return tuple(dict.fromkeys(names))

    @cached_property
    def two_sided(self) -> bool:
        """Whether two robots can reach one slot at the same time, from two sides of it."""
        return any(slot.across for slot in self.slots.values())

    @cached_property
    def taps(self) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """The fixtures that give water, each with those into which it runs."""
        return tuple((name, facts.wets) for name, facts in self.fixtures.items() if facts.wets)

    @cached_property
    def washables(self) -> tuple[str, ...]:
        """The objects that running water leaves washed."""
        return tuple(name for name, facts in self.objects.items() if facts.washable)

    @cached_property
    def shakers(self) -> frozenset[str]:
        """The objects that season."""
        return frozenset(name for name, facts in self.objects.items() if facts.seasons)

    @cached_property
    def _stations_of(self) -> dict[str, tuple[str, ...]]:
        of = {name: [self.slots[slot] for slot in facts.slots] for name, facts in self.fixtures.items()}
        at = {name: [*(s.station for s in slots), *(s.across for s in slots if s.across)] for name, slots in of.items()}
        return {name: tuple(dict.fromkeys(names or [self.fixtures[name].station])) for name, names in at.items()}

    @cached_property
    def _fixtures_at(self) -> dict[str, tuple[str, ...]]:
        at = self._stations_of
        return {station: tuple(name for name in at if station in at[name]) for station in self.stations}

    def stations_of(self, fixture: str) -> tuple[str, ...]:
        """The stations from which a fixture can be used: those of its slots, in their order, else its own."""
        return self._stations_of[fixture]

    def used_from(self, station: str) -> tuple[str, ...]:
        """The fixtures that can be used from a station."""
        return self._fixtures_at.get(station, ())

    def conflicting(self, first: str, second: str) -> bool:
        """True when two robots cannot stand at these stations at the same time."""
        if first == second:
            return first != ASIDE
        return frozenset((first, second)) in self.conflicts and ASIDE not in (first, second)
