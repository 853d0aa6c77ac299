"""The checks around a plan: conditions before and after each subtask, and what follows from those that are false."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from remac_agents.roles import AdjustRequest, Advice, ReflectRequest, View
from remac_agents.running.method_run import MethodRun
from remac_agents.running.moments import ran_so_far
from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import WAIT, Subtask


def check_before(run: MethodRun) -> dict[str, tuple[Condition, ...]]:
    """Robot -> pre-conditions of its next subtask that are found false; none where it is ready."""
    book, roles = run.book, run.roles
    failed: dict[str, tuple[Condition, ...]] = {}
    for robot, subtask in run.turn.items():
        if subtask == WAIT or robot in run.state.accepted:
            continue
        conditions = roles.conditions.before(subtask, robot, book.seen_by(roles.conditions))
        verdicts = book.judge(roles.checker, robot, conditions)
        book.note("before", robot, subtask, verdicts)
        wrong = tuple(condition for condition, verdict in verdicts.items() if verdict.value is False)
        if wrong:
            failed[robot] = wrong
    return failed


def adjust(run: MethodRun, failed: Mapping[str, tuple[Condition, ...]]) -> None:
    """Let the adjuster change the rest of one robot's row; or else the subtask is tried as it is."""
    robot = min(failed)  # by name; the others' turn comes when the pre-conditions are checked again
    subtask = run.turn[robot]
    if run.state.adjustments >= run.bounds.adjustments:
        run.state = run.state.accepting(robot)
        return
    run.state = replace(run.state, adjustments=run.state.adjustments + 1)
    advice = run.roles.adjuster.adjust(_request(run, robot, subtask, failed[robot]))
    old = run.plan.row(robot)
    row = (*advice.next_steps, *old) if advice.row is None else advice.row
    row = tuple(step for step in row if run.commands.allows(step))
    if row == old:
        run.state = run.state.accepting(robot)
    else:
        _replace_row(run, robot, row)
    if run.reflecting and robot not in run.state.slipped:
        _reflect(run, robot, subtask, failed[robot], advice)


def check_after(run: MethodRun) -> None:
    """Check what was run; a robot whose post-conditions are found false tries again, at most `retries` times."""
    book, conditions = run.book, run.roles.conditions
    worked, slipped = set[str](), set[str]()
    for robot, subtask in run.turn.items():
        before = book.seen_at(book.moments[-1], "before", conditions)
        (slipped if found_false_after(run, robot, subtask, before) else worked).add(robot)
    run.state = run.state.tried(worked=worked, slipped=slipped)
    if not run.state.pending or (run.state.tries > run.bounds.retries and not _leave_refused_behind(run)):
        run.advance()


def found_false_after(run: MethodRun, robot: str, subtask: Subtask, before: View) -> bool:
    """Whether a post-condition of what a robot has run is found false. `before`: what was seen when it began."""
    verdicts = run.book.judge(run.roles.checker, robot, run.roles.conditions.after(subtask, robot, before))
    run.book.note("after", robot, subtask, verdicts)
    return any(verdict.value is False for verdict in verdicts.values())


def _request(run: MethodRun, robot: str, subtask: Subtask, failed: tuple[Condition, ...]) -> AdjustRequest:
    book, roles = run.book, run.roles

    def ask(condition: Condition) -> bool | None:
        verdicts = book.judge(roles.checker, robot, [condition])
        book.note("before", robot, subtask, verdicts, asked=True)
        return verdicts[condition].value

    return AdjustRequest(
        failed=failed,
        subtask=subtask,
        robot=robot,
        plan=run.plan,
        executed=tuple(played[robot] for played in book.ledger.finished if robot in played),
        commands=run.briefing.commands,
        view=book.seen_by(roles.adjuster),
        ask=ask,
        ran=ran_so_far(book.moments),
        previous=run.previous,
    )


def _replace_row(run: MethodRun, robot: str, row: Sequence[Subtask]) -> None:
    """A new row; what other robots have done of this round already is closed as a round of its own."""
    ledger, through = run.book.ledger, run.state.through
    ledger.adjusted = True
    if through:
        ledger.close_round(through)
    ledger.current_done.clear()
    run.state = run.state.with_row(robot, row)


def _reflect(run: MethodRun, robot: str, subtask: Subtask, failed: tuple[Condition, ...], advice: Advice) -> None:
    book, reflector = run.book, run.roles.reflector
    held, seen = book.view.holding.get(robot), book.seen_by(reflector)
    request = ReflectRequest(run.briefing.goal, failed, subtask, robot, held, advice, seen)
    book.ledger.reflections += reflector.reflect(request)


def _leave_refused_behind(run: MethodRun) -> bool:
    """Where only drives are still refused, the others go on. False where none can."""
    rest = run.state.past_refused_drives()
    if rest is None:
        return False
    run.book.ledger.close_round(run.state.through)
    run.change_plan(rest)
    return True
