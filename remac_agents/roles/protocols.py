"""One small protocol for each role, and the roles of a method together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from remac_agents.plan import Plan, PlanError
from remac_agents.roles.requests import (
    AdjustRequest,
    Advice,
    HandoverRequest,
    PlanRequest,
    ReflectRequest,
    Verdict,
    View,
)
from remac_agents.roles.summaries import ExplainRequest, Explanation, SeenStep, Summary
from remac_env.errors import RemacError
from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import Subtask


class StopEpisode(RemacError, RuntimeError):
    """Raised by a role that cannot go on: the method ends the episode, and the report says why.

    `infrastructure`: the agent is not to blame (an endpoint is down), so that the episode counts for nothing.
    """

    def __init__(self, why: str, *, infrastructure: bool = False) -> None:
        super().__init__(why)
        self.infrastructure = infrastructure


@runtime_checkable
class Planner(Protocol):
    """Makes the plan of an episode."""

    def plan(
        self, request: PlanRequest
    ) -> Plan | PlanError | Mapping[str, Sequence[str]] | Sequence[str] | str:
        """A plan, or anything that `read_plan` reads."""


@runtime_checkable
class Conditions(Protocol):
    """Says what should be true before and after a subtask."""

    def before(self, subtask: Subtask, robot: str, view: View) -> list[Condition]:
        """What must hold for `robot` to run `subtask` now."""

    def after(self, subtask: Subtask, robot: str, view: View) -> list[Condition]:
        """What must hold once it has been run; `view` is the moment before it."""


@runtime_checkable
class Checker(Protocol):
    """Judges conditions."""

    def check(self, conditions: Sequence[Condition], view: View) -> list[Verdict]:
        """One verdict a condition, in order."""


@runtime_checkable
class Adjuster(Protocol):
    """Repairs a plan whose next subtask is not ready."""

    def adjust(self, request: AdjustRequest) -> Advice:
        """What to do first, and the plan thereafter."""


@runtime_checkable
class Reflector(Protocol):
    """Puts into words what a failed pre-check teaches.

    It may also have `review(lessons, *, success) -> list[str]`: at the end of the episode, which of its
    lessons to keep.
    """

    def reflect(self, request: ReflectRequest) -> list[str]:
        """Lessons for the next iteration; may be none."""


@runtime_checkable
class Handover(Protocol):
    """Shares a proven single-robot plan between the robots of a team."""

    def share(self, request: HandoverRequest) -> Plan | None:
        """A plan with a row for each of the two, or None when there is no better way than working alone."""


@runtime_checkable
class Summariser(Protocol):
    """Tells what happened, and why it went wrong."""

    def summarise(self, goal: str, steps: Sequence[SeenStep]) -> Summary:
        """The steps, every try of them, as events and subgoals."""

    def explain(self, request: ExplainRequest) -> Explanation:
        """The cause: a subgoal that was not met (execution), or a plan that could not work (planning)."""


@dataclass(frozen=True)
class Roles:
    """A method's roles, filled: `planner`, `conditions`, `checker`, `adjuster`, `reflector`, `handover` and
    `summariser`, each by a value that has the method of its protocol above."""

    planner: Planner
    conditions: Conditions
    checker: Checker
    adjuster: Adjuster
    reflector: Reflector
    handover: Handover
    summariser: Summariser

    def named(self) -> dict[str, object]:
        """Role -> who fills it."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}
