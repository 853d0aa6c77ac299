"""Roles whose answers are checked before a method sees them. What they may see is read from them once, and stays so."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from remac_agents.plan import PlanError
from remac_agents.roles import (
    AdjustRequest,
    Advice,
    ExplainRequest,
    Explanation,
    HandoverRequest,
    PlanRequest,
    ReflectRequest,
    Roles,
    SeenStep,
    Summary,
    Verdict,
    View,
)
from remac_agents.roles.grants import is_ours, reads_truth
from remac_agents.text.printable import words
from remac_agents.wiring.answers import MOST_LESSONS, Answers
from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import Subtask

PROBLEM = 2_000
"""Characters of what a planner says about its own failure."""


def checked(roles: Roles) -> Roles:
    """The same roles, each behind a check of its answers."""
    kinds: dict[str, Any] = {
        "planner": CheckedPlanner,
        "conditions": CheckedConditions,
        "checker": CheckedChecker,
        "adjuster": CheckedAdjuster,
        "reflector": CheckedReflector,
        "handover": CheckedHandover,
        "summariser": CheckedSummariser,
    }
    return Roles(**{name: kinds[name](name, role) for name, role in roles.named().items()})


def everyone(roles: Roles) -> tuple[CheckedRole, ...]:
    """All of them, of roles that are checked."""
    return tuple(role for role in roles.named().values() if isinstance(role, CheckedRole))


class CheckedRole:
    """What all of them share."""

    def __init__(self, name: str, role: Any) -> None:
        self.role, self.answers = role, Answers(name, role)
        self.needs_truth, self.needs_rules = reads_truth(role), bool(getattr(role, "needs_rules", False))
        self._told_seed = self.needs_truth or is_ours(role)

    def begin_episode(self, seed: int, public_seed: int, iteration: int) -> None:
        """An episode begins. Its seed leads to its start: only who may know that is given it."""
        begin = getattr(self.role, "begin_episode", None)
        if begin is not None:
            begin(seed if self._told_seed else public_seed, iteration)


class CheckedPlanner(CheckedRole):
    """Passes answers on: `read_plan` reads them, and a planner may correct what is not a plan."""

    def plan(self, request: PlanRequest) -> Any:
        """The answer as it is; the words of an error made printable."""
        answer = self.role.plan(request)
        if isinstance(answer, PlanError):
            return replace(answer, problem=_said(answer.problem), more=tuple(_said(text) for text in answer.more))
        return answer


def _said(text: object) -> str:
    return words(text)[:PROBLEM]


class CheckedConditions(CheckedRole):
    """Conditions about this kitchen."""

    def before(self, subtask: Subtask, robot: str, view: View) -> list[Condition]:
        """What must hold before a subtask."""
        return self.answers.conditions("before()", self.role.before(subtask, robot, view), view)

    def after(self, subtask: Subtask, robot: str, view: View) -> list[Condition]:
        """What must hold after it."""
        return self.answers.conditions("after()", self.role.after(subtask, robot, view), view)


class CheckedChecker(CheckedRole):
    """One verdict for each condition."""

    def check(self, conditions: Sequence[Condition], view: View) -> list[Verdict]:
        """In the order of the conditions."""
        asked = tuple(conditions)
        return self.answers.verdicts(self.role.check(list(asked), view), asked)


class CheckedAdjuster(CheckedRole):
    """Advice whose steps this kitchen knows."""

    def adjust(self, request: AdjustRequest) -> Advice:
        """What to do first, and thereafter."""
        return self.answers.advice(self.role.adjust(request), request)


class CheckedReflector(CheckedRole):
    """Lessons that are texts. `review` is there if the role has it."""

    def __init__(self, name: str, role: Any) -> None:
        super().__init__(name, role)
        if getattr(role, "review", None) is not None:
            self.review = self._review

    def reflect(self, request: ReflectRequest) -> list[str]:
        """What a failed pre-check teaches."""
        return self.answers.texts("reflect()", self.role.reflect(request))

    def _review(self, lessons: Sequence[str], *, success: bool) -> list[str]:
        kept = self.role.review(list(lessons), success=success)
        return self.answers.texts("review()", kept, max(MOST_LESSONS, len(lessons)))


class CheckedHandover(CheckedRole):
    """Passes answers on: `read_plan` reads them, and the lead works alone where there is no plan."""

    @property
    def tries_company(self) -> bool:
        """Whether it shares what one robot alone has never brought about, too."""
        return bool(getattr(self.role, "tries_company", False))

    def share(self, request: HandoverRequest) -> Any:
        """The answer as it is."""
        return self.role.share(request)


class CheckedSummariser(CheckedRole):
    """Lines and causes."""

    def summarise(self, goal: str, steps: Sequence[SeenStep]) -> Summary:
        """A line for each step, and one for each that was not tried again."""
        return self.answers.summary(self.role.summarise(goal, list(steps)), steps)

    def explain(self, request: ExplainRequest) -> Explanation:
        """Why an episode failed."""
        view = request.steps[0].before if request.steps else None
        return self.answers.explanation(self.role.explain(request), request, view)
