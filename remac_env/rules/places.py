"""Where objects can be used, go and land in a kitchen, which switch a command means, and what an open door stops."""

from __future__ import annotations

from remac_env.rules.facts import Rules
from remac_env.state import Door, Place, WorldState, base_place, contents, occupant


def stations_of(rules: Rules, world: WorldState, target: str) -> tuple[str, ...]:
    """The stations from which `target` can be used; empty for an object that is held or on the floor."""
    if target in rules.fixtures:
        return rules.stations_of(target)
    place = base_place(world, target)
    return rules.slots[place.where].stations if place.relation == "slot" else ()


def destination(rules: Rules, world: WorldState, robot: str, target: str) -> str | None:
    """The station at which `navigate to target` ends for this robot, or None when there is none.

    Of several stations (a long counter) the robot keeps its own, else takes the first with a free slot that no other
    robot uses, else the first with a free slot, else the first; of an object's the same, whatever is free.
    """
    options = stations_of(rules, world, target)
    if len(options) < 2:
        return options[0] if options else None
    here = world.robots[robot].station
    full = {item.place.where for item in world.objects.values() if item.place.relation == "slot"}
    fixture = rules.fixtures.get(target)
    slots = () if fixture is None else (rules.slots[name] for name in fixture.slots if name not in full)
    roomy = set(options) if fixture is None else {station for slot in slots for station in slot.stations}
    if here in roomy:
        return here
    free = [name for name in options if name in roomy]
    taken = [state.station for other, state in world.robots.items() if other != robot]
    quiet = (name for name in free if not any(rules.conflicting(name, other) for other in taken))
    return next(quiet, (free or options)[0])


def landing(rules: Rules, world: WorldState, robot: str, target: str) -> Place | None:
    """Where `place to target` puts what the robot holds, or None when there is no room.

    On a fixture: a free slot at the robot's station, a lit burner before others; else a vessel that belongs there and
    has room, as the plate in a cupboard. On a vessel: the vessel, unless it is full or too deep for the hand where it
    stands. Neither where the object is too big for the fixture around.
    """
    held, kind = world.robots[robot].holding, kind_around(rules, world, target)
    if held is not None and kind in rules.objects[held].too_big_for:
        return None
    if target in rules.objects:
        small = held is None or rules.objects[held].small
        return Place("vessel", target) if small and has_room(rules, world, target) and held != target else None
    here = world.robots[robot].station
    slots = [name for name in rules.fixtures[target].slots if here in rules.slots[name].stations]
    if slots and rules.slots[slots[0]].across == here:
        slots.reverse()  # from the other side the last are the nearest
    free = [name for name in slots if occupant(world, name) is None]
    lit = [name for name in free if name in world.fixtures[target].on]
    if free:
        return Place("slot", (lit + free)[0])
    vessels = [name for slot in slots if (name := occupant(world, slot)) and kind in rules.objects[name].vessel_in]
    places = (landing(rules, world, robot, name) for name in vessels)
    return next((place for place in places if place is not None), None)


def has_room(rules: Rules, world: WorldState, vessel: str) -> bool:
    """Whether a vessel takes one more object: it is not full, and a hand reaches into it where it stands."""
    facts = rules.objects[vessel]
    return len(contents(world, vessel)) < facts.holds and kind_around(rules, world, vessel) not in facts.too_deep_in


def switch_for(rules: Rules, world: WorldState, fixture: str) -> str:
    """The switch that `turn on` acts on: with a switch per slot, that under a vessel, best one that belongs there."""
    facts = rules.fixtures[fixture]
    if not facts.switch_per_slot:
        return facts.switches[0]
    used = {n: t for n in facts.slots if (o := occupant(world, n)) is not None and (t := rules.objects[o]).holds}
    return min(used, key=lambda name: facts.kind not in used[name].vessel_in, default=facts.switches[0])


def kind_around(rules: Rules, world: WorldState, target: str) -> str:
    """The kind of a fixture, or of that in or on which an object stands; "" for what is held or on the floor."""
    if target in rules.fixtures:
        return rules.fixtures[target].kind
    place = base_place(world, target)
    return rules.fixtures[rules.slots[place.where].fixture].kind if place.relation == "slot" else ""


def unshut(rules: Rules, world: WorldState, fixture: str, door: Door) -> WorldState:
    """The world once a door is no longer shut, whatever moved it: what runs only with it shut stops."""
    left = world.with_fixture(fixture, door=door)
    return left.with_fixture(fixture, on=frozenset()) if rules.fixtures[fixture].shut_to_run else left
