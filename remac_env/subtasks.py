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

from remac_env.conditions import Condition, condition, destination, landing, switch_for
from remac_env.marks import SEASONED
from remac_env.state import ASIDE, FLOOR, Place, Scene, WorldState

Mark = Literal["refuse", "attempt", "advise"]
Reason = Literal[
    "not_at_station",
    "station_occupied",
    "hands_full",
    "hands_empty",
    "loaded",
    "door_closed",
    "unreachable",
    "blocked",
    "slipped",
    "dropped",
    "already_done",
    "not_found",
    "timeout",
    "invalid",
]
REASONS: tuple[str, ...] = Reason.__args__  # type: ignore[attr-defined]
"""The closed list of failure reasons."""

TargetKind = Literal["none", "any", "object", "surface", "door", "switch", "food"]


@dataclass(frozen=True, slots=True)
class Outcome:
    """How one robot's subtask of a round ended. `reason` is None on success; `seconds` is simulated time."""

    status: Literal["success", "failure"]
    reason: Reason | None = None
    detail: str = ""
    seconds: float = 0.0

    @property
    def success(self) -> bool:
        """True when the subtask did what it says."""
        return self.status == "success"


def failure(reason: Reason, detail: str = "", *, seconds: float = 0.0) -> Outcome:
    """A failed outcome."""
    return Outcome("failure", reason, detail, seconds)


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
    effect: Callable[[Scene, WorldState, str, str], WorldState]
    achieves: Callable[[str, str, str | None], tuple[Condition, ...]]


@dataclass(frozen=True, slots=True)
class Subtask:
    """A skill with its target ("" where it has none)."""

    skill: str
    target: str = ""

    @property
    def text(self) -> str:
        """The command, as "pick up vegetable"."""
        return SKILLS[self.skill].form.format(self.target)

    def requirements(self, robot: str) -> tuple[Requirement, ...]:
        """What must hold before `robot` runs it, in the order in which it is tested."""
        return _requirements(self.skill, self.target, robot)

    def achieves(self, robot: str, held: str | None) -> tuple[Condition, ...]:
        """What holds after success; `held` is what the robot held before."""
        return SKILLS[self.skill].achieves(robot, self.target, held)

    def effect(self, scene: Scene, world: WorldState, robot: str) -> WorldState:
        """The world after success."""
        return SKILLS[self.skill].effect(scene, world, robot, self.target)


@lru_cache(maxsize=4096)
def _requirements(skill: str, target: str, robot: str) -> tuple[Requirement, ...]:
    return SKILLS[skill].requires(robot, target)


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


def _stay(scene: Scene, world: WorldState, robot: str, target: str) -> WorldState:
    return world


def _step_aside(scene: Scene, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_robot(robot, station=ASIDE)


def _go(scene: Scene, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_robot(robot, station=destination(scene, world, robot, target))


def _take(scene: Scene, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_object(target, place=Place("held", robot)).with_robot(robot, holding=target)


def _put(scene: Scene, world: WorldState, robot: str, target: str) -> WorldState:
    held, place = world.robots[robot].holding, landing(scene, world, robot, target)
    return world.with_object(str(held), place=place).with_robot(robot, holding=None)


def _set_on(scene: Scene, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_fixture(target, on=world.fixtures[target].on | {switch_for(scene, world, target)})


def _set_off(scene: Scene, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_fixture(target, on=frozenset())


def _open(scene: Scene, world: WorldState, robot: str, target: str) -> WorldState:
    opened = world.with_fixture(target, door="open")
    # A fixture that runs only when shut stops when its door is opened.
    return opened.with_fixture(target, on=frozenset()) if scene.fixtures[target].shut_to_run else opened


def _close(scene: Scene, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_fixture(target, door="closed")


def _season(scene: Scene, world: WorldState, robot: str, target: str) -> WorldState:
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

WAIT = Subtask("wait")
DONE = Subtask("done")
