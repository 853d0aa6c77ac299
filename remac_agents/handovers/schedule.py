"""Two robots' rows side by side: what the helper prepares is finished before it is needed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from remac_agents.plan import Plan
from remac_agents.planning.whereabouts import Whereabouts
from remac_env.rules.facts import ASIDE
from remac_env.rules.scene import PublicScene
from remac_env.rules.subtasks import STEP_ASIDE, WAIT, Subtask


def schedule(
    lead: str, main: Sequence[Subtask], helper: str, work: Sequence[Subtask], facts: PublicScene
) -> Plan:
    """The shortest of the schedules in which the leading robot starts at once or later, steps in order.

    The helper steps aside at the end. The leading robot goes only to places that the helper has left for good, and
    touches only objects that the helper no longer will; both follow from the plans' own words.
    """
    row = (*work, STEP_ASIDE)
    plans = (_try(lead, main, helper, row, facts, delay) for delay in range(len(row) + 1))
    return min((plan for plan in plans if plan is not None), key=lambda plan: plan.length)


def _try(
    lead: str,
    main: Sequence[Subtask],
    helper: str,
    work: Sequence[Subtask],
    facts: PublicScene,
    delay: int,
) -> Plan | None:
    """The schedule in which the leading robot starts so many rounds late; None if they block each other.

    Waits of the rows themselves, for what takes its time, are steps like others.
    """
    where = Whereabouts(facts)
    left, prepared = list(main), list(work)
    rows: dict[str, list[Subtask]] = {lead: [], helper: []}
    while left or prepared:
        by_plan = {robot for robot, steps in ((lead, left), (helper, prepared)) if steps[:1] == [WAIT]}
        waits_by_choice = len(rows[lead]) < delay and bool(prepared)
        by_plan -= {lead} if waits_by_choice else set()
        steps = {
            helper: prepared[0] if prepared else WAIT,
            lead: WAIT if waits_by_choice or not left else left[0],
        }
        goals = {robot: where.goal(robot, step) for robot, step in steps.items()}
        if steps[lead] != WAIT and not _ready(where, facts, steps[lead], goals, lead, helper, prepared):
            steps[lead], goals[lead] = WAIT, where.station.get(lead, ASIDE)
        if steps[helper].moves and _clash(facts, goals[helper], goals[lead]):
            if steps[lead].moves:
                steps[lead], goals[lead] = WAIT, where.station.get(lead, ASIDE)
            if _clash(facts, goals[helper], goals[lead]):
                steps[helper], goals[helper] = WAIT, where.station.get(helper, ASIDE)
        idle = set(steps.values()) == {WAIT} and not by_plan
        if idle and not waits_by_choice:
            return None
        for robot, step in steps.items():
            where.run(robot, step, goals[robot])
            rows[robot].append(step)
        left = left if steps[lead] == WAIT and lead not in by_plan else left[1:]
        prepared = prepared if steps[helper] == WAIT and helper not in by_plan else prepared[1:]
        if waits_by_choice and idle:
            return None
    return Plan.of(_without_late_leaving(rows, helper))


def _ready(
    where: Whereabouts,
    facts: PublicScene,
    step: Subtask,
    goals: Mapping[str, str | None],
    lead: str,
    helper: str,
    prepared: Sequence[Subtask],
) -> bool:
    """Whether the leading robot may run `step` while the helper runs the first of `prepared`."""
    touched = {other.target for other in prepared if not other.moves}
    touched |= {name for name in (where.hand.get(helper),) if name is not None and prepared}
    if step.target in touched:
        return False
    if not step.moves:
        return True
    ahead = [goals[helper]] + [
        where.of(other.target) for other in prepared[1:] if other.skill == "navigate to"
    ]
    return not any(_clash(facts, goals[lead], place) for place in ahead)


def _clash(facts: PublicScene, first: str | None, second: str | None) -> bool:
    """Whether two robots cannot stand at these places at once; of one that is not told, nothing is known."""
    return first is not None and second is not None and facts.conflicting(first, second)


def _without_late_leaving(rows: dict[str, list[Subtask]], helper: str) -> dict[str, list[Subtask]]:
    """Nobody need step aside once everything is done."""
    other = max(len(row) for name, row in Plan.of(rows).rows.items() if name != helper)
    row = rows[helper]
    if len(row) > other and row[-1] == STEP_ASIDE:
        rows[helper] = row[:-1]
    return rows
