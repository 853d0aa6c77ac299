"""CAPE: corrective planning step by step. A step whose pre-conditions fail is asked for again, with the cause.

The published method scores samples by their log-probabilities; chat endpoints have none, so the answer itself counts.
"""

from __future__ import annotations

from collections.abc import Callable

from remac_agents.running.method_run import Episode, Turns
from remac_agents.running.stepwise import Stepwise, Told


def cape(told: Told) -> Callable[[Episode], Turns]:
    """The method by what the planner is told of a failed pre-condition; see `remac_agents.running.stepwise`."""

    def run(episode: Episode) -> Turns:
        steps = Stepwise(episode, told)
        while steps.find_next():
            yield episode.turn
            steps.note_outcome()

    return run
