"""What to try in the next iteration where a command failed every time, though all that is known allows it.

Rules of thumb that name no kitchen: what does not come on may want something else shut or on before it; what cannot be
taken up may be too hot; where nothing goes in, another place may do.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from remac_agents.plan import Commands
from remac_agents.planning.teamwork import parts_of
from remac_agents.planning.whereabouts import way_to
from remac_agents.roles import PlanRequest, PreviousTry
from remac_env.rules.subtasks import STEP_ASIDE, WAIT, Subtask


def failed_always(previous: PreviousTry) -> list[str]:
    """The commands that were tried in the iteration before and never succeeded, in their order."""
    worked = {ran.command for ran in previous.ran if ran.succeeded}
    return [ran for ran in dict.fromkeys(ran.command for ran in previous.ran if ran.failed) if ran not in worked]


def explored(steps: Sequence[Subtask], request: PlanRequest) -> list[Subtask]:
    """The plan of the iteration before, with something else tried around what failed in it; at first the steps."""
    if request.previous is None:
        return list(steps)
    commands = Commands(request.commands)
    found = _in_one_row(planned_before(request.previous, commands), request.lead) or list(steps)
    if request.previous.success:
        return found
    for text in failed_always(request.previous):
        step = commands.parse(text)
        if step is None or step not in found:
            continue
        if step.skill == "turn on":
            found = _before(found, step, _prepared(step, commands))
        elif step.row.puts:
            found = _elsewhere(found, step, request)
        elif step.row.takes:
            off = [Subtask("turn off", name) for name in request.facts.names("switch")]
            on = [each for each in off if Subtask("turn on", each.target) in found[: found.index(step)]]
            found = _before(found, step, [part for each in on for part in (way_to(each.target), each)])
    return found


def planned_before(previous: PreviousTry, commands: Commands) -> dict[str, list[Subtask]]:
    """The plan of the iteration before, robot -> its row; commands that this kitchen lacks are left out."""
    read = {robot: [commands.parse(text) for text in row] for robot, row in previous.plan.items()}
    return {robot: [step for step in row if step is not None] for robot, row in read.items()}


def _in_one_row(rows: Mapping[str, Sequence[Subtask]], lead: str) -> list[Subtask]:
    """What several robots were to do as one could do it: part after part, in the order in which they were to begin."""
    if all(not row for robot, row in rows.items() if robot != lead):
        return list(rows.get(lead, ()))
    begun: list[tuple[int, Sequence[Subtask]]] = []
    for row in rows.values():
        rounds = [number for number, step in enumerate(row) if step not in (WAIT, STEP_ASIDE)]
        at = 0
        for part in parts_of([row[number] for number in rounds]):
            begun.append((rounds[at], part))
            at += len(part)
    return [step for _, part in sorted(begun, key=lambda each: each[0]) for step in part]


def _before(steps: list[Subtask], step: Subtask, first: Sequence[Subtask]) -> list[Subtask]:
    """The steps with others before the first of its kind, and the way back."""
    at = steps.index(step)
    return [*steps[:at], *first, *([way_to(step.target)] if first else []), *steps[at:]]


def _prepared(step: Subtask, commands: Commands) -> list[Subtask]:
    """Every door is shut, and every other switch turned on; what is so already is left out when it comes to it."""
    shut = [each for each in commands.values() if each.skill == "close door"]
    others = [each for each in commands.values() if each.skill == step.skill and each != step]
    return [part for each in [*shut, *others] for part in (way_to(each.target), each)]


def _elsewhere(steps: list[Subtask], step: Subtask, request: PlanRequest) -> list[Subtask]:
    """Into the next place that the goal names, and there alone the door is opened instead."""
    names = [name for name in request.facts.fixtures if name in request.goal and request.facts.fixtures[name].room]
    said = request.goal.find
    others = [name for name in names if name != step.target and said(name) > said(step.target)]
    if not others:
        return steps
    return [Subtask(each.skill, others[0]) if each.target == step.target else each for each in steps]
