"""What a round is, for both backends: claims are settled before anything moves, the same for every robot.

A robot whose subtask is refused stays where it is. Two robots that claim one station (or two that conflict), or one
object, both get `station_occupied`; arriving where another stands is allowed if that one leaves in the same round.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache

from remac_env.conditions import PREDICATES, Predicate, destination
from remac_env.marks import washed
from remac_env.state import ASIDE, Scene, WorldState
from remac_env.subtasks import Mark, Outcome, Reason, Requirement, Subtask, drop, failure

NAVIGATION = ("navigate to", "navigate aside")

SUCCESS = Outcome("success")
"""What the table says of a subtask that does what it says; it took no time yet."""

_SETTLED_BY_ALL = ("station_free",)
"""Requirements that hang on where the other robots go in the same round."""


def first_false(
    scene: Scene, world: WorldState, robot: str, subtask: Subtask, mark: Mark, *, skip: tuple[str, ...] = ()
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
    scene: Scene, world: WorldState, subtasks: Mapping[str, Subtask]
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


def _clashes(scene: Scene, stations: Mapping[str, str], goals: Mapping[str, str | None]) -> list[str]:
    """Robots whose goal another robot keeps or also claims, in the order of the goals."""
    ends = {**stations, **goals}
    return [
        robot
        for robot, goal in goals.items()
        if goal is not None
        and any(end is not None and other != robot and scene.conflicting(goal, end) for other, end in ends.items())
    ]


def attempt(
    scene: Scene, world: WorldState, robot: str, subtask: Subtask, *, station: str
) -> tuple[Outcome, WorldState]:
    """What the table says comes of an accepted subtask, seen from the world before the round."""
    false = first_false(scene, world, robot, subtask, "attempt")
    if false is not None:
        after = drop(world, robot) if false.drops else world
        return false.outcome, after
    if subtask.skill in NAVIGATION:
        stays = world.robots[robot].station == station
        return SUCCESS, world if stays else world.with_robot(robot, station=station)
    return SUCCESS, subtask.effect(scene, world, robot)


def merge(world: WorldState, results: Mapping[str, WorldState]) -> WorldState | None:
    """The world after all robots' changes together, or None when two of them change one thing differently."""
    others = [after for after in results.values() if after is not world]
    if len(others) < 2:
        return others[0] if others else world
    merged = world
    for part in ("robots", "objects", "fixtures"):
        before = getattr(world, part)
        changed: dict[str, object] = {}
        for after in others:
            if getattr(after, part) is before:
                continue
            for name, value in getattr(after, part).items():
                if value is before[name] or value == before[name]:
                    continue
                if name in changed and changed[name] != value:
                    return None
                changed[name] = value
        for name, value in changed.items():
            merged = _set(merged, part, name, value)
    return merged


def _set(world: WorldState, part: str, name: str, value: object) -> WorldState:
    data = {field: getattr(world, field) for field in ("robots", "objects", "fixtures")}
    return WorldState(**(data | {part: data[part].with_(name, value)}))


def transition(
    scene: Scene, world: WorldState, subtasks: Mapping[str, Subtask]
) -> tuple[WorldState, dict[str, Outcome]]:
    """One whole round by the table alone: the symbolic backend's step, and what the oracle searches over."""
    refused, stations = settle_claims(scene, world, subtasks)
    outcomes, results = dict(refused), {}
    for robot, subtask in subtasks.items():
        if robot not in refused:
            outcomes[robot], results[robot] = attempt(
                scene, world, robot, subtask, station=stations[robot]
            )
    merged = merge(world, results)
    if merged is None:
        reason: Reason = "blocked"
        clash = {r: failure(reason, "the robots' effects contradict each other") for r in results}
        return world, outcomes | clash
    return washed(scene, merged), outcomes
