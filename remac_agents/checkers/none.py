"""The checker that does not look."""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.roles import Verdict, View
from remac_env.rules.conditions import Condition


class NoChecker:
    """Never finds anything wrong, and says that it cannot tell."""

    needs_truth = needs_rules = False

    def check(self, conditions: Sequence[Condition], view: View) -> list[Verdict]:
        """No verdict on any condition."""
        return [Verdict(condition, None, "not looked at") for condition in conditions]
