"""The skills, a row each: what robots can be told to do, what each skill needs, changes and achieves, and what it is.

Both backends, the tokens and masks, the help text, the search and the planners derive from these rows. Docs:
docs/extending.md, "add a skill".
"""

from __future__ import annotations

from remac_env.rules.conditions import Condition, condition
from remac_env.rules.facts import ASIDE, Rules
from remac_env.rules.marks import SEASONED, WASHED
from remac_env.rules.outcomes import Reason
from remac_env.rules.places import destination, landing, switch_for, unshut
from remac_env.rules.skill_row import Achieves, Requirement, Skill
from remac_env.rules.tables import by_name
from remac_env.state import FLOOR, Place, WorldState

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


def _take(rules: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_object(target, place=Place("held", robot)).with_robot(robot, holding=target)


def _put(rules: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    held, place = world.robots[robot].holding, landing(rules, world, robot, target)
    return world.with_object(str(held), place=place).with_robot(robot, holding=None)


def _set_on(rules: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_fixture(target, on=world.fixtures[target].on | {switch_for(rules, world, target)})


def _set_off(rules: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_fixture(target, on=frozenset())


def _open(rules: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return unshut(rules, world, target, "open")


def _close(rules: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_fixture(target, door="closed")


def _season(rules: Rules, world: WorldState, robot: str, target: str) -> WorldState:
    return world.with_object(target, marks=world.objects[target].marks | {SEASONED})


def drop(world: WorldState, robot: str) -> WorldState:
    """The world after the robot opened its gripper over the floor."""
    held = world.robots[robot].holding
    if held is None:
        return world
    return world.with_object(held, place=FLOOR).with_robot(robot, holding=None)


# -- where they lead, and what holds then ---------------------------------------------------------------------------


def _aside(rules: Rules, world: WorldState, robot: str, target: str) -> str | None:
    return ASIDE


def _none(robot: str, target: str, held: str | None) -> tuple[Condition, ...]:
    return ()


def _after_place(robot: str, target: str, held: str | None) -> tuple[Condition, ...]:
    empty = condition("hand_empty", robot)
    return (empty,) if held is None else (condition("inside", held, target), empty)


def _of_target(predicate: str, *others: str) -> Achieves:
    return lambda robot, target, held: (condition(predicate, target, *others),)


def _of_robot(predicate: str) -> Achieves:
    return lambda robot, target, held: (condition(predicate, robot, *((target,) if target else ())),)


# -- the rows -------------------------------------------------------------------------------------------------------

SKILLS: dict[str, Skill] = by_name("skill", "form", (
    Skill(name="wait", form="wait", target="none", seconds=0.0, still=True, relevant="never",
          requires=_nothing, achieves=_none),
    Skill(name="done", form="done", target="none", seconds=0.0, still=True, relevant="never",
          requires=_nothing, achieves=_none),
    Skill(name="navigate aside", form="navigate aside", target="none", seconds=6.0, goes=_aside,
          requires=_nothing, achieves=_of_robot("aside")),
    Skill(name="navigate to", form="navigate to {}", target="thing", seconds=6.0, goes=destination, relevant="vessels",
          requires=_for_navigate, achieves=_of_robot("at")),
    Skill(name="pick up", form="pick up {}", target="object", seconds=8.0, takes=True,
          requires=_for_pick_up, effect=_take, achieves=_of_robot("holding")),
    Skill(name="place to", form="place to {}", target="surface", seconds=9.0, puts=True, relevant="vessels",
          requires=_for_place, effect=_put, achieves=_after_place),
    Skill(name="open door", form="open {} door", target="door", seconds=9.0, lasting=True,
          requires=_for_open, effect=_open, achieves=_of_target("door_open")),
    Skill(name="close door", form="close {} door", target="door", seconds=9.0, lasting=True,
          requires=_for_close, effect=_close, achieves=_of_target("door_closed")),
    Skill(name="turn on", form="turn on {}", target="switch", seconds=7.0, lasting=True,
          requires=_for_turn_on, effect=_set_on, achieves=_of_target("switched_on")),
    Skill(name="turn off", form="turn off {}", target="switch", seconds=7.0, lasting=True,
          requires=_for_turn_off, effect=_set_off, achieves=_of_target("all_off")),
    Skill(name="season", form="season {}", target="food", seconds=8.0, leaves=SEASONED,
          tool=lambda facts: facts.seasons,
          requires=_for_season, effect=_season, achieves=_of_target("marked", SEASONED)),
))  # fmt: skip
"""The skill table by name, in the order of the tokens."""


def marks() -> tuple[str, ...]:
    """What water leaves, and every mark that a skill of the table leaves."""
    return tuple(dict.fromkeys((WASHED, *(skill.leaves for skill in SKILLS.values() if skill.leaves))))
