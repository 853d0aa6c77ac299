"""The scripted controller: the kitchen's own motions, planned anew for each subtask."""

from __future__ import annotations

from collections.abc import Generator

from remac_env.backends.physics.controllers.base import Command, Sensing
from remac_env.backends.physics.controllers.scripted.dispatch import motion
from remac_env.backends.physics.controllers.scripted.motion import Steps, StuckError
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import Subtask


class Scripted:
    """Carries out every skill but drives, which are planned for all robots together."""

    def __init__(self, here: Workspace, rules: Rules) -> None:
        self._here, self._rules = here, rules

    def run(self, subtask: Subtask, sensing: Sensing) -> Generator[Command, None, Outcome]:
        """See :class:`remac_env.backends.physics.controllers.base.Controller`."""
        self._here.clear.planner.random = sensing.random
        steps = motion(self._here, self._rules, sensing.told, sensing.name, subtask)
        return (yield from ended(self._here, steps))


def ended(here: Workspace, steps: Steps) -> Generator[Command, None, Outcome]:
    """The same commands; failures become outcomes."""
    try:
        yield from steps
    except SkillFailure as failed:
        return failure(failed.reason, failed.detail)
    except StuckError as stuck:
        here.robot.q = here.robot.measured
        return failure("blocked", str(stuck))
    return Outcome("success")
