"""Conditions straight from the skill table."""

from __future__ import annotations

from remac_agents.roles import View
from remac_env.rules.claims import settled
from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import Subtask


class RuleConditions:
    """The table's requirements of all three marks before, and what the skill achieves after."""

    needs_truth, needs_rules = False, True

    def before(self, subtask: Subtask, robot: str, view: View) -> list[Condition]:
        """What the table requires, in its order."""
        wanted = [requirement.condition for requirement in subtask.requirements(robot)]
        return [condition for condition in wanted if condition.predicate not in settled()]

    def after(self, subtask: Subtask, robot: str, view: View) -> list[Condition]:
        """What the table says the skill achieves, given what the robot held before."""
        return list(subtask.achieves(robot, view.holding.get(robot)))
