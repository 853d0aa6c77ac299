"""Subtasks and who does them, as SMART-LLM's stages answer: read strictly, all that is wrong told at once, laid out.

    {"subtasks": [{"id": "a", "steps": ["first command", "second command"], "skills": ["pick up"], "after": []}]}
    {"a": ["robot_0"], "b": ["robot_0", "robot_1"]}     or {"a": {"robots": [...], "reason": "..."}}
An allocation is held to one rule, SMART-LLM's own: the skills of its robots cover the subtask. Whether the plan is any
good, nobody asks.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from typing import Any

from remac_agents.plan import MAX_STEPS, Commands, Plan, PlanError
from remac_agents.text.json_text import BadAnswer, read_json
from remac_agents.text.plan_words import Names, without_thoughts
from remac_env.rules.subtasks import WAIT, Subtask

MAX_SUBTASKS = 40
"""A longer decomposition is refused."""

DECOMPOSITION = 'a decomposition was asked for; valid: {"subtasks": [{"id", "steps", "skills", "after"}, ...]}'
ALLOCATION = "an allocation was asked for; valid: a JSON object, subtask id -> list of robots"

Skills = Mapping[str, frozenset[str]]
"""Robot -> the names of its skills."""


@dataclass(frozen=True)
class Task:
    """A part of the goal. `after`: ids of those that must have ended before it begins."""

    id: str
    steps: tuple[Subtask, ...]
    skills: frozenset[str]
    after: tuple[str, ...] = ()


Decomposition = tuple[Task, ...]
Allocation = Mapping[str, tuple[str, ...]]


def skills_of(commands: Iterable[Subtask]) -> frozenset[str]:
    """The names of the skills that commands need."""
    return frozenset(step.skill for step in commands if not step.row.still)


def read_decomposition(reply: object, commands: Commands, skills: Skills) -> Decomposition | PlanError:
    """A reply to `decompose`: JSON text, or the same as values."""
    value = _value(reply, DECOMPOSITION)
    if isinstance(value, PlanError):
        return value
    listed = value.get("subtasks") if isinstance(value, Mapping) else value
    if not isinstance(listed, list | tuple) or any(not isinstance(entry, Mapping) for entry in listed):
        return PlanError(DECOMPOSITION)
    if not 0 < len(listed) <= MAX_SUBTASKS:
        return PlanError(f"{len(listed)} subtasks; valid: 1 to {MAX_SUBTASKS}")
    known = frozenset().union(*skills.values())
    problems: list[str] = []
    tasks = [_read_task(entry, number, commands, known, problems) for number, entry in enumerate(listed, 1)]
    problems += _order_problems(tasks)
    return _refused(problems) if problems else tuple(tasks)


def _read_task(
    entry: Mapping[Any, Any], number: int, commands: Commands, known: frozenset[str], problems: list[str]
) -> Task:
    name = _name(entry.get("id"))
    if name is None:
        problems.append(f"subtask {number} has no id; valid: a text or a whole number")
        name = f"subtask {number}"
    steps: list[Subtask] = []
    told = entry.get("steps")
    if not isinstance(told, list | tuple) or not 0 < len(told) <= MAX_STEPS:
        problems.append(f"subtask {name!a}: steps is no list of 1 to {MAX_STEPS} commands")
        told = ()
    for text in told:
        step = text if isinstance(text, Subtask) else commands.parse(text) if isinstance(text, str) else None
        if step is None or not commands.allows(step):
            problems.append(f"subtask {name!a}: {commands.unknown(text)}")
        else:
            steps.append(step)
    wanted = _texts(entry.get("skills", ()))
    after = [_name(other) for other in entry.get("after", ())] if _is_list(entry.get("after", ())) else None
    if wanted is None or after is None or None in after:
        problems.append(f"subtask {name!a}: skills and after are no lists of texts")
    problems += [
        f"subtask {name!a}: unknown skill {skill[:40]!a}; valid: {', '.join(sorted(known))}"
        for skill in sorted(set(wanted or ()) - known)
    ]
    return Task(name, tuple(steps), skills_of(steps) | frozenset(wanted or ()), tuple(o for o in after or () if o))


def _order_problems(tasks: Sequence[Task]) -> list[str]:
    """Ids that stand twice, that nobody has, and circles."""
    names = [task.id for task in tasks]
    problems = [f"the id {name!a} stands twice" for name in dict.fromkeys(names) if names.count(name) > 1]
    for task in tasks:
        problems += [
            f"subtask {task.id!a} is after unknown {other!a}; valid: {', '.join(names)}"
            for other in task.after
            if other not in names
        ]
    try:
        TopologicalSorter({task.id: task.after for task in tasks}).prepare()
    except CycleError as error:
        problems.append(f"subtasks wait for each other in a circle: {' after '.join(error.args[1])}")
    return problems


def read_allocation(
    reply: object, tasks: Decomposition, robots: Sequence[str], skills: Skills, lead: str
) -> Allocation | PlanError:
    """A reply to `allocate`: JSON text, or the same as values."""
    value = _value(reply, ALLOCATION)
    if isinstance(value, PlanError):
        return value
    if isinstance(value, Mapping) and isinstance(value.get("allocation"), Mapping):
        value = value["allocation"]
    names, ids = Names(robots, lead, str), [task.id for task in tasks]
    if not isinstance(value, Mapping) or (value and all(names.robot(key) for key in value)):
        return PlanError(ALLOCATION)
    problems = [
        f"unknown subtask {str(key)[:40]!a}; valid: {', '.join(ids)}" for key in value if _name(key) not in ids
    ]
    told = {_name(key): row for key, row in value.items()}
    team: dict[str, tuple[str, ...]] = {}
    for task in tasks:
        row = told.get(task.id)
        row = row.get("robots") if isinstance(row, Mapping) else [row] if isinstance(row, str) else row
        if not isinstance(row, list | tuple) or not row:
            problems.append(f"subtask {task.id!a} is given to no robot; valid: a list of {', '.join(robots)}")
            continue
        found = [names.robot(name) for name in row]
        problems += [
            f"subtask {task.id!a}: unknown robot {str(name)[:40]!a}; valid: {', '.join(robots)}"
            for name, robot in zip(row, found, strict=True)
            if robot is None
        ]
        team[task.id] = tuple(dict.fromkeys(robot for robot in found if robot is not None))
        lacking = task.skills - frozenset().union(*(skills.get(robot, frozenset()) for robot in team[task.id]))
        if lacking and None not in found:
            problems.append(f"subtask {task.id!a}: {', '.join(team[task.id])} cannot {', '.join(sorted(lacking))}")
    return _refused(problems) if problems else team


def lay_out(tasks: Decomposition, allocation: Allocation, robots: Sequence[str], skills: Skills) -> Plan:
    """Rows for all robots: subtasks one after the other where `after` or a robot of theirs makes them, else at once."""
    by_id = {task.id: task for task in tasks}
    place = {task.id: number for number, task in enumerate(tasks)}
    sorter = TopologicalSorter({task.id: task.after for task in tasks})
    sorter.prepare()
    rows: dict[str, list[Subtask]] = {robot: [] for robot in robots}
    ended: dict[str, int] = {}
    ready: list[str] = list(sorter.get_ready())
    while ready:
        name = min(ready, key=lambda each: place[each])
        ready.remove(name)
        task, team = by_id[name], allocation[name]
        start = max([len(rows[robot]) for robot in team] + [ended[other] for other in task.after])
        for robot, steps in _by_turns(task, team, skills).items():
            rows[robot] += [WAIT] * (start - len(rows[robot])) + steps
        ended[name] = start + len(task.steps)
        sorter.done(name)
        ready += sorter.get_ready()
    return Plan.of(rows)


def _by_turns(task: Task, team: Sequence[str], skills: Skills) -> dict[str, list[Subtask]]:
    """A team's rows of one subtask: whoever has the skill goes on; a way is gone by whoever works at its end."""
    rows: dict[str, list[Subtask]] = {robot: [] for robot in team}
    at_work = next(iter(team))
    for index, step in enumerate(task.steps):
        ahead = next((other for other in task.steps[index:] if not other.moves), step)
        for needed in (ahead, step):
            if not needed.row.still and needed.skill not in skills[at_work]:
                at_work = next((robot for robot in team if needed.skill in skills[robot]), at_work)
        for robot, row in rows.items():
            row.append(step if robot == at_work else WAIT)
    return rows


