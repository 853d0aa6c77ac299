"""Which starts are one problem: those that differ only in looks, in names, and in where on a worktop objects stand."""

from __future__ import annotations

import hashlib
import json

from remac_env.oracle.commands import relevant_nouns
from remac_env.rules.facts import ASIDE, Rules
from remac_env.state import Place, WorldState, occupant
from remac_env.tasks.goals import Goal


def problem_id(scene: Rules, world: WorldState, goal: Goal) -> str:
    """Twelve hexadecimal digits that two starts share when they are equal up to renaming.

    Looked at are the goal and whatever can matter for it (`relevant_nouns`): the fixture on or in which each object
    stands, whether its slot is switched on, what it is to the rules there, its marks, doors, switches, and what robots
    hold. Not looked at are names, kinds of objects, styles, floor plans, and everything else in the room.
    """
    objects, fixtures = relevant_nouns(scene, world, goal)
    kinds = {scene.fixtures[name].kind for name in fixtures}
    number = {name: f"object {at}" for at, name in enumerate(objects)}
    held = sorted(number.get(state.holding or "", str(state.holding is not None)) for state in world.robots.values())
    facts = {
        "goal": [[type(atom).__name__, *_renamed(atom, number)] for atom in goal.atoms()],
        "objects": [_object(scene, world, name, number, kinds) for name in objects],
        "fixtures": [_fixture(scene, world, name) for name in fixtures],
        "robots": [held, sorted(state.station != ASIDE for state in world.robots.values())],
    }
    if scene.quirks or scene.orders or scene.hides:
        quirks = [[quirk.kind, *(number.get(n, n) for n in (quirk.about, quirk.other))] for quirk in scene.quirks]
        facts["kitchen"] = [sorted(quirks), scene.orders, scene.hides]
    return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()[:12]


def _renamed(atom: Goal, number: dict[str, str]) -> list[str]:
    text = atom.text
    for name in sorted(number, key=len, reverse=True):
        text = text.replace(name, number[name])
    return [text]


def _object(
    scene: Rules, world: WorldState, name: str, number: dict[str, str], kinds: set[str]
) -> list[object]:
    facts, state = scene.objects[name], world.objects[name]
    rules = [facts.needs_vessel_in, facts.vessel_in, facts.too_big_for, facts.too_deep_in]
    what = [facts.holds, facts.seasons, facts.small, facts.washable, *(sorted(rule & kinds) for rule in rules)]
    return [_place(scene, world, state.place, number), sorted(state.marks), what]


def _place(scene: Rules, world: WorldState, place: Place, number: dict[str, str]) -> list[object]:
    if place.relation != "slot":
        return [place.relation, number.get(place.where, "")]
    fixture = scene.slots[place.where].fixture
    return ["slot", fixture, place.where in world.fixtures[fixture].on]


def _fixture(scene: Rules, world: WorldState, name: str) -> list[object]:
    facts, state = scene.fixtures[name], world.fixtures[name]
    full = bool(facts.slots) and all(occupant(world, slot) is not None for slot in facts.slots)
    return [facts.kind, state.door, len(state.on), full]
