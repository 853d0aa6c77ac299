"""Looking back on an episode that failed: what happened, which subgoals were met, why it failed - after REFLECT."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from remac_agents.report import Check
from remac_agents.roles import Attempt, ExplainRequest, Explanation, SeenStep, Verdict, last_tries
from remac_agents.running.bookkeeper import When
from remac_agents.running.method_run import MethodRun
from remac_agents.running.moments import Moment, ran_so_far
from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import WAIT, Subtask


def correct(run: MethodRun) -> bool:
    """Ask for one corrected plan from the present state; False when there is no room or no plan left."""
    book, goal = run.book, run.briefing.goal
    if book.rounds >= run.bounds.rounds:
        return False
    summariser = run.roles.summariser
    moments = [(m, robot, step) for m in book.moments for robot, step in m.played.items() if step != WAIT]
    steps = [_seen(run, moment, robot, step) for moment, robot, step in moments]
    summary = summariser.summarise(goal, steps)
    last = last_tries(steps)
    reached = [_reached(run, *moments[index]) for index in last]
    explanation = summariser.explain(
        ExplainRequest(
            goal=goal,
            summary=summary,
            steps=tuple(steps[index] for index in last),
            reached=tuple(reached),
            false_before=lambda index: _false_before(run, *moments[last[index]]),
            plan=book.ledger.initial.as_text(),
        )
    )
    history = [
        Attempt(steps[at].robot, steps[at].subtask, True, reached[n], _cause(explanation, n))
        for n, at in enumerate(last)
    ]
    request = replace(
        run.plan_request((run.briefing.lead,)),
        previous_plan=book.ledger.initial.as_text(),
        history=tuple(history),
        explanation=explanation.reason,
        events=summary.events,
    )
    book.ledger.adjusted = True
    run.change_plan(run.consult(request))
    return not run.finished


def _cause(explanation: Explanation, index: int) -> tuple[Condition, ...]:
    return explanation.false if explanation.step == index else ()


def _seen(run: MethodRun, moment: Moment, robot: str, step: Subtask) -> SeenStep:
    book, role = run.book, run.roles.summariser
    before, after = book.seen_at(moment, "before", role), book.seen_at(moment, "after", role)
    return SeenStep(moment.round, robot, step, before, after)


def _reached(run: MethodRun, moment: Moment, robot: str, step: Subtask) -> bool | None:
    """Whether the checker, shown the moment after the step, finds what the step was to achieve; None: cannot tell."""
    conditions = run.roles.conditions
    wanted = conditions.after(step, robot, run.book.seen_at(moment, "before", conditions))
    found = {verdict.value for verdict in _judged(run, wanted, moment, "after", robot, step)}
    return False if False in found else None if None in found else True


def _false_before(run: MethodRun, moment: Moment, robot: str, step: Subtask) -> tuple[Condition, ...]:
    """The step's pre-conditions that the checker, shown the moment before it, finds false."""
    conditions = run.roles.conditions
    wanted = conditions.before(step, robot, run.book.seen_at(moment, "before", conditions))
    verdicts = _judged(run, wanted, moment, "before", robot, step)
    return tuple(verdict.condition for verdict in verdicts if verdict.value is False)


def _judged(
    run: MethodRun, wanted: Sequence[Condition], moment: Moment, when: When, robot: str, step: Subtask
) -> list[Verdict]:
    """What the checker makes of conditions when it is shown a moment that is past; noted as questions."""
    book, checker, after = run.book, run.roles.checker, when == "after"
    ran = ran_so_far([other for other in book.moments if other.round < moment.round + after])
    verdicts = checker.check(wanted, replace(book.seen_at(moment, when, checker), robot=robot, ran=ran))
    world = moment.world_after if after else moment.world_before
    noted = book.ledger.post_checks if after else book.ledger.pre_checks
    noted += [Check.of(verdict, book.steps, robot, step, book.rules, world, asked=True) for verdict in verdicts]
    return verdicts