# -- what answers are made of ------------------------------------------------------------------------------------------


def _value(reply: object, wanted: str) -> Any:
    """JSON out of a text, anything else as it is."""
    if not isinstance(reply, str):
        return reply.rows if isinstance(reply, Plan) else reply
    told = without_thoughts(reply)
    if told is None:
        return PlanError("the answer ends in the middle of its thoughts")
    answer = read_json(told)
    return PlanError(f"{answer.problem}; {wanted}") if isinstance(answer, BadAnswer) else answer.value


def _refused(problems: Sequence[str]) -> PlanError:
    return PlanError.of([PlanError(problem) for problem in problems])


def _name(value: object) -> str | None:
    if isinstance(value, bool) or not isinstance(value, str | int):
        return None
    return str(value).strip()[:40] or None


def _is_list(value: object) -> bool:
    return isinstance(value, list | tuple)


def _texts(value: object) -> list[str] | None:
    if not isinstance(value, list | tuple) or any(not isinstance(entry, str) for entry in value):
        return None
    return list(value)


def as_values(tasks: Decomposition) -> tuple[dict[str, Any], ...]:
    """A decomposition as the values that the next stage is told."""
    return tuple(
        {
            "id": task.id,
            "steps": [step.text for step in task.steps],
            "skills": sorted(task.skills),
            "after": list(task.after),
        }
        for task in tasks
    )
