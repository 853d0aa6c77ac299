"""Rewriting of one robot's plan by lessons, and tidying of what has become superfluous."""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.planning.lessons import Before, Instead, LeaveOut, Lesson
from remac_agents.planning.whereabouts import Whereabouts, hands
from remac_env.rules.scene import PublicScene
from remac_env.rules.subtasks import STEP_ASIDE, Subtask

Steps = list[Subtask]


def apply(steps: Sequence[Subtask], lesson: Lesson) -> Steps:
    """The plan with one lesson followed; unchanged where the lesson speaks of steps that it does not have."""
    if isinstance(lesson, Before):
        return _insert(list(steps), lesson)
    if isinstance(lesson, Instead):
        return _replace(list(steps), lesson)
    return _leave_out(list(steps), lesson)


def _insert(steps: Steps, lesson: Before) -> Steps:
    if lesson.anchor not in steps:
        return steps
    index = steps.index(lesson.anchor)
    if _contains(steps[:index], [step for step in lesson.steps if not step.moves]):
        return steps
    moves = any(step.moves for step in lesson.steps)
    # A robot that was sent away has to come back to where it was.
    back = [step for step in steps[:index] if step.moves][-1:] if moves else []
    return [*steps[:index], *lesson.steps, *back, *steps[index:]]


def _contains(steps: Steps, wanted: Steps) -> bool:
    """Whether all wanted steps are there, in this order; never when nothing is wanted."""
    rest = iter(steps)
    return bool(wanted) and all(step in rest for step in wanted)


def _replace(steps: Steps, lesson: Instead) -> Steps:
    held = hands(steps)
    return [
        lesson.use if step == lesson.not_this and hand == lesson.held else step
        for step, hand in zip(steps, held, strict=True)
    ]


def _leave_out(steps: Steps, lesson: LeaveOut) -> Steps:
    if lesson.subtask not in steps:
        return steps
    index = len(steps) - 1 - steps[::-1].index(lesson.subtask)
    return steps[:index] + steps[index + 1 :]


def tidy(steps: Sequence[Subtask], facts: PublicScene) -> Steps:
    """The plan without steps that change nothing: idle ways, objects taken up twice, work done twice."""
    old: Steps = []
    new = list(steps)
    while new != old:
        old, new = new, _tidy_once(new, facts)
    return new


def _tidy_once(steps: Steps, facts: PublicScene) -> Steps:
    where, kept = Whereabouts(facts), []
    last: dict[str, str] = {}
    for step, following in zip(steps, [*steps, None][1:], strict=True):
        if step.moves:
            goal = where.goal("", step)
            there = goal is not None and goal == where.station.get("")
            idle = following is None or following.moves or there
            idle = idle and not (step == STEP_ASIDE and following is None)
        elif step.row.lasting:
            idle = last.get(step.target) == step.skill
            last[step.target] = step.skill
        else:
            idle = step.row.takes and where.hand.get("") == step.target
        if not idle:
            where.run("", step)
            kept.append(step)
    return kept
