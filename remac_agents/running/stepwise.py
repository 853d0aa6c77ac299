"""Planning one step at a time, as CAPE does it: what a refused step is answered with, and where it ends."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from remac_agents.plan import Plan, PlanError
from remac_agents.roles import Attempt
from remac_agents.running.checks import check_before
from remac_agents.running.method_run import MethodRun
from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import DONE, WAIT, Subtask

Reprompt = Literal["explicit", "implicit", "success", "resample"]
"""What the planner hears of a refused step: its cause, typed; the step alone; that it failed; nothing."""

ASKED_PER_STEP = 2
"""The planner is asked at most this many times the bound on rounds, all steps together."""


class Stepwise:
    """The steps of one episode, asked for one by one. A refused step is not run and not checked afterwards."""

    def __init__(self, run: MethodRun, told: Reprompt) -> None:
        self._run, self._told = run, told
        self._robot = run.briefing.lead
        self._history: list[Attempt] = []
        self._left = ASKED_PER_STEP * run.bounds.rounds

    def find_next(self) -> bool:
        """Put a step whose pre-conditions hold into the plan; False when the planner or the bound ends it."""
        run, problem = self._run, ""
        while self._left > 0 and run.book.rounds < run.bounds.rounds:
            step = self._ask(problem)
            if isinstance(step, PlanError) or step == DONE:
                break
            run.change_plan(Plan.of({self._robot: [step]}))
            failed = check_before(run).get(self._robot)
            if failed is None:
                return True
            problem = self._refuse(step, failed)
        run.change_plan(Plan.of({}))
        return False

    def note_outcome(self) -> None:
        """The step was run: it is part of the plan, and the planner hears how it was reported to end."""
        (step,) = self._run.plan.row(self._robot)
        report = self._run.book.view.reports.get(self._robot)
        succeeded = None if report is None else report.status == "success"
        reason = None if report is None else report.reason
        self._history.append(Attempt(self._robot, step, True, succeeded, reason=reason))
        self._run.advance()

    def _ask(self, problem: str) -> Subtask | PlanError:
        run = self._run
        request = replace(
            run.plan_request((self._robot,)),
            failure=problem,
            refusal=problem,
            history=tuple(self._history),
            single_step=True,
        )
        unusable = len(run.book.ledger.errors)
        plan = run.answer_to(request, most=self._left)
        self._left -= len(run.book.ledger.errors) - unusable + isinstance(plan, Plan)
        if isinstance(plan, PlanError):
            return plan
        # A robot that works alone has nobody to wait for: an answer of waits alone ends the run.
        return next((step for step in plan.row(self._robot) if step != WAIT), DONE)

    def _refuse(self, step: Subtask, failed: tuple[Condition, ...]) -> str:
        """Note a refused step; returns what its planner is told before it is asked again."""
        self._run.book.ledger.adjusted = True
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
