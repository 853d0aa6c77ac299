"""The paper's hand-over: one robot keeps the main object's plan, another one gets what comes before it."""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.handovers.company import accompanied, attended
from remac_agents.handovers.schedule import schedule
from remac_agents.plan import Commands, Plan
from remac_agents.planning.lessons import Before, read_lesson
from remac_agents.planning.teamwork import parts_of, share_out
from remac_agents.planning.whereabouts import way_to
from remac_agents.roles import HandoverRequest
from remac_env.rules.subtasks import Subtask


class ReflectionHandover:
    """Extracts the main object's plan, guided by the recorded reflections; schedules the rest beside it.

    Subgoals that have nothing to do with one another are shared out as well, where that takes fewer rounds.
    """

    needs_truth, needs_rules = False, True
    tries_company = True

    def __init__(self, *, careful: bool = False) -> None:
        """Args: careful: in the iteration that counts nothing is shared that no team has done before."""
        self._careful = careful

    def share(self, request: HandoverRequest) -> Plan | None:
        """A plan for the team, or None where nothing is gained."""
        if request.kept or request.failing:  # one robot cannot do it, so there is nothing to lose
            return attended(request) if request.kept else accompanied(request)
        if self._careful and request.untried:
            return None
        names, facts = request.team, request.view.scene
        plans = [_prerequisites_first(request), share_out(parts_of(request.plan), names, facts, places=True)]
        found = [plan for plan in plans if plan is not None and plan.length < len(request.plan)]
        return min(found, key=lambda plan: plan.length, default=None)


def _prerequisites_first(request: HandoverRequest) -> Plan | None:
    """The paper's hand-over, or None where nothing comes before the main object."""
    obj = main_object(request)
    if obj is None:
        return None
    prerequisites, main = _split(request.plan, obj)
    if not any(step.skill != "navigate to" for step in prerequisites):
        return None
    return schedule(request.lead, main, request.helper, prerequisites, request.view.scene)


def main_object(request: HandoverRequest) -> str | None:
    """The object that the plan is about.

    Lessons say before the taking up of which object something had to be done: the last such object that no
    lesson itself brought in. Without lessons, the last object taken up that the goal names, else the last one.
    """
    taken = [step.target for step in request.plan if step.row.takes]
    commands = Commands(request.commands)
    lessons = [
        lesson for text in request.reflections if isinstance(lesson := read_lesson(text, commands), Before)
    ]
    brought = {step.target for lesson in lessons for step in lesson.steps if step.row.takes}
    anchors = {lesson.anchor.target for lesson in lessons if lesson.anchor.row.takes} - brought
    named = {name for name in taken if name in request.goal.lower()}
    for choice in (anchors, named, set(taken)):
        found = [name for name in taken if name in choice]
        if found:
            return found[-1]
    return None


def _split(plan: Sequence[Subtask], obj: str) -> tuple[list[Subtask], list[Subtask]]:
    """What comes before the last way to `obj`, and the rest; the rest begins with that way."""
    way = way_to(obj)
    index = max(i for i, step in enumerate(plan) if step == Subtask("pick up", obj))
    before = list(plan[:index])
    while before and before[-1] == way:
        before.pop()
    return before, [way, *plan[index:]]
