"""Who may do what in a round: claims are settled before anything moves, the same for every robot.

A robot whose subtask is refused stays where it is. Two robots that claim one station (or two that conflict), or one
object, both get `station_occupied`; arriving where another stands is allowed if that one leaves in the same round.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache

from remac_env.rules.facts import ASIDE, Rules
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.places import destination
from remac_env.rules.predicates import PREDICATES, Predicate
from remac_env.rules.skills import Mark, Requirement
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState

NAVIGATION = ("navigate to", "navigate aside")

_SETTLED_BY_ALL = ("station_free",)
"""Requirements that hang on where the other robots go in the same round."""


def first_false(
    scene: Rules, world: WorldState, robot: str, subtask: Subtask, mark: Mark, *, skip: tuple[str, ...] = ()
) -> Requirement | None:
    """The first requirement of this mark that is false, or None; predicates in `skip` are not looked at."""
    for requirement, predicate, holds, args in _tests(subtask.skill, subtask.target, robot).get(mark, ()):
        if predicate not in skip and not holds(scene, world, *args):
            return requirement
    return None


_Test = tuple[Requirement, str, Predicate, tuple[str, ...]]


@lru_cache(maxsize=4096)
def _tests(skill: str, target: str, robot: str) -> dict[Mark, list[_Test]]:
    """The requirements of each mark, with predicate, its function and arguments: found once, not in every round."""
    tests: dict[Mark, list[_Test]] = {}
    for requirement in Subtask(skill, target).requirements(robot):
        condition = requirement.condition
        test = (requirement, condition.predicate, PREDICATES[condition.predicate], condition.args)
        tests.setdefault(requirement.mark, []).append(test)
    return tests


def settle_claims(
    scene: Rules, world: WorldState, subtasks: Mapping[str, Subtask]
) -> tuple[dict[str, Outcome], dict[str, str]]:
    """Refusals of this round, and the station at which every robot will end it.

    Returns:
        (refused, stations): an outcome for each robot whose controller declines, and for every robot the station
        that it keeps or goes to.
    """
    refused: dict[str, Outcome] = {}
    picks: list[tuple[str, str]] = []
    goals: dict[str, str | None] = {}
    for robot, subtask in subtasks.items():
        false = first_false(scene, world, robot, subtask, "refuse", skip=_SETTLED_BY_ALL)
        if false is not None:
            refused[robot] = false.outcome
        elif subtask.skill == "pick up":
            picks.append((robot, subtask.target))
        elif subtask.skill in NAVIGATION:
            aside = subtask.skill == "navigate aside"
            goals[robot] = ASIDE if aside else destination(scene, world, robot, subtask.target)
    if len(picks) > 1:
        _settle_objects(picks, refused)
    stations = {robot: state.station for robot, state in world.robots.items()}
    while goals and (clash := _clashes(scene, stations, goals)):
        for robot in clash:
            refused[robot] = failure("station_occupied", f"{goals[robot]} is claimed or in use")
        goals = {robot: goal for robot, goal in goals.items() if robot not in clash}
    for robot, goal in goals.items():
        stations[robot] = str(goal)
    return refused, stations


def _settle_objects(picks: Sequence[tuple[str, str]], refused: dict[str, Outcome]) -> None:
    """Two robots that reach for one object both stop."""
    for robot, target in picks:
        if any(other != robot and target == wanted for other, wanted in picks):
            refused[robot] = failure("station_occupied", f"another robot reaches for the {target}")


def _clashes(scene: Rules, stations: Mapping[str, str], goals: Mapping[str, str | None]) -> list[str]:
    """Robots whose goal another robot keeps or also claims, in the order of the goals."""
    ends = {**stations, **goals}
    return [
        robot
        for robot, goal in goals.items()
        if goal is not None
        and any(end is not None and other != robot and scene.conflicting(goal, end) for other, end in ends.items())
    ]
