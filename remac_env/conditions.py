"""Sentences about a kitchen that are true or false, and how each is decided from Scene and WorldState.

A condition is data (a predicate and its arguments), so that the same value is a line of text for a language model, a
question for a checker and a test on the truth.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from remac_env.public import PublicScene
from remac_env.state import ASIDE, Place, Scene, WorldState, base_place, contents, inside, occupant, supports

Predicate = Callable[..., bool]
Kind = Literal["seen", "felt", "known", "ran"]


@dataclass(frozen=True, slots=True)
class Condition:
    """A predicate (a key of PREDICATES) with its arguments, all names of robots, fixtures or objects."""

    predicate: str
    args: tuple[str, ...]

    @property
    def sentence(self) -> str:
        """The condition in plain English, as a checker or a language model reads it."""
        return _sentence(self.predicate, self.args)

    def holds(self, scene: Scene, world: WorldState) -> bool:
        """Whether the condition is true in this world."""
        return PREDICATES[self.predicate](scene, world, *self.args)

    @property
    def kind(self) -> Kind:
        """What its answer comes from: pictures, a robot's own gripper, knowledge of a rule, or what was run."""
        return next((kind for kind, predicates in KINDS.items() if self.predicate in predicates), "seen")

    def felt(self, scene: Scene | PublicScene, holding: Mapping[str, str | None]) -> bool | None:
        """The answer of the gripper, for the kind `felt`; None for other kinds, and where nothing is felt of the robot.

        Args:
            holding: robot -> the thing in its gripper, None for an empty one.
        """
        if self.predicate not in FELT or self.args[0] not in holding:
            return None
        robot, *others = self.args
        return FELT[self.predicate](scene, holding[robot], *others)


@dataclass(frozen=True, slots=True)
class Denial(Condition):
    """That a condition does not hold, for those that no predicate is the opposite of; see `denied`."""

    @property
    def condition(self) -> Condition:
        """What is denied."""
        return Condition(self.args[0], self.args[1:])

    @property
    def sentence(self) -> str:
        """The denial in plain English."""
        return f"it is not so that {self.condition.sentence}"

    @property
    def kind(self) -> Kind:
        """That of what is denied."""
        return self.condition.kind

    def holds(self, scene: Scene, world: WorldState) -> bool:
        """Whether what is denied is false in this world."""
        return not self.condition.holds(scene, world)

    def felt(self, scene: Scene | PublicScene, holding: Mapping[str, str | None]) -> bool | None:
        """The gripper's answer to what is denied, turned round."""
        answer = self.condition.felt(scene, holding)
        return None if answer is None else not answer


def denied(condition: Condition) -> Denial:
    """The denial of a condition: a predicate "not" with the condition's predicate and arguments."""
    return Denial("not", (condition.predicate, *condition.args))


@lru_cache(maxsize=4096)
def _sentence(predicate: str, args: tuple[str, ...]) -> str:
    return SENTENCES[predicate].format(*args)


def condition(predicate: str, *args: str) -> Condition:
    """Shorthand for Condition(predicate, args)."""
    return Condition(predicate, args)


def stations_of(scene: Scene, world: WorldState, target: str) -> tuple[str, ...]:
    """The stations from which `target` can be used; empty for an object that is held or on the floor."""
    if target in scene.fixtures:
        return scene.stations_of(target)
    place = base_place(world, target)
    return (scene.slots[place.where].station,) if place.relation == "slot" else ()


def destination(scene: Scene, world: WorldState, robot: str, target: str) -> str | None:
    """The station at which `navigate to target` ends for this robot, or None when there is none.

    Of several stations (a long counter) the robot keeps its own, else takes the first with a free slot that no other
    robot uses, else the first with a free slot, else the first.
    """
    options = stations_of(scene, world, target)
    if len(options) < 2:
        return options[0] if options else None
    here = world.robots[robot].station
    full = {item.place.where for item in world.objects.values() if item.place.relation == "slot"}
    roomy = {scene.slots[name].station for name in scene.fixtures[target].slots if name not in full}
    if here in roomy:
        return here
    free = [name for name in options if name in roomy]
    taken = [state.station for other, state in world.robots.items() if other != robot]
    quiet = (name for name in free if not any(scene.conflicting(name, other) for other in taken))
    return next(quiet, (free or options)[0])


