"""human: who plans is asked again whenever a plan has ended or a subtask failed, as a person at play wants to be."""

from __future__ import annotations

from remac_agents.running.method_run import MethodRun, Turns


def human(run: MethodRun) -> Turns:
    """Play plans, long ones or single steps, until an empty one comes; what is left after a failure is dropped."""
    while run.book.rounds < run.bounds.rounds:
        plan = run.consult(run.plan_request(run.briefing.robots))
        if not plan.length:
            return
        if run.book.rounds:
            run.change_plan(plan)
        else:
            run.adopt(plan)
        while not run.finished:
            yield run.turn
            failed = any(report is not None and report.status != "success" for report in run.book.view.reports.values())
            run.advance()
            if failed:
                break
