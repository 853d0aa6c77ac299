"""What in a kitchen quirks of each kind can be about: pairs (about, other), "" for no other."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations

from remac_env.rules.facts import Rules


def doors(rules: Rules) -> Iterator[tuple[str, str]]:
    """Fixtures with a door."""
    yield from ((name, "") for name, facts in rules.fixtures.items() if facts.door)


def switches(rules: Rules) -> Iterator[tuple[str, str]]:
    """Fixtures with a switch."""
    yield from ((name, "") for name, facts in rules.fixtures.items() if facts.switches)


def burners(rules: Rules) -> Iterator[tuple[str, str]]:
    """The first burner of each range."""
    yield from ((facts.slots[0], "") for facts in rules.fixtures.values() if facts.switch_per_slot)


def switch_pairs(rules: Rules) -> Iterator[tuple[str, str]]:
    """Two different switches, in both orders."""
    yield from permutations([name for name, _ in switches(rules)], 2)


def distant_switches(rules: Rules) -> Iterator[tuple[str, str]]:
    """Two switches at which two robots can stand at once."""
    for one, other in switch_pairs(rules):
        ways = [(a, b) for a in rules.stations_of(one) for b in rules.stations_of(other)]
        if not any(rules.conflicting(a, b) for a, b in ways):
            yield one, other


def switch_and_door(rules: Rules) -> Iterator[tuple[str, str]]:
    """A switch, and the door of something else."""
    yield from ((one, other) for one, _ in switches(rules) for other, _ in doors(rules) if one != other)


def stores(rules: Rules) -> Iterator[tuple[str, str]]:
    """Fixtures with a door and room behind it."""
    yield from ((name, "") for name, facts in rules.fixtures.items() if facts.slots and facts.door)


def ranges(rules: Rules) -> Iterator[tuple[str, str]]:
    """Fixtures with a switch for each slot."""
    yield from ((name, "") for name, facts in rules.fixtures.items() if facts.switch_per_slot)


def vessels(rules: Rules) -> Iterator[tuple[str, str]]:
    """Vessels that can be washed."""
    yield from ((name, "") for name, facts in rules.objects.items() if facts.holds and facts.washable)


def objects(rules: Rules) -> Iterator[tuple[str, str]]:
    """Objects that are no vessels."""
    yield from ((name, "") for name, facts in rules.objects.items() if not facts.holds)


def worktops(rules: Rules) -> Iterator[tuple[str, str]]:
    """A store, and an open surface with several slots."""
    tops = [n for n, f in rules.fixtures.items() if len(f.slots) > 1 and not f.door and not f.switches and not f.gives]
    yield from ((store, top) for store, _ in stores(rules) for top in tops)