def landing(scene: Scene, world: WorldState, robot: str, target: str) -> Place | None:
    """Where `place to target` puts what the robot holds, or None when there is no room.

    On a fixture: a free slot at the robot's station, a lit burner before others; else a vessel that belongs there and
    has room, as the plate in a cupboard. On a vessel: the vessel, unless it is full or too deep for the hand where it
    stands. Neither where the thing is too big for the fixture around.
    """
    held, kind = world.robots[robot].holding, _kind_around(scene, world, target)
    if held is not None and kind in scene.objects[held].too_big_for:
        return None
    if target in scene.objects:
        small = held is None or scene.objects[held].small
        return Place("vessel", target) if small and has_room(scene, world, target) and held != target else None
    here = world.robots[robot].station
    slots = [name for name in scene.fixtures[target].slots if scene.slots[name].station == here]
    free = [name for name in slots if occupant(world, name) is None]
    lit = [name for name in free if name in world.fixtures[target].on]
    if free:
        return Place("slot", (lit + free)[0])
    vessels = [name for slot in slots if (name := occupant(world, slot)) and kind in scene.objects[name].vessel_in]
    places = (landing(scene, world, robot, name) for name in vessels)
    return next((place for place in places if place is not None), None)


def has_room(scene: Scene, world: WorldState, vessel: str) -> bool:
    """Whether a vessel takes one more thing: it is not full, and a hand reaches into it where it stands."""
    facts = scene.objects[vessel]
    return len(contents(world, vessel)) < facts.holds and _kind_around(scene, world, vessel) not in facts.too_deep_in


def switch_for(scene: Scene, world: WorldState, fixture: str) -> str:
    """The switch that `turn on` acts on: with a switch per slot, that under a vessel, best one that belongs there."""
    facts = scene.fixtures[fixture]
    if not facts.switch_per_slot:
        return facts.switches[0]
    used = {n: t for n in facts.slots if (o := occupant(world, n)) is not None and (t := scene.objects[o]).holds}
    return min(used, key=lambda name: facts.kind not in used[name].vessel_in, default=facts.switches[0])


# -- predicates -----------------------------------------------------------------------------------------------------


def _at(scene: Scene, world: WorldState, robot: str, target: str) -> bool:
    return world.robots[robot].station in stations_of(scene, world, target)


def _station_free(scene: Scene, world: WorldState, robot: str, target: str) -> bool:
    goal = destination(scene, world, robot, target)
    others = (state.station for name, state in world.robots.items() if name != robot)
    return goal is not None and not any(scene.conflicting(goal, other) for other in others)


def _accessible(scene: Scene, world: WorldState, target: str) -> bool:
    around = [target] if target in scene.fixtures else supports(scene, world, target)
    doors = (world.fixtures[name].door for name in around if name in scene.fixtures)
    return all(door in (None, "open") for door in doors)


def _placed(scene: Scene, world: WorldState, target: str) -> bool:
    return target in scene.fixtures or base_place(world, target).relation == "slot"


def _graspable(scene: Scene, world: WorldState, target: str) -> bool:
    kind, place = _kind_around(scene, world, target), world.objects[target].place
    deep = place.relation == "vessel" and kind in scene.objects[place.where].too_deep_in
    return not deep and kind not in scene.objects[target].too_big_for


def _kind_around(scene: Scene, world: WorldState, target: str) -> str:
    """The kind of a fixture, or of that in or on which a thing stands; "" for what is held or on the floor."""
    if target in scene.fixtures:
        return scene.fixtures[target].kind
    place = base_place(world, target)
    return scene.fixtures[scene.slots[place.where].fixture].kind if place.relation == "slot" else ""


def _room(scene: Scene, world: WorldState, robot: str, target: str) -> bool:
    return landing(scene, world, robot, target) is not None


def _no_vessel_needed(scene: Scene, world: WorldState, robot: str, target: str) -> bool:
    held = world.robots[robot].holding
    if held is None or target not in scene.fixtures:
        return True
    place = landing(scene, world, robot, target)
    if place is not None and place.relation == "vessel":
        return True
    return scene.fixtures[target].kind not in scene.objects[held].needs_vessel_in


def _switched_on(scene: Scene, world: WorldState, fixture: str) -> bool:
    return switch_for(scene, world, fixture) in world.fixtures[fixture].on


def _may_run(scene: Scene, world: WorldState, fixture: str) -> bool:
    return not scene.fixtures[fixture].shut_to_run or world.fixtures[fixture].door == "closed"


def _all_off(scene: Scene, world: WorldState, fixture: str) -> bool:
    return not world.fixtures[fixture].on


def _within(scene: Scene, world: WorldState, name: str, container: str) -> bool:
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
