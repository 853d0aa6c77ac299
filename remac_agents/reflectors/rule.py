"""Lessons in fixed form, from the advice that a failed pre-check was met with."""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.planning.lessons import Before, Instead, LeaveOut, is_leave_out, looked_for
from remac_agents.roles import ReflectRequest
from remac_env.rules.subtasks import Subtask


class RuleReflector:
    """Says what should have been done, and before which step.

    Steps that need an empty hand are moved to before the robot took up what it held when the check failed:
    this is what makes the next plan shorter than the adjusted one.
    """

    needs_truth, needs_rules = False, True

    def reflect(self, request: ReflectRequest) -> list[str]:
        """At most two lessons: what to do in time, and what to do otherwise."""
        advice, lessons = request.advice, []
        if advice.left_out:
            return [LeaveOut(request.subtask).text]
        if advice.remedy:
            lessons.append(Before(self._anchor(request), advice.remedy).text)
        if advice.instead is not None and request.held is not None:
            lessons.append(Instead(request.held, advice.instead, request.subtask).text)
        return lessons

    def review(self, lessons: Sequence[str], *, success: bool) -> list[str]:
        """What is worth keeping at the end: leaving a step out proves nothing unless it led to success, and of the
        places where something was looked for the last is that where it was."""
        kept = [text for text in lessons if success or not is_leave_out(text)]
        last = {searched: at for at, text in enumerate(kept) if (searched := looked_for(text)) is not None}
        return [text for at, text in enumerate(kept) if last.get(looked_for(text) or "", at) == at]

    def _anchor(self, request: ReflectRequest) -> Subtask:
        if request.held is not None and any(_needs_empty_hand(step) for step in request.advice.remedy):
            return Subtask("pick up", request.held)
        return request.subtask


def _needs_empty_hand(step: Subtask) -> bool:
    return any(requirement.condition.predicate == "hand_empty" for requirement in step.requirements(""))
