"""Who may do what in a round: claims are settled before anything moves, the same for every robot.

A robot whose subtask is refused stays where it is. Two robots that claim one station (or two that conflict), or one
object, both get `station_occupied`; arriving where another stands is allowed if that one leaves in the same round.
What robots claim that began earlier stays theirs until they have ended.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.predicates import PREDICATES, Test
from remac_env.rules.skill_row import Mark, Requirement
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState


@dataclass(frozen=True, slots=True)
class Claim:
    """What a busy robot keeps to itself until it has ended: where it began, where it ends, and the object it takes."""

    start: str
    end: str
    takes: str | None = None

    @staticmethod
    def of(world: WorldState, robot: str, subtask: Subtask, end: str) -> Claim:
        """What a robot claims that begins an accepted subtask in this world and ends it at a station."""
        return Claim(world.robots[robot].station, end, subtask.target if subtask.row.takes else None)


NO_CLAIMS: Mapping[str, Claim] = {}
"""Nobody is busy."""


def settled() -> tuple[str, ...]:
    """Predicates that hang on where the other robots go in the same round, whatever is true before it."""
    return tuple(row.name for row in PREDICATES.values() if row.settled)


def first_false(
    rules: Rules, world: WorldState, robot: str, subtask: Subtask, mark: Mark, *, alone: bool = True
) -> Requirement | None:
    """The first requirement of this mark that is false, or None.

    Args:
        alone: False leaves out what the round settles, as robots may change places in it.
    """
    for requirement, test, args in _tests(subtask.skill, subtask.target, robot, mark, alone):
        if not test(rules, world, *args):
            return requirement
    return None


@lru_cache(maxsize=4096)
def _tests(
    skill: str, target: str, robot: str, mark: Mark, alone: bool
) -> tuple[tuple[Requirement, Test, tuple[str, ...]], ...]:
    """The requirements of a mark, with what decides each and on which names: found once, not in every round."""
    wanted = [one for one in Subtask(skill, target).requirements(robot) if one.mark == mark]
    rows = [(one, PREDICATES[one.condition.predicate]) for one in wanted]
    return tuple((one, row.test, one.condition.args) for one, row in rows if alone or not row.settled)


def feasible(rules: Rules, world: WorldState, robot: str, subtask: Subtask) -> bool:
    """Whether the table would let this subtask succeed now, whatever the other robots do in the same round."""
    marks: tuple[Mark, ...] = ("refuse", "attempt")
    return all(first_false(rules, world, robot, subtask, mark, alone=False) is None for mark in marks)


def settle_claims(
    rules: Rules, world: WorldState, subtasks: Mapping[str, Subtask], claims: Mapping[str, Claim] = NO_CLAIMS
) -> tuple[dict[str, Outcome], dict[str, str]]:
    """Refusals of this round, and the station at which every robot will end it.

    Args:
        claims: of the robots that are still busy, none of which is among those with a subtask.

    Returns:
        (refused, stations): an outcome for each robot whose controller declines, and for every robot the station
        that it keeps or goes to.
    """
    refused: dict[str, Outcome] = {}
    picks: list[tuple[str, str]] = []
    goals: dict[str, str | None] = {}
    for robot, subtask in subtasks.items():
        false = first_false(rules, world, robot, subtask, "refuse", alone=False)
        if false is not None:
            refused[robot] = false.outcome
            continue
        row = SKILLS[subtask.skill]
        if row.goes is not None:
            goals[robot] = row.goes(rules, world, robot, subtask.target)
        if row.takes:
            picks.append((robot, subtask.target))
    taken = [(r, claim.takes) for r, claim in claims.items() if claim.takes is not None] if claims else []
    if len(picks) + len(taken) > 1:
        _settle_objects(picks, taken, refused)
        goals = {robot: goal for robot, goal in goals.items() if robot not in refused}
    stations = {robot: state.station for robot, state in world.robots.items()}
    left: list[tuple[str, str]] = []
    for robot, claim in claims.items():
        stations[robot] = claim.end
        left.append((robot, claim.start))
    while goals and (clash := _clashes(rules, stations, goals, left)):
        for robot in clash:
            refused[robot] = failure("station_occupied", f"{goals[robot]} is claimed or in use", refused=True)
        goals = {robot: goal for robot, goal in goals.items() if robot not in clash}
    for robot, goal in goals.items():
        stations[robot] = str(goal)
    return refused, stations


def _settle_objects(
    picks: Sequence[tuple[str, str]], taken: Sequence[tuple[str, str]], refused: dict[str, Outcome]
) -> None:
    """Two robots that reach for one object both stop; one that reaches for what a busy one takes stops."""
    for robot, target in picks:
        if any(other != robot and target == wanted for other, wanted in (*picks, *taken)):
            refused[robot] = failure("station_occupied", f"another robot reaches for the {target}", refused=True)


def _clashes(
    rules: Rules, stations: Mapping[str, str], goals: Mapping[str, str | None], left: Sequence[tuple[str, str]]
) -> list[str]:
    """Robots whose goal another robot keeps, has not `left` for good or also claims, in the order of the goals."""
    kept = {**stations, **goals}.items()
    ends = [*kept, *left] if left else kept
    return [
        robot
        for robot, goal in goals.items()
        if goal is not None
        and any(end is not None and other != robot and rules.conflicting(goal, end) for other, end in ends)
    ]
