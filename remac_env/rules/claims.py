"""Who may do what in a round: claims are settled before anything moves, the same for every robot.

A robot whose subtask is refused stays where it is. Two robots that claim one station (or two that conflict), one
object, or one place to put something down, both get `station_occupied`; arriving where another stands is allowed if
that one leaves in the same round.
What robots claim that began earlier stays theirs until they have ended.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.places import landing
from remac_env.rules.predicates import PREDICATES, Test
from remac_env.rules.skill_row import Mark, Requirement
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import Subtask
from remac_env.state import Place, WorldState, contents


@dataclass(frozen=True, slots=True)
class Claim:
    """What a busy robot keeps to itself until it has ended: where it began and ends, what it takes, where it puts."""

    start: str
    end: str
    takes: str | None = None
    puts: Place | None = None

    @staticmethod
    def of(rules: Rules, world: WorldState, robot: str, subtask: Subtask, end: str) -> Claim:
        """What a robot claims that begins an accepted subtask in this world and ends it at a station."""
        return Claim(world.robots[robot].station, end, *_reached_for(rules, world, robot, subtask))


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
    hands: list[_Hand] = []
    goals: dict[str, str | None] = {}
    for robot, subtask in subtasks.items():
        false = first_false(rules, world, robot, subtask, "refuse", alone=False)
        if false is not None:
            refused[robot] = false.outcome
            continue
        row = SKILLS[subtask.skill]
        if row.goes is not None:
            goals[robot] = row.goes(rules, world, robot, subtask.target)
        takes, puts = _reached_for(rules, world, robot, subtask)
        if takes or puts:
            hands.append((robot, takes, puts))
    busy = [(robot, claim.takes, claim.puts) for robot, claim in claims.items() if claim.takes or claim.puts]
    if len(hands) + len(busy) > 1:
        _settle_hands(rules, world, hands, busy, refused)
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


_Hand = tuple[str, str | None, Place | None]
"""A robot, the object that it takes, and where it puts down what it holds."""


def _reached_for(
    rules: Rules, world: WorldState, robot: str, subtask: Subtask
) -> tuple[str | None, Place | None]:
    """What a subtask takes, and where it puts down what its robot holds.

    The latter matters only where another robot can put something there too.
    """
    row = subtask.row
    puts = landing(rules, world, robot, subtask.target) if row.puts and rules.two_sided else None
    return subtask.target if row.takes else None, puts


def _settle_hands(
    rules: Rules, world: WorldState, hands: Sequence[_Hand], busy: Sequence[_Hand], refused: dict[str, Outcome]
) -> None:
    """Two robots that reach for one object or one place both stop; one that reaches for a busy one's stops."""
    for hand in hands:
        for other in (*hands, *busy):
            if other[0] != hand[0] and (name := _both(rules, world, hand, other)) is not None:
                told = f"another robot reaches for the {name}"
                refused[hand[0]] = failure("station_occupied", told, refused=True)
                break


def _both(rules: Rules, world: WorldState, hand: _Hand, other: _Hand) -> str | None:
    """What two robots reach for that only one of them can have; a vessel may have room for what both hold."""
    (_, takes, puts), (_, other_takes, other_puts) = hand, other
    if takes is not None and other_takes is not None:
        return takes if takes == other_takes else None
    place, name = puts or other_puts, takes or other_takes
    if place is None:
        return None
    if name is not None:
        return name if place.where == name else None
    if puts != other_puts:
        return None
    if place.relation == "slot":
        return rules.slots[place.where].fixture
    return place.where if rules.objects[place.where].holds - len(contents(world, place.where)) < 2 else None


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
