"""From a layout and a choice of objects to the Rules that planners, checks and both backends share."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace

from remac_env.kitchen import annexes as annex
from remac_env.kitchen.fixtures import KINDS
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.objects.catalogue import Category
from remac_env.rules.facts import FixtureFacts, ObjectFacts, Rules, SlotFacts
from remac_env.state import FixtureState, FrozenMap


def build_scene(
    layout: Layout,
    categories: Mapping[str, Category],
    robots: Sequence[str],
    *,
    annexes: Sequence[str] = (),
    gives: Sequence[str] = (),
) -> Rules:
    """The facts of a kitchen: the layout's usable fixtures, and `categories` (noun -> category).

    Args:
        annexes: further fixtures; one that the layout has is that of the layout.
        gives: marks that fixtures give.
    """
    basins = {name: str(f.station) for name, f in layout.fixtures.items() if f.catches_water}
    slots_of: dict[str, list[str]] = defaultdict(list)
    for slot in layout.slots.values():
        slots_of[layout.noun(slot)].append(slot.name)
    fixtures = {
        name: FixtureFacts(
            name=name,
            kind=fixture.kind,
            station=str(fixture.station),
            door=fixture.door,
            switches=tuple(fixture.switches),
            slots=tuple(slots_of[name]),
            shut_to_run=fixture.shut_to_run,
            wets=tuple(n for n, at in basins.items() if fixture.gives_water and at == fixture.station),
            gives=fixture.gives if fixture.gives in gives else "",
        )
        for name, fixture in layout.fixtures.items()
        if fixture.station is not None and not fixture.part_of
    }
    # A kitchen's facts are about the usual kinds, and about those others that it has.
    present = {fixture.kind for fixture in layout.fixtures.values()}
    absent = {kind for kind, cls in KINDS.items() if cls.like and kind not in present}
    objects = {
        noun: ObjectFacts(
            name=noun,
            category=category.name,
            needs_vessel_in=frozenset(category.needs_vessel_in),
            vessel_in=frozenset(category.vessel_in),
            holds=category.holds,
            seasons=category.seasons,
            small=category.small,
            washable="washable" in category.attributes,
            too_big_for=(category.too_big_for - absent)
            | {fixture.kind for fixture in layout.fixtures.values() if not fixture.takes(category.size)},
            too_deep_in=category.too_deep_in - absent,
        )
        for noun, category in categories.items()
    }
    slots = {name: SlotFacts(name, layout.noun(slot), slot.station) for name, slot in layout.slots.items()}
    for facts in (annex.get(name) for name in annexes if name not in fixtures):
        fixtures[facts.name] = replace(facts, gives=facts.gives if facts.gives in gives else "")
        slots |= annex.slots_of(facts)
    return Rules(tuple(robots), FrozenMap(fixtures), FrozenMap(slots), FrozenMap(objects), layout.conflicts())


def resting_fixtures(scene: Rules) -> FrozenMap[FixtureState]:
    """Every door closed and everything off."""
    return FrozenMap({n: FixtureState("closed" if f.door else None) for n, f in scene.fixtures.items()})

