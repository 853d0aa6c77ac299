"""One row of steps shared out between robots: who does which part of it, and when.

All that is known comes from the row's own words. Its order is kept wherever two steps touch the same object or fixture;
no two robots stand at one place at the end of a round, and nobody goes where they would only wait.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from remac_agents.plan import Plan
from remac_agents.planning.whereabouts import Whereabouts, hands, way_to
from remac_env.rules.facts import ASIDE
from remac_env.rules.scene import PublicScene
from remac_env.rules.subtasks import STEP_ASIDE, WAIT, Subtask

Part = tuple[Subtask, ...]

MOST_ALLOCATIONS = 1024
"""Allocations tried one by one at most; beyond that each part in turn goes where it ends soonest."""


def parts_of(steps: Sequence[Subtask], *, fine: bool = False) -> list[Part]:
    """The row cut where a hand is empty and a way begins, so that each part can be any robot's.

    `fine`: also where work on another fixture begins from the same place; its part begins with the way there.
    """
    parts: list[list[Subtask]] = [[]]
    for step, held in zip(steps, hands(steps), strict=True):
        way, touched = step.moves, {other.target for other in parts[-1]}
        worked = any(not other.moves for other in parts[-1])
        if worked and held is None and (way or (fine and step.target not in touched)):
            parts.append([] if way else [way_to(step.target)])
        parts[-1].append(step)
    return [tuple(part) for part in parts if part]


def independent(parts: Sequence[Part], facts: PublicScene) -> list[list[Part]]:
    """The parts in groups that have no object and no fixture in common, in their order."""
    steps = [step for part in parts for step in part]
    names = iter([works_on(step, held, facts) for step, held in zip(steps, hands(steps), strict=True)])
    groups: list[tuple[list[int], frozenset[str]]] = []
    for number, part in enumerate(parts):
        touched = frozenset[str]().union(*[next(names) for _ in part])
        joined = [group for group in groups if group[1] & touched]
        numbers = sorted([number, *(each for group in joined for each in group[0])])
        groups = [group for group in groups if group not in joined]
        groups.append((numbers, touched.union(*(group[1] for group in joined))))
    return [[parts[number] for number in numbers] for numbers, _ in sorted(groups, key=lambda group: group[0])]


def share_out(parts: Sequence[Part], robots: Sequence[str], facts: PublicScene, *, places: bool) -> Plan:
    """The shortest of the schedules in which each part is done by one robot, in the order of the parts.

    Args:
        parts: together one row that a robot alone could run.
        robots: in order of preference; the first does everything where sharing gains nothing.
        facts: the kitchen's.
        places: work at one and the same place keeps its order too. Without it, fixtures side by side are independent.
    """
    work = _analyse(parts, facts, places=places)
    best: Plan | None = None
    for owners in _allocations(work, len(parts), robots, facts):
        for shift in range(len(robots)):
            plan = _lay_out(work, owners, (*robots[shift:], *robots[:shift]), facts)
            if plan is not None and (best is None or plan.length < best.length):
                best = plan
    return best or Plan.of({next(iter(robots)): [step for part in parts for step in part]})


@dataclass(frozen=True)
class _Work:
    """A step: its part, where it leaves its robot, what has to end before it, and before the way to it."""

    step: Subtask
    part: int
    goal: str
    after: frozenset[int]
    sure: frozenset[int]

    @property
    def is_way(self) -> bool:
        return self.step.moves


def _analyse(parts: Sequence[Part], facts: PublicScene, *, places: bool) -> list[_Work]:
    steps = [(number, step) for number, part in enumerate(parts) for step in part]
    where, goals = Whereabouts(facts), []
    held = hands(step for _, step in steps)
    for _, step in steps:
        where.run("", step)
        goals.append(where.station[""])
    touched = [works_on(step, hand, facts) for (_, step), hand in zip(steps, held, strict=True)]
    if places:
        touched = [names | {f"at {goal}"} if names else names for names, goal in zip(touched, goals, strict=True)]
    after = [
        frozenset(i for i in range(index) if touched[i] & touched[index] and steps[i][0] != steps[index][0])
        for index in range(len(steps))
    ]
    work = []
    for index, (number, step) in enumerate(steps):
        if not step.moves:
            work.append(_Work(step, number, goals[index], after[index], frozenset()))
            continue
        there = itertools.takewhile(lambda i: not steps[i][1].moves, range(index + 1, len(steps)))
        needed = frozenset().union(*(after[i] for i in there if steps[i][0] == number))
        moved = frozenset(i for i in needed if step.target in facts.objects and step.target in touched[i])
        work.append(_Work(step, number, goals[index], needed, moved))
    return work


def works_on(step: Subtask, held: str | None, facts: PublicScene) -> frozenset[str]:
    """What a step works on. Objects are put side by side on a surface that is used from several places."""
    if step.moves or not step.target:
        return frozenset()
    wide = step.target in facts.fixtures and len(facts.stations_of(step.target)) > 1
    return frozenset({held} if held is not None else ()) | frozenset(() if wide else (step.target,))


def _allocations(
    work: Sequence[_Work], parts: int, robots: Sequence[str], facts: PublicScene
) -> Iterator[tuple[str, ...]]:
    if len(robots) ** parts <= MOST_ALLOCATIONS:
        yield from itertools.product(robots, repeat=parts)
        return
    owners: tuple[str, ...] = ()
    for number in range(parts):
        begun = [item for item in work if item.part <= number]
        plans = {robot: _lay_out(begun, (*owners, robot), robots, facts) for robot in robots}
        lengths = {robot: plan.length for robot, plan in plans.items() if plan is not None}
        owners = (*owners, min(lengths, key=lambda robot: lengths[robot], default=next(iter(robots))))
    yield owners


def _lay_out(
    work: Sequence[_Work], owners: Sequence[str], order: Sequence[str], facts: PublicScene
) -> Plan | None:
    """The rounds of one allocation; None if robots block each other. Those first in `order` go first."""
    left = {robot: deque(i for i, item in enumerate(work) if owners[item.part] == robot) for robot in order}
    station, done = dict.fromkeys(order, ASIDE), set[int]()
    rows: dict[str, list[Subtask]] = {robot: [] for robot in order}
    while any(left.values()):
        for robot in order:
            _skip_idle_ways(left[robot], work, station[robot])
        acts = {r: q[0] for r, q in left.items() if q and not work[q[0]].is_way and work[q[0]].after <= done}
        sure = done | set(acts.values())
        ways = {r: q[0] for r, q in left.items() if q and work[q[0]].is_way}
        acts |= {r: i for r, i in ways.items() if work[i].after <= sure and work[i].sure <= done}
        goals, aside = _settle(acts, left, work, station, facts, order)
        if not acts and not aside:
            return None if any(left.values()) else Plan.of(rows)
        for robot in order:
            step = work[acts[robot]].step if robot in acts else STEP_ASIDE if robot in aside else WAIT
            rows[robot].append(step)
            if robot in acts:
                done.add(left[robot].popleft())
        station = goals
    return Plan.of(rows)


def _skip_idle_ways(left: deque[int], work: Sequence[_Work], station: str) -> None:
    """Leave out ways that lead nowhere else."""
    while left and work[left[0]].is_way:
        following = work[left[1]] if len(left) > 1 else None
        if following is not None and not following.is_way and work[left[0]].goal != station:
            return
        if following is None and work[left[0]].step == STEP_ASIDE:
            return
        left.popleft()


def _settle(
    acts: dict[str, int],
    left: Mapping[str, deque[int]],
    work: Sequence[_Work],
    station: Mapping[str, str],
    facts: PublicScene,
    order: Sequence[str],
) -> tuple[dict[str, str], set[str]]:
    """Where everybody stands after the round, and who steps aside. Ways that lead to somebody's place are put off."""
    goals = {robot: work[acts[robot]].goal if robot in acts else station[robot] for robot in order}
    aside = {robot for robot in order if not left[robot] and station[robot] != ASIDE}
    goals |= dict.fromkeys(aside, ASIDE)
    while True:
        clash = next(
            (
                (robot, other)
                for robot in reversed(order)
                for other in order
                if robot != other and robot in acts and work[acts[robot]].is_way
                if facts.conflicting(goals[robot], goals[other])
            ),
            None,
        )
        if clash is None:
            return goals, aside
        robot, other = clash
        idle = other not in acts and left[other] and work[left[other][0]].is_way
        if idle and goals[other] != ASIDE:
            aside.add(other)
            goals[other] = ASIDE
        else:
            del acts[robot]
            goals[robot] = station[robot]
