"""REMAC: RE by one robot until it has mastered the task; then the others take over what can be shared.

So they do where one robot is too slow: nothing was wrong with its plan but that the time was up before its end. And
where one robot cannot do it: what it does comes undone as soon as it leaves, as doors that fall shut, and the helper
stays there; or something never comes about, and the helper stands by elsewhere: with rounds, in the last iteration.
By the event clock what a helper has prepared is an event: whoever needs it goes on then, and nobody waits for a round.
"""

from __future__ import annotations

from remac_agents.methods.cc import checked
from remac_agents.plan import PlanError, read_plan
from remac_agents.planning.mastery import late_plan, proven_plan, unaided_plan, unkept_plan
from remac_agents.roles import HandoverRequest
from remac_agents.running.method_run import MethodRun, Turns
from remac_agents.running.unfolding import unfolded
from remac_env.rules.subtasks import Subtask


def remac(run: MethodRun) -> Turns:
    """One iteration, alone or, once the task is mastered alone, as a team."""
    run.recall()
    told = run.briefing
    if told.helper is None or not hand_over(run, told.helper):
        run.make_plan()
    yield from unfolded(run) if run.by_events else checked(run)


def hand_over(run: MethodRun, helper: str) -> bool:
    """Share with the helper, and those beyond, what works alone or wants company; False where nothing is shared."""
    told, view, runs = run.briefing, run.book.seen_by(run.roles.handover), run.memory.runs(run.briefing.task)
    kept: tuple[Subtask, ...] = ()
    failing: tuple[Subtask, ...] = ()
    single = proven_plan(runs, run.commands, run.book.rules, last=told.last)
    if single is None and run.by_events:
        single = late_plan(runs, run.commands)
    company = told.last and getattr(run.roles.handover, "tries_company", False)
    if single is None and (run.by_events or company):
        single, kept = unkept_plan(runs, run.commands) or (None, ())
    if single is None and company:
        single, failing = unaided_plan(runs, run.commands) or (None, ())
    if single is None:
        return False
    untried = told.last and not any(len(r.initial_plan) > 1 and r.success for r in runs)
    request = HandoverRequest(
        told.goal, single, told.lead, helper, run.lessons, told.commands, view, told.helpers, untried=untried,
        kept=kept, failing=failing,
    )
    reply = run.roles.handover.share(request)
    plan = (
        PlanError("none was found")
        if reply is None
        else read_plan(reply, run.commands, request.team, told.lead)
    )
    if isinstance(plan, PlanError):
        run.book.ledger.errors.append(f"hand-over: {plan.problem}")
        return False
    run.adopt(plan)
    return True
