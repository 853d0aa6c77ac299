"""The checker that does not look: everything is said to be true."""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.roles import Verdict, View
from remac_env.conditions import Condition


class NoChecker:
    """Never finds anything wrong."""

    needs_truth = False

    def check(self, conditions: Sequence[Condition], view: View) -> list[Verdict]:
        """True, for every condition."""
        return [Verdict(condition, True, "not looked at") for condition in conditions]
