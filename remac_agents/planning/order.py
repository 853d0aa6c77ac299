"""What of a plan comes before what: the order that its rounds stand for, for robots that do not wait for each other.

A step comes after all that other robots have done by then to what it works on or at its place, and a drive after the
one that left its goal. What a robot waits for beyond that, as it does for things that take their time, it still does.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from remac_agents.plan import Plan
from remac_agents.planning.teamwork import works_on
from remac_agents.planning.whereabouts import Whereabouts
from remac_env.rules.scene import PublicScene
from remac_env.rules.subtasks import WAIT, Subtask

NEW = -1
"""The number of a step that the plan did not hold at first."""


@dataclass(frozen=True, kw_only=True)
class Item:
    """A step of a plan, or a wait that stays.

    Attributes:
        number: of the step in the plan; those of earlier rounds have lower ones.
        step: the subtask.
        after: numbers of those that must have ended before it begins, or before it ends where it is a wait.
        beside: numbers of those that must have ended or begin with it: drives that leave its goal in its round.
        seconds: a wait lasts so long at least, by the skill table.
    """

    number: int
    step: Subtask
    after: frozenset[int] = frozenset()
    beside: frozenset[int] = frozenset()
    seconds: float = 0.0

    @property
    def is_step(self) -> bool:
        """Whether it is more than a wait of the plan's."""
        return self.step != WAIT or self.number == NEW


@dataclass(frozen=True)
class _Step:
    """A step in its round: what it works on, and for drives which places it leaves and reaches."""

    number: int
    round: int
    robot: str
    step: Subtask
    names: frozenset[str]
    leaves: str | None = None
    goal: str | None = None


def in_order(plan: Plan, facts: PublicScene) -> dict[str, tuple[Item, ...]]:
    """Robot -> its steps in their order, with what each waits for."""
    steps = list(_steps(plan, facts))
    return {robot: tuple(_row(robot, steps, facts)) for robot in plan.robots}


def _steps(plan: Plan, facts: PublicScene) -> Iterator[_Step]:
    where, number = Whereabouts(facts), 0
    for index in range(plan.length):
        turn = plan.round(index)
        goals = {robot: where.goal(robot, step) for robot, step in turn.items()}
        before = {robot: where.station.get(robot) for robot in turn}
        held = dict(where.hand)
        for robot, step in turn.items():
            where.run(robot, step, goals[robot])
            if step.moves:
                names = frozenset({step.target} & set(facts.objects))
                yield _Step(number, index, robot, step, names, before[robot], goals[robot])
            else:
                names = works_on(step, held.get(robot), facts)
                yield _Step(number, index, robot, step, names | {f"at {before[robot]}"} if names else names)
            number += 1


def _row(robot: str, steps: Sequence[_Step], facts: PublicScene) -> Iterator[Item]:
    others = [each for each in steps if each.robot != robot]
    waits: list[_Step] = []
    for own in (each for each in steps if each.robot == robot):
        if own.step == WAIT:
            waits.append(own)
            continue
        after = {each for each in others if each.round < own.round and _comes_before(each, own, facts)}
        beside = {each for each in others if each.round == own.round and _leaves(each, own, facts)}
        told = max((each.round for each in after | beside), default=-1)
        yield from (_wait(wait, others) for wait in waits if wait.round > told)
        waits = []
        yield Item(number=own.number, step=own.step, after=_numbers(after), beside=_numbers(beside))


def _comes_before(first: _Step, then: _Step, facts: PublicScene) -> bool:
    """Whether a step of an earlier round has to end before another robot's begins."""
    if first.step.moves:
        return _leaves(first, then, facts)
    return bool(first.names & then.names)


def _leaves(first: _Step, then: _Step, facts: PublicScene) -> bool:
    """Whether a drive leaves a place to which another one leads."""
    return first.leaves is not None and then.goal is not None and facts.conflicting(first.leaves, then.goal)


def _wait(wait: _Step, others: Sequence[_Step]) -> Item:
    """A wait for more than other robots: as long as its round, or until something happens where nobody else acts."""
    meanwhile = [each for each in others if each.round == wait.round and each.step != WAIT]
    before = meanwhile or [each for each in others if each.round < wait.round and each.step != WAIT]
    seconds = max((each.step.row.seconds for each in meanwhile), default=0.0)
    return Item(number=wait.number, step=WAIT, after=_numbers(before), seconds=seconds)


def _numbers(steps: Sequence[_Step] | set[_Step]) -> frozenset[int]:
    return frozenset(each.number for each in steps)
