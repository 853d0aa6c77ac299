"""Sentences about a kitchen that are true or false, and how each is decided from Rules and WorldState.

A condition is data (a predicate and its arguments), so that the same value is a line of text for a language model, a
question for a checker and a test on the truth.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Literal

from remac_env.rules.facts import ASIDE, Rules
from remac_env.rules.places import destination, kind_around, landing, stations_of, switch_for
from remac_env.state import Place, WorldState, base_place, contents, inside, supports

Predicate = Callable[..., bool]
Kind = Literal["seen", "felt", "known", "ran"]


def _at(scene: Rules, world: WorldState, robot: str, target: str) -> bool:
    return world.robots[robot].station in stations_of(scene, world, target)


def _station_free(scene: Rules, world: WorldState, robot: str, target: str) -> bool:
    goal = destination(scene, world, robot, target)
    others = (state.station for name, state in world.robots.items() if name != robot)
    return goal is not None and not any(scene.conflicting(goal, other) for other in others)


def _accessible(scene: Rules, world: WorldState, target: str) -> bool:
    around = [target] if target in scene.fixtures else supports(scene, world, target)
    doors = (world.fixtures[name].door for name in around if name in scene.fixtures)
    return all(door in (None, "open") for door in doors)


def _placed(scene: Rules, world: WorldState, target: str) -> bool:
    return target in scene.fixtures or base_place(world, target).relation == "slot"


def _graspable(scene: Rules, world: WorldState, target: str) -> bool:
    kind, place = kind_around(scene, world, target), world.objects[target].place
    deep = place.relation == "vessel" and kind in scene.objects[place.where].too_deep_in
    return not deep and kind not in scene.objects[target].too_big_for


def _room(scene: Rules, world: WorldState, robot: str, target: str) -> bool:
    return landing(scene, world, robot, target) is not None


def _no_vessel_needed(scene: Rules, world: WorldState, robot: str, target: str) -> bool:
    held = world.robots[robot].holding
    if held is None or target not in scene.fixtures:
        return True
    place = landing(scene, world, robot, target)
    if place is not None and place.relation == "vessel":
        return True
    return scene.fixtures[target].kind not in scene.objects[held].needs_vessel_in


def _switched_on(scene: Rules, world: WorldState, fixture: str) -> bool:
    return switch_for(scene, world, fixture) in world.fixtures[fixture].on


def _may_run(scene: Rules, world: WorldState, fixture: str) -> bool:
    return not scene.fixtures[fixture].shut_to_run or world.fixtures[fixture].door == "closed"


def _all_off(scene: Rules, world: WorldState, fixture: str) -> bool:
    return not world.fixtures[fixture].on


def _within(scene: Rules, world: WorldState, name: str, container: str) -> bool:
    return inside(scene, world, name, container)


FELT: dict[str, Predicate] = {
    "hand_empty": lambda scene, held: held is None,
    "holding": lambda scene, held, name: held == name,
    "hand_full": lambda scene, held: held is not None,
    "holds_shaker": lambda scene, held: held is not None and scene.objects[held].seasons,
}
"""Predicates of the kind `felt`, whose first argument is a robot: decided from (scene, what it holds, *other args)."""

KINDS: dict[Kind, Collection[str]] = {"felt": FELT, "known": ("no_vessel_needed", "graspable"), "ran": ("marked",)}
"""Kind -> its predicates; all others are `seen`. No picture shows what is right or possible, nor what was done."""


def _by_feel(test: Predicate) -> Predicate:
    return lambda scene, world, robot, *others: test(scene, world.robots[robot].holding, *others)


PREDICATES: dict[str, Predicate] = {
    **{name: _by_feel(test) for name, test in FELT.items()},
    "at": _at,
    "aside": lambda scene, world, robot: world.robots[robot].station == ASIDE,
    "station_free": _station_free,
    "placed": _placed,
    "accessible": _accessible,
    "unloaded": lambda scene, world, name: not contents(world, name),
    "graspable": _graspable,
    "room": _room,
    "no_vessel_needed": _no_vessel_needed,
    "inside": _within,
    "directly_on": lambda scene, world, name, vessel: world.objects[name].place == Place("vessel", vessel),
    "door_open": lambda scene, world, fixture: world.fixtures[fixture].door == "open",
    "door_not_open": lambda scene, world, fixture: world.fixtures[fixture].door != "open",
    "door_closed": lambda scene, world, fixture: world.fixtures[fixture].door == "closed",
    "door_not_closed": lambda scene, world, fixture: world.fixtures[fixture].door != "closed",
    "switched_on": _switched_on,
    "switched_off": lambda scene, world, fixture: not _switched_on(scene, world, fixture),
    "some_on": lambda scene, world, fixture: not _all_off(scene, world, fixture),
    "all_off": _all_off,
    "may_run": _may_run,
    "marked": lambda scene, world, name, mark: mark in world.objects[name].marks,
}
"""Every predicate, decided from (scene, world, *args)."""

SENTENCES: dict[str, str] = {
    "at": "{0} stands at the {1}",
    "aside": "{0} has stepped aside",
    "station_free": "no other robot stands where {0} needs to be for the {1}",
    "hand_empty": "the gripper of {0} is empty",
    "holding": "the gripper of {0} holds the {1}",
    "hand_full": "the gripper of {0} holds something",
    "holds_shaker": "the gripper of {0} holds a shaker",
    "placed": "the {0} is in its place: neither in a gripper nor on the floor",
    "accessible": "no shut door is in front of the {0}",
    "unloaded": "nothing lies on or in the {0}",
    "graspable": "the gripper has room to take hold of the {0} where it is",
    "room": "the {1} has room for what {0} holds",
    "no_vessel_needed": "what {0} holds may touch the {1} without a vessel",
    "inside": "the {0} is on or in the {1}",
    "directly_on": "the {0} lies on or in the {1} itself",
    "door_open": "the {0} door is open",
    "door_not_open": "the {0} door is not open yet",
    "door_closed": "the {0} door is closed",
    "door_not_closed": "the {0} door is not closed yet",
    "switched_on": "the {0} is switched on",
    "switched_off": "the {0} is not switched on yet",
    "some_on": "the {0} is not switched off yet",
    "all_off": "the {0} is switched off",
    "may_run": "nothing keeps the {0} from running",
    "marked": "the {0} has been {1}",
}
