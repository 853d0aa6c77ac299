"""What the memory keeps of an episode."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from remac_agents.memory import Run
from remac_agents.plan import Plan
from remac_agents.report import Check
from remac_agents.running.ledger import Ledger
from remac_agents.running.method_run import MethodRun
from remac_agents.running.moments import ran_so_far


def remembered(run: MethodRun, *, success: bool) -> Run:
    """The episode as the memory keeps it."""
    ledger: Ledger = run.book.ledger
    initial: Plan = ledger.initial
    return Run(
        task_description=run.briefing.task,
        task_goal=run.briefing.goal,
        initial_plan={robot: list(row) for robot, row in initial.as_text().items()},
        action_list=[ran.line for ran in ran_so_far(run.book.moments)],
        pre_check_results=[_checked(check) for check in ledger.pre_checks if not check.asked],
        post_check_results=[_checked(check) for check in ledger.post_checks],
        success=success,
        reflection=list(ledger.reflections),
    )


def _checked(check: Check) -> dict[str, Any]:
    """A check as the memory keeps it: without the truth, which the agent is not to learn from."""
    kept = ("round", "robot", "subtask", "condition", "verdict")
    return {name: value for name, value in asdict(check).items() if name in kept}
