"""REMAC: RE by one robot until it has mastered the task; then a second one takes over what can be shared."""

from __future__ import annotations

from remac_agents.methods.cc import checked
from remac_agents.plan import PlanError, read_plan
from remac_agents.planning.mastery import proven_plan
from remac_agents.roles import HandoverRequest
from remac_agents.running.method_run import Episode, Turns
from remac_env.rules.subtasks import Subtask


def remac(episode: Episode) -> Turns:
    """One iteration, alone or, once the task is mastered alone, as a team."""
    episode.recall()
    told, runs = episode.briefing, episode.memory.runs(episode.briefing.task)
    single = proven_plan(runs, episode.commands, episode.rules, last=told.last)
    if told.helper is None or single is None or not hand_over(episode, single, told.helper):
        episode.make_plan()
    yield from checked(episode)


def hand_over(episode: Episode, single: tuple[Subtask, ...], helper: str) -> bool:
    """Share a proven plan with the helper; False when no way to share it was found."""
    told, view = episode.briefing, episode.seen_by(episode.roles.handover)
    request = HandoverRequest(told.goal, single, told.lead, helper, episode.lessons, told.commands, view)
    reply = episode.roles.handover.share(request)
    plan = (
        PlanError("none was found")
        if reply is None
        else read_plan(reply, episode.commands, (told.lead, helper), told.lead)
    )
    if isinstance(plan, PlanError):
        episode.ledger.errors.append(f"hand-over: {plan.problem}")
        return False
    episode.adopt(plan)
    return True
