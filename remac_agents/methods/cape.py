"""CAPE: corrective planning step by step. A step whose pre-conditions fail is asked for again, with the cause.

The published method scores samples by their log-probabilities; chat endpoints have none, so the answer itself counts.
"""

from __future__ import annotations

from collections.abc import Callable

from remac_agents.running.method_run import MethodRun, Turns
from remac_agents.running.stepwise import Reprompt, Stepwise


def cape(told: Reprompt) -> Callable[[MethodRun], Turns]:
    """The method by what the planner is told of a failed pre-condition; see `remac_agents.running.stepwise`."""

    def stepwise(run: MethodRun) -> Turns:
        steps = Stepwise(run, told)
        while steps.find_next():
            yield run.turn
            steps.note_outcome()

    return stepwise
