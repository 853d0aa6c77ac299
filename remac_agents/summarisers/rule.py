"""Summaries and explanations by rule: what was run, how it was reported, what the grippers felt."""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.roles import ExplainRequest, Explanation, SeenStep, Summary, last_tries
from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import Subtask


class RuleSummariser:
    """Sees no more than planners do: reports and grippers. Why a step failed it has the checker look up."""

    needs_truth, needs_rules = False, True

    def summarise(self, goal: str, steps: Sequence[SeenStep]) -> Summary:
        """One line an event, and the same with the step as the subgoal."""
        events = tuple(_event(step) for step in steps)
        lines = [f"Goal: {steps[index].subtask.text}. {events[index]}" for index in last_tries(steps)]
        return Summary(events, tuple(lines))

    def explain(self, request: ExplainRequest) -> Explanation:
        """The first subgoal that was not met, else the first step that should not have been run as it was."""
        if False in request.reached:
            index = request.reached.index(False)
            return _execution(request, index, request.false_before(index))
        for index, step in enumerate(request.steps):
            false = tuple(c for c in request.false_before(index) if not _already_done(step, c))
            if false:
                told = f'the plan is wrong: before "{step.subtask.text}" it was not true that {_list(false)}'
                return Explanation(told, index, false)
        if None in request.reached:
            return Explanation("the goal is not reached, and of some steps nobody can tell whether they did their part")
        return Explanation("every step did what it was to do, but the goal is not reached: steps are missing")


def _execution(request: ExplainRequest, index: int, false: tuple[Condition, ...]) -> Explanation:
    text = request.steps[index].subtask.text
    if not false:
        return Explanation(f'"{text}" slipped: it was ready to be run, but did not do what it was to do', index)
    return Explanation(f'"{text}" failed: before it, it was not true that {_list(false)}', index, false)


def _already_done(step: SeenStep, condition: Condition) -> bool:
    reasons = {r.condition: r.reason for r in step.subtask.requirements(step.robot)}
    return reasons.get(condition) == "already_done"


def _list(conditions: Sequence[Condition]) -> str:
    return "; ".join(condition.sentence for condition in conditions)


def _event(step: SeenStep) -> str:
    report = step.after.reports.get(step.robot)
    status = "nobody reported how it ended" if report is None else f"reported {report.status}"
    why = f" ({report.reason})" if report is not None and report.reason else ""
    held = step.after.holding.get(step.robot)
    feels = f"its gripper holds the {held}" if held else "its gripper is empty"
    return f"Round {step.round + 1}. {step.robot} ran {_quoted(step.subtask)}: {status}{why}; {feels}."


def _quoted(subtask: Subtask) -> str:
    return f'"{subtask.text}"'
