"""Looking back on an episode that failed: what happened, which subgoals were met, why it failed - after REFLECT."""

from __future__ import annotations

from dataclasses import replace

from remac_agents.report import Check
from remac_agents.roles import Attempt, ExplainRequest, Explanation, Ran, SeenStep, last_tries
from remac_agents.running.asking import ran_so_far
from remac_agents.running.method_run import Episode
from remac_agents.running.moments import Moment, shown
from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import WAIT, Subtask


def correct(episode: Episode) -> bool:
    """Ask for one corrected plan from the present state; False when there is no room or no plan left."""
    if episode.rounds >= episode.bounds.rounds:
        return False
    summariser = episode.roles.summariser
    moments = [(m, robot, step) for m in episode.moments for robot, step in m.played.items() if step != WAIT]
    steps = [_seen(episode, moment, robot, step) for moment, robot, step in moments]
    summary = summariser.summarise(episode.briefing.goal, steps)
    last = last_tries(steps)
    reached = [_reached(episode, *moments[index]) for index in last]
    explanation = summariser.explain(
        ExplainRequest(
            goal=episode.briefing.goal,
            summary=summary,
            steps=tuple(steps[index] for index in last),
            reached=tuple(reached),
            false_before=lambda index: _false_before(episode, *moments[last[index]]),
            plan=episode.ledger.initial.as_text(),
        )
    )
    history = [
        Attempt(steps[at].robot, steps[at].subtask, True, reached[n], _cause(explanation, n))
        for n, at in enumerate(last)
    ]
    request = replace(
        episode.plan_request((episode.briefing.lead,)),
        previous_plan=episode.ledger.initial.as_text(),
        history=tuple(history),
        explanation=explanation.reason,
        events=summary.events,
    )
    episode.ledger.adjusted = True
    episode.change_plan(episode.consult(request))
    return not episode.finished


def _cause(explanation: Explanation, index: int) -> tuple[Condition, ...]:
    return explanation.false if explanation.step == index else ()


def _seen(episode: Episode, moment: Moment, robot: str, step: Subtask) -> SeenStep:
    role = episode.roles.summariser
    before = shown(moment.before, episode.rules, moment.world_before, role)
    return SeenStep(moment.round, robot, step, before, shown(moment.after, episode.rules, moment.world_after, role))


def _reached(episode: Episode, moment: Moment, robot: str, step: Subtask) -> bool | None:
    """Whether the checker, shown the moment after the step, finds what the step was to achieve; None: cannot tell."""
    roles = episode.roles
    view = shown(moment.before, episode.rules, moment.world_before, roles.conditions)
    wanted = roles.conditions.after(step, robot, view)
    judged = shown(moment.after, episode.rules, moment.world_after, roles.checker)
    judged = replace(judged, robot=robot, ran=_ran_until(episode, moment.round + 1))
    verdicts = roles.checker.check(wanted, judged)
    for verdict in verdicts:
        rules, world = episode.rules, moment.world_after
        entry = Check.of(verdict, episode.rounds, robot, step, rules, world, asked=True)
        episode.ledger.post_checks.append(entry)
    found = {verdict.value for verdict in verdicts}
    return False if False in found else None if None in found else True


def _ran_until(episode: Episode, rounds: int) -> tuple[Ran, ...]:
    """The commands of an episode's first rounds."""
    return ran_so_far([moment for moment in episode.moments if moment.round < rounds])


def _false_before(episode: Episode, moment: Moment, robot: str, step: Subtask) -> tuple[Condition, ...]:
    """The step's pre-conditions that the checker, shown the moment before it, finds false."""
    roles = episode.roles
    seen = shown(moment.before, episode.rules, moment.world_before, roles.conditions)
    wanted = roles.conditions.before(step, robot, seen)
    judged = shown(moment.before, episode.rules, moment.world_before, roles.checker)
    judged = replace(judged, robot=robot, ran=_ran_until(episode, moment.round))
    verdicts = roles.checker.check(wanted, judged)
    for verdict in verdicts:
        rules, world = episode.rules, moment.world_before
        entry = Check.of(verdict, episode.rounds, robot, step, rules, world, asked=True)
        episode.ledger.pre_checks.append(entry)
    return tuple(verdict.condition for verdict in verdicts if verdict.value is False)
