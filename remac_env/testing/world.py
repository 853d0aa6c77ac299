"""check_world: a WorldState is one that can be."""

from __future__ import annotations

from itertools import combinations

from remac_env.rules.facts import ASIDE, Rules
from remac_env.state import FrozenMap, WorldState
from remac_env.testing.play import expect


def check_world(scene: Rules, world: WorldState, *, where: str = "check_world") -> None:
    """Look whether a world is whole.

    Every robot, object and fixture of the scene is there, and nothing else; each object is in one place that exists, no
    two in one slot, vessels hold no more than they can; hands and held objects agree; no two robots use conflicting
    stations; doors and switches are ones that the fixtures have; equal worlds hash equal.

    Args:
        where: what messages begin with.

    Raises:
        ContractError: naming the thing at fault.
    """
    for part in ("robots", "objects", "fixtures"):
        there, wanted = set(getattr(world, part)), set(getattr(scene, part))
        expect(there == wanted, f"{where}: {part} of the world and of the scene differ: {sorted(there ^ wanted)}")
    _check_places(scene, world, where)
    _check_hands(world, where)
    _check_stations(scene, world, where)
    _check_fixtures(scene, world, where)
    copy = WorldState(*(FrozenMap(dict(reversed(list(m.items())))) for m in _parts(world)))
    expect(copy == world and hash(copy) == hash(world), f"{where}: an equal world is not equal or hashes differently")


def _parts(world: WorldState) -> tuple[FrozenMap, FrozenMap, FrozenMap]:
    return world.robots, world.objects, world.fixtures


def _check_places(scene: Rules, world: WorldState, where: str) -> None:
    filled: dict[tuple[str, str], list[str]] = {}
    known = {"slot": set(scene.slots), "vessel": set(scene.objects), "held": set(world.robots), "floor": {""}}
    for name, item in world.objects.items():
        relation, target = str(item.place.relation), item.place.where
        expect(relation in known, f"{where}: the {name} is in relation {relation!r}; valid: {', '.join(known)}")
        expect(target in known[relation], f"{where}: the {name} is in an unknown {relation} {target!r}")
        filled.setdefault((relation, target), []).append(name)
        expect(isinstance(item.marks, frozenset), f"{where}: marks of the {name} are not a frozenset")
        _check_chain(world, name, where)
    for (kind, target), names in filled.items():
        room = {"slot": 1, "held": 1, "floor": len(names)}
        most = scene.objects[target].holds if kind == "vessel" else room[kind]
        expect(len(names) <= most, f"{where}: {', '.join(names)} in one {kind} {target!r} that holds {most}")


def _check_chain(world: WorldState, name: str, where: str) -> None:
    place, seen = world.objects[name].place, {name}
    while place.relation == "vessel":
        expect(place.where not in seen, f"{where}: the {name} lies in a circle of vessels")
        seen.add(place.where)
        place = world.objects[place.where].place


def _check_hands(world: WorldState, where: str) -> None:
    for robot, state in world.robots.items():
        held = [n for n, item in world.objects.items() if item.place.relation == "held" and item.place.where == robot]
        told = [] if state.holding is None else [state.holding]
        expect(held == told, f"{where}: {robot} holds {told}, but in its hand are {held}")


def _check_stations(scene: Rules, world: WorldState, where: str) -> None:
    for robot, state in world.robots.items():
        known = state.station == ASIDE or state.station in scene.stations
        expect(known, f"{where}: {robot} is at an unknown station {state.station!r}")
    for (first, one), (second, other) in combinations(world.robots.items(), 2):
        clash = scene.conflicting(one.station, other.station)
        expect(not clash, f"{where}: {first} at {one.station} and {second} at {other.station} are in conflict")


def _check_fixtures(scene: Rules, world: WorldState, where: str) -> None:
    for name, state in world.fixtures.items():
        facts = scene.fixtures[name]
        doors = ("closed", "ajar", "open") if facts.door else (None,)
        expect(state.door in doors, f"{where}: the {name} door is {state.door!r}; valid: {doors}")
        strange = state.on - set(facts.switches)
        expect(not strange, f"{where}: the {name} has no switches {sorted(strange)}")
        runs_open = facts.shut_to_run and state.on and state.door != "closed"
        expect(not runs_open, f"{where}: the {name} runs with its door {state.door}")
