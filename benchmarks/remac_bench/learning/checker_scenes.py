"""Which questions a robot's pictures answer, and truly how: the labels from which a checker that sees is taught."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass

from remac_agents.vision.questions import question_of, robot_of
from remac_env.rules.conditions import Condition
from remac_env.rules.facts import Rules
from remac_env.rules.marks import SEASONED
from remac_env.rules.places import stations_of
from remac_env.rules.predicates import PREDICATES, ArgumentKind
from remac_env.rules.scene import public_scene
from remac_env.state import WorldState, base_place

OBJECT_PIXELS, FIXTURE_PIXELS = 10, 40
"""Pixels of a picture with 96 on a side from which on an object or a fixture counts as seen."""


@dataclass(frozen=True)
class Look:
    """What one robot's pictures show: `seen`, names of fixtures and objects."""

    rules: Rules
    world: WorldState
    robot: str
    seen: frozenset[str]


@dataclass(frozen=True, slots=True)
class Label:
    """A condition's truth, and whether the pictures tell it."""

    condition: Condition
    truth: bool
    shown: bool


def seen_in(pixels: Mapping[str, int], rules: Rules) -> frozenset[str]:
    """The names that are seen, from how many pixels show each body: "microwave/door" is part of the microwave."""
    found: dict[str, int] = {}
    for body, count in pixels.items():
        name = body.partition("/")[0]
        found[name] = found.get(name, 0) + count
    least = dict.fromkeys(rules.objects, OBJECT_PIXELS) | dict.fromkeys(rules.fixtures, FIXTURE_PIXELS)
    return frozenset(name for name, count in found.items() if count >= least.get(name, count + 1))


def labels(look: Look) -> Iterator[Label]:
    """Every condition that could be put about this robot's pictures, but those that nobody can say anything about."""
    for condition in conditions(look):
        truth = condition.holds(look.rules, look.world)
        shown = _SHOWN.get(condition.predicate, _first_seen)(look, condition, truth)
        if shown is not None:
            yield Label(condition, truth, shown)


def conditions(look: Look) -> Iterator[Condition]:
    """All that a checker with eyes is asked about in this kitchen, about no other robot; of opposites one."""
    for row in (row for row in PREDICATES.values() if row.denies is None):
        for args in itertools.product(*(_names(look, kind) for kind in row.about)):
            condition = Condition(row.name, args)
            repeats = len(set(args)) < len(args)
            trivial = row.fixtures_always and args[0] in look.rules.fixtures
            if question_of(condition) is not None and not repeats and not trivial:
                yield condition


def _names(look: Look, kind: ArgumentKind) -> Collection[str]:
    if kind == "robot":
        return (look.robot,)
    return (SEASONED,) if kind == "mark" else public_scene(look.rules).names(kind)


Shown = Callable[[Look, Condition, bool], bool | None]
"""Whether pictures tell a condition of this truth; None where it is not to be learnt from."""


def _first_seen(look: Look, condition: Condition, truth: bool) -> bool | None:
    """What it is about is in the picture."""
    objects = _objects(condition)
    return not objects or objects[0] in look.seen


def _objects(condition: Condition) -> tuple[str, ...]:
    own = robot_of(condition)
    return tuple(arg for arg in condition.args if arg != own)


def _worked(look: Look, condition: Condition, truth: bool) -> bool | None:
    """How a fixture's door or switch is set shows where robots use it, which its camera looks at from near by."""
    name = condition.args[0]
    return name in look.seen and _here(look, name)


def _free(look: Look, condition: Condition, truth: bool) -> bool | None:
    """Whether something has room shows in a vessel that is seen, and in a fixture before which the robot stands."""
    target = condition.args[1]
    if target in look.rules.objects:
        return target in look.seen
    return target in look.seen and _here(look, target) and _accessible(look, target)


def _where(look: Look, condition: Condition, truth: bool) -> bool | None:
    """Where a robot stands shows in its own picture, but of what stands there unseen."""
    return not truth or condition.args[1] in look.seen


def _within(look: Look, condition: Condition, truth: bool) -> bool | None:
    """The object is seen, or nothing of it where one can look into the container."""
    name, container = condition.args
    if name in look.seen:
        return True
    return not truth and container in look.seen and _accessible(look, container)


def _behind(look: Look, condition: Condition, truth: bool) -> bool | None:
    """A fixture's own door, or an object at the robot's place: who does not see it there takes it to be shut in."""
    name = condition.args[0]
    if name in look.rules.fixtures:
        return _worked(look, condition, truth)
    if name in look.seen:
        return True
    return True if _here(look, name) and base_place(look.world, name).relation == "slot" else None


def _here(look: Look, name: str) -> bool:
    return look.world.robots[look.robot].station in stations_of(look.rules, look.world, name)


def _accessible(look: Look, name: str) -> bool:
    return PREDICATES["accessible"].test(look.rules, look.world, name)


_SHOWN: dict[str, Shown] = {
    "at": _where, "inside": _within, "directly_on": _within, "accessible": _behind, "room": _free,
    **dict.fromkeys(("door_open", "door_closed", "switched_on", "some_on", "may_run"), _worked),
}  # fmt: skip
"""Predicate -> whether it is shown; for all others `_first_seen`."""
