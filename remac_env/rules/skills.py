"""The skill table: what robots can be told to do, what each skill needs, and what it changes.

Both backends, the vocabulary, the masks, the help text, the condition sentences and the parser derive from this one
table. A skill's requirements carry one of three marks: `refuse` - the controller declines and nothing changes;
`attempt` - physics decides, and the table says what comes of it; `advise` - nothing stops it, but it is wrong.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from remac_env.rules.conditions import Condition, condition
from remac_env.rules.facts import ASIDE, Rules
from remac_env.rules.marks import SEASONED
from remac_env.rules.outcomes import Outcome, Reason, failure
from remac_env.rules.places import destination, landing, switch_for
from remac_env.state import FLOOR, Place, WorldState

Mark = Literal["refuse", "attempt", "advise"]
TargetKind = Literal["none", "any", "object", "surface", "door", "switch", "food"]


@dataclass(frozen=True, slots=True)
class Requirement:
    """A pre-condition with its mark and the reason given when it is false. `drops`: what is held then falls."""

    mark: Mark
    condition: Condition
    reason: Reason
    drops: bool = False

    @property
    def outcome(self) -> Outcome:
        """How a subtask ends for which this is the first requirement that is false."""
        return _untrue(self.reason, self.condition.predicate, self.condition.args)


@lru_cache(maxsize=4096)
def _untrue(reason: Reason, predicate: str, args: tuple[str, ...]) -> Outcome:
    return failure(reason, f"not true: {Condition(predicate, args).sentence}")


@dataclass(frozen=True, slots=True)
class Skill:
    """One row of the table. `form` is its text with `{}` for the target; `seconds` is a nominal duration."""

    name: str
    form: str
    target: TargetKind
    seconds: float
    requires: Callable[[str, str], tuple[Requirement, ...]]
    effect: Callable[[Rules, WorldState, str, str], WorldState]
    achieves: Callable[[str, str, str | None], tuple[Condition, ...]]


# -- requirements ---------------------------------------------------------------------------------------------------


def _nothing(robot: str, target: str) -> tuple[Requirement, ...]:
    return ()


def _refuse(reason: Reason, predicate: str, *args: str) -> Requirement:
    return Requirement("refuse", condition(predicate, *args), reason)


def _attempt(reason: Reason, predicate: str, *args: str, drops: bool = False) -> Requirement:
    return Requirement("attempt", condition(predicate, *args), reason, drops)


def _for_navigate(robot: str, target: str) -> tuple[Requirement, ...]:
    return (
        _refuse("unreachable", "placed", target),
        _refuse("station_occupied", "station_free", robot, target),
    )


def _for_pick_up(robot: str, target: str) -> tuple[Requirement, ...]:
    return (
        _refuse("hands_full", "hand_empty", robot),
        _refuse("unreachable", "placed", target),
        _refuse("not_at_station", "at", robot, target),
        _refuse("loaded", "unloaded", target),
        _attempt("door_closed", "accessible", target),
        _attempt("blocked", "graspable", target),
    )


def _for_place(robot: str, target: str) -> tuple[Requirement, ...]:
    return (
        _refuse("hands_empty", "hand_full", robot),
        _refuse("unreachable", "placed", target),
        _refuse("not_at_station", "at", robot, target),
        _attempt("door_closed", "accessible", target),
        _attempt("blocked", "room", robot, target),
        Requirement("advise", condition("no_vessel_needed", robot, target), "invalid"),
    )


def _for_open(robot: str, target: str) -> tuple[Requirement, ...]:
    return (
        _refuse("not_at_station", "at", robot, target),
        _refuse("already_done", "door_not_open", target),
        _attempt("dropped", "hand_empty", robot, drops=True),
    )


def _for_close(robot: str, target: str) -> tuple[Requirement, ...]:
    return (
        _refuse("not_at_station", "at", robot, target),
        _refuse("already_done", "door_not_closed", target),
        _attempt("dropped", "hand_empty", robot, drops=True),
    )


def _for_turn_on(robot: str, target: str) -> tuple[Requirement, ...]:
    return (
        _refuse("not_at_station", "at", robot, target),
        _refuse("already_done", "switched_off", target),
        _attempt("dropped", "hand_empty", robot, drops=True),
        _attempt("blocked", "may_run", target),
    )


def _for_turn_off(robot: str, target: str) -> tuple[Requirement, ...]:
    return (
        _refuse("not_at_station", "at", robot, target),
        _refuse("already_done", "some_on", target),
        _attempt("dropped", "hand_empty", robot, drops=True),
    )


def _for_season(robot: str, target: str) -> tuple[Requirement, ...]:
    return (
        _refuse("hands_empty", "holds_shaker", robot),
        _refuse("unreachable", "placed", target),
        _refuse("not_at_station", "at", robot, target),
        _attempt("door_closed", "accessible", target),
    )


# -- effects --------------------------------------------------------------------------------------------------------


def _stay(scene: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return world


def _step_aside(scene: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_robot(robot, station=ASIDE)


def _go(scene: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_robot(robot, station=destination(scene, world, robot, target))


def _take(scene: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_object(target, place=Place("held", robot)).with_robot(robot, holding=target)


def _put(scene: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    held, place = world.robots[robot].holding, landing(scene, world, robot, target)
    return world.with_object(str(held), place=place).with_robot(robot, holding=None)


def _set_on(scene: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_fixture(target, on=world.fixtures[target].on | {switch_for(scene, world, target)})


def _set_off(scene: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_fixture(target, on=frozenset())


def _open(scene: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    opened = world.with_fixture(target, door="open")
    # A fixture that runs only when shut stops when its door is opened.
    return opened.with_fixture(target, on=frozenset()) if scene.fixtures[target].shut_to_run else opened


def _close(scene: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_fixture(target, door="closed")


def _season(scene: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_object(target, marks=world.objects[target].marks | {SEASONED})


def drop(world: WorldState, robot: str) -> WorldState:
    """The world after the robot opened its gripper over the floor."""
    held = world.robots[robot].holding
    if held is None:
        return world
    return world.with_object(held, place=FLOOR).with_robot(robot, holding=None)


# -- post-conditions ------------------------------------------------------------------------------------------------


def _after_place(robot: str, target: str, held: str | None) -> tuple[Condition, ...]:
    empty = condition("hand_empty", robot)
    return (empty,) if held is None else (condition("inside", held, target), empty)


def _after(predicate: str, *, with_robot: bool = False) -> Callable[[str, str, str | None], tuple[Condition, ...]]:
    def conditions(robot: str, target: str, held: str | None) -> tuple[Condition, ...]:
        return (condition(predicate, robot, target) if with_robot else condition(predicate, target),)

    return conditions


_TABLE: tuple[Skill, ...] = (
    Skill("wait", "wait", "none", 0.0, _nothing, _stay, lambda r, t, h: ()),
    Skill("done", "done", "none", 0.0, _nothing, _stay, lambda r, t, h: ()),
    Skill("navigate aside", "navigate aside", "none", 6.0, _nothing, _step_aside,
          lambda r, t, h: (condition("aside", r),)),
    Skill("navigate to", "navigate to {}", "any", 6.0, _for_navigate, _go, _after("at", with_robot=True)),
    Skill("pick up", "pick up {}", "object", 8.0, _for_pick_up, _take, _after("holding", with_robot=True)),
    Skill("place to", "place to {}", "surface", 9.0, _for_place, _put, _after_place),
    Skill("open door", "open {} door", "door", 9.0, _for_open, _open, _after("door_open")),
    Skill("close door", "close {} door", "door", 9.0, _for_close, _close, _after("door_closed")),
    Skill("turn on", "turn on {}", "switch", 7.0, _for_turn_on, _set_on, _after("switched_on")),
    Skill("turn off", "turn off {}", "switch", 7.0, _for_turn_off, _set_off, _after("all_off")),
    Skill("season", "season {}", "food", 8.0, _for_season, _season,
          lambda r, t, h: (condition("marked", t, SEASONED),)),
)  # fmt: skip

SKILLS: dict[str, Skill] = {skill.name: skill for skill in _TABLE}
"""The skill table by name. Nominal seconds are the means seen in physics (benchmarks/skills.py)."""
