"""Kitchens with everything anywhere, as no task begins: a checker is to see what is so, not what usually is.

Only the skill table plays them: nobody would bring things there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from remac_env.kitchen.fixtures.door import OPEN_TO
from remac_env.rules.facts import ASIDE, Rules, SlotFacts
from remac_env.rules.marks import SEASONED
from remac_env.rules.places import has_room
from remac_env.start import Offset, Start
from remac_env.state import Place, WorldState

_ASIDE, _HOLDING = 0.05, 0.5  # of the robots stand aside; of the others hold something
_USED = 0.4  # of the places where a robot stands have something in them: half is asked about what is there, or is not
_IN_VESSELS = 0.4  # of the things that fit into a vessel somewhere lie in one
_SEASONED = 0.35  # of them have been seasoned
_OPEN, _RUNNING = 0.5, 0.5  # of the doors, and of the fixtures with a switch that may run


def shuffled(start: Start, chance: np.random.Generator) -> Start:
    """A start with robots and objects anywhere where they fit, and with doors, switches and marks drawn by lot."""
    scene, world = start.scene, start.world
    for name, state in world.fixtures.items():
        facts, door = scene.fixtures[name], state.door
        if door is not None:
            door = "open" if chance.random() < _OPEN else "closed"
        runs = bool(facts.switches) and chance.random() < _RUNNING and not (facts.shut_to_run and door == "open")
        on = frozenset({str(chance.choice(facts.switches))}) if runs else frozenset[str]()
        world = world.with_fixture(name, door=door, on=on)
    world = _with_objects(scene, _with_robots(scene, world, chance), chance)
    angles = {name: OPEN_TO if state.door == "open" else 0.0 for name, state in world.fixtures.items() if state.door}
    turns = {name: Offset(yaw=float(chance.uniform(0.0, 2 * np.pi))) for name in world.objects}
    return replace(start, world=world, doors=angles, offsets=turns)


def _with_robots(scene: Rules, world: WorldState, chance: np.random.Generator) -> WorldState:
    """Each robot before some fixture, in nobody's way, with an empty hand."""
    standing: list[str] = []
    for robot in scene.robots:
        fixture = str(chance.choice([name for name in scene.fixtures if scene.stations_of(name)]))
        station = str(chance.choice(scene.stations_of(fixture)))
        if chance.random() < _ASIDE or any(scene.conflicting(station, other) for other in standing):
            station = ASIDE
        standing.append(station)
        world = world.with_robot(robot, station=station, holding=None)
    return world


def _with_objects(scene: Rules, world: WorldState, chance: np.random.Generator) -> WorldState:
    """Some in hands, some where robots stand, the others anywhere else; what others lie in comes first."""
    for name in world.objects:
        world = world.with_object(name, place=Place("floor"))
    left = [str(name) for name in chance.permutation(sorted(world.objects))]
    for robot, state in world.robots.items():
        if state.station != ASIDE and left and chance.random() < _HOLDING:
            name = left.pop()
            world = world.with_object(name, place=Place("held", robot)).with_robot(robot, holding=name)
    stations = {state.station for state in world.robots.values()}
    near = [slot for slot in scene.slots.values() if stations & set(slot.stations)]
    left.sort(key=lambda name: not scene.objects[name].holds)
    for slot in (slot for slot in near if chance.random() < _USED):
        fitting = [name for name in left if scene.fixtures[slot.fixture].kind not in scene.objects[name].too_big_for]
        if fitting:
            name = fitting[0] if chance.random() < 0.5 else str(chance.choice(fitting))
            left.remove(name)
            world = _put(scene, world, name, [slot], chance)
    away = [slot for slot in scene.slots.values() if slot not in near]
    for name in left:
        world = _put(scene, world, name, away or near, chance)
    return world


def _put(
    scene: Rules, world: WorldState, name: str, slots: Sequence[SlotFacts], chance: np.random.Generator
) -> WorldState:
    """The world with an object in a vessel or in a free one of these places that takes it."""
    facts = scene.objects[name]
    there = [other for other in world.objects if other != name and world.objects[other].place.relation == "slot"]
    vessels = [other for other in there if facts.small and not facts.holds and has_room(scene, world, other)]
    taken = {item.place.where for item in world.objects.values()}
    free: dict[str, list[str]] = {}
    for slot in slots:
        if slot.name not in taken and scene.fixtures[slot.fixture].kind not in facts.too_big_for:
            free.setdefault(slot.fixture, []).append(slot.name)
    place = Place("slot", str(chance.choice(free[str(chance.choice(sorted(free)))]))) if free else None
    if vessels and (place is None or chance.random() < _IN_VESSELS):
        place = Place("vessel", str(chance.choice(vessels)))
    marks = frozenset({SEASONED}) if not facts.holds and not facts.seasons and chance.random() < _SEASONED else None
    return world.with_object(name, place=place, marks=marks)
