"""What a round is, for both backends: claims are settled before anything moves, the same for every robot.

A robot whose subtask is refused stays where it is. Two robots that claim one station (or two that conflict), or one
object, both get `station_occupied`; arriving where another stands is allowed if that one leaves in the same round.
"""

from __future__ import annotations

from collections.abc import Mapping

from remac_env.conditions import destination
from remac_env.marks import washed
from remac_env.state import ASIDE, Scene, WorldState
from remac_env.subtasks import Outcome, Reason, Requirement, Subtask, drop, failure

NAVIGATION = ("navigate to", "navigate aside")


def first_false(
    scene: Scene, world: WorldState, robot: str, subtask: Subtask, mark: str, *, skip: tuple[str, ...] = ()
) -> Requirement | None:
    """The first requirement of this mark that is false, or None; predicates in `skip` are not looked at."""
    for requirement in subtask.requirements(robot):
        if requirement.mark != mark or requirement.condition.predicate in skip:
            continue
        if not requirement.condition.holds(scene, world):
            return requirement
    return None


def settle_claims(
    scene: Scene, world: WorldState, subtasks: Mapping[str, Subtask]
) -> tuple[dict[str, Outcome], dict[str, str]]:
    """Refusals of this round, and the station at which every robot will end it.

    Returns:
        (refused, stations): an outcome for each robot whose controller declines, and for every robot the station
        that it keeps or goes to.
    """
    refused: dict[str, Outcome] = {}
    for robot, subtask in subtasks.items():
        false = first_false(scene, world, robot, subtask, "refuse", skip=("station_free",))
        if false is not None:
            refused[robot] = failure(false.reason, f"not true: {false.condition.sentence}")
    if len(subtasks) > 1:
        _settle_objects(subtasks, refused)
    stations = {robot: state.station for robot, state in world.robots.items()}
    goals = {
        robot: ASIDE if subtask.skill == "navigate aside" else destination(scene, world, robot, subtask.target)
        for robot, subtask in subtasks.items()
        if robot not in refused and subtask.skill in NAVIGATION
    }
    while clash := _clashes(scene, stations, goals):
        for robot in clash:
            refused[robot] = failure("station_occupied", f"{goals[robot]} is claimed or in use")
        goals = {robot: goal for robot, goal in goals.items() if robot not in clash}
    return refused, stations | {robot: str(goal) for robot, goal in goals.items()}


def _settle_objects(subtasks: Mapping[str, Subtask], refused: dict[str, Outcome]) -> None:
    """Two robots that reach for one object both stop."""
    picks = [(r, s.target) for r, s in subtasks.items() if s.skill == "pick up" and r not in refused]
    for robot, target in picks:
        if any(other != robot and target == wanted for other, wanted in picks):
            refused[robot] = failure("station_occupied", f"another robot reaches for the {target}")


def _clashes(scene: Scene, stations: Mapping[str, str], goals: Mapping[str, str | None]) -> set[str]:
    """Robots whose goal another robot keeps or also claims."""
    clash = set()
    for robot, goal in goals.items():
        for other, here in stations.items():
            if other == robot or goal is None:
                continue
            end = goals.get(other, here)
            if end is not None and scene.conflicting(goal, end):
                clash.add(robot)
    return clash


def attempt(
    scene: Scene, world: WorldState, robot: str, subtask: Subtask, *, station: str
) -> tuple[Outcome, WorldState]:
    """What the table says comes of an accepted subtask, seen from the world before the round."""
    false = first_false(scene, world, robot, subtask, "attempt")
    if false is not None:
        after = drop(world, robot) if false.drops else world
        return failure(false.reason, f"not true: {false.condition.sentence}"), after
    if subtask.skill in NAVIGATION:
        return Outcome("success"), world.with_robot(robot, station=station)
    return Outcome("success"), subtask.effect(scene, world, robot)


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
