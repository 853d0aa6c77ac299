"""Controllers from elsewhere, guarded: whatever they do, their subtask ends with an outcome."""

from __future__ import annotations

from collections.abc import Generator

from remac_env.backends.physics.controllers.base import Command, Controller, Sensing
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import Subtask

_LONGEST = 200  # characters of what an exception says


def guarded(controller: Controller, subtask: Subtask, sensing: Sensing) -> Generator[Command, None, Outcome]:
    """Run a controller; where it raises, or returns what is no outcome, it has failed."""
    who = type(controller).__name__
    try:
        outcome = yield from controller.run(subtask, sensing)
    except Exception as error:  # noqa: BLE001 - it may raise anything, and the other robot goes on all the same
        return failure("invalid", f"the controller {who} raised {type(error).__name__}: {error}"[:_LONGEST])
    if not isinstance(outcome, Outcome):
        return failure("invalid", f"the controller {who} returned {type(outcome).__name__}; valid: Outcome")
    return outcome
