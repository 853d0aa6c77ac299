"""Planning one step at a time, as CAPE does it: what a refused step is answered with, and where it ends."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from remac_agents.plan import Plan, PlanError
from remac_agents.roles import Attempt
from remac_agents.running.method_run import Episode
from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import DONE, WAIT, Subtask

Told = Literal["explicit", "implicit", "success", "resample"]
"""What the planner hears of a refused step: its cause, typed; the step alone; that it failed; nothing."""

ASKED_PER_STEP = 2
"""The planner is asked at most this many times the bound on rounds, all steps together."""


class Stepwise:
    """The steps of one episode, asked for one by one. A refused step is not run and not checked afterwards."""

    def __init__(self, episode: Episode, told: Told) -> None:
        self._episode, self._told = episode, told
        self._robot = episode.briefing.lead
        self._history: list[Attempt] = []
        self._left = ASKED_PER_STEP * episode.bounds.rounds

    def find_next(self) -> bool:
        """Put a step whose pre-conditions hold into the plan; False when the planner or the bound ends it."""
        episode, problem = self._episode, ""
        while self._left > 0 and episode.rounds < episode.bounds.rounds:
            step = self._ask(problem)
            if isinstance(step, PlanError) or step == DONE:
                break
            episode.change_plan(Plan.of({self._robot: [step]}))
            failed = episode.check_before().get(self._robot)
            if failed is None:
                return True
            problem = self._refuse(step, failed)
        episode.change_plan(Plan.of({}))
        return False

    def note_outcome(self) -> None:
        """The step was run: it is part of the plan, and the planner hears how it was reported to end."""
        (step,) = self._episode.plan.row(self._robot)
        report = self._episode.view.reports.get(self._robot)
        succeeded = None if report is None else report.status == "success"
        reason = None if report is None else report.reason
        self._history.append(Attempt(self._robot, step, True, succeeded, reason=reason))
        self._episode.advance()

    def _ask(self, problem: str) -> Subtask | PlanError:
        episode = self._episode
        request = replace(
            episode.plan_request((self._robot,)),
            failure=problem,
            refusal=problem,
            history=tuple(self._history),
            single_step=True,
        )
        unusable = len(episode.ledger.errors)
        plan = episode.answer_to(request, most=self._left)
        self._left -= len(episode.ledger.errors) - unusable + isinstance(plan, Plan)
        if isinstance(plan, PlanError):
            return plan
        # A robot that works alone has nobody to wait for: an answer of waits alone ends the episode.
        return next((step for step in plan.row(self._robot) if step != WAIT), DONE)

    def _refuse(self, step: Subtask, failed: tuple[Condition, ...]) -> str:
        """Note a refused step; returns what its planner is told before it is asked again."""
        self._episode.ledger.adjusted = True
        if self._told == "resample":
            return ""
        cause = failed if self._told == "explicit" else ()
        self._history.append(Attempt(self._robot, step, False, False, cause))
        if self._told == "success":
            return "Error: the task failed. A correct step would be to"
        why = f": {typed(step, self._robot, failed)}" if cause else ""
        return f"Error: I cannot {step.text}{why}. A correct step would be to"


def typed(step: Subtask, robot: str, failed: tuple[Condition, ...]) -> str:
    """False conditions as "reason (not true: sentence)", with the reason that the skill table gives."""
    reasons = {requirement.condition: requirement.reason for requirement in step.requirements(robot)}
    return "; ".join(f"{reasons.get(c, 'invalid')} (not true: {c.sentence})" for c in failed)
