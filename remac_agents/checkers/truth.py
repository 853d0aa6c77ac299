"""The checker that knows: every verdict is the truth."""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.roles import Verdict, View
from remac_env.conditions import Condition


class TruthChecker:
    """Reads the WorldState."""

    needs_truth = True

    def check(self, conditions: Sequence[Condition], view: View) -> list[Verdict]:
        """One true verdict a condition.

        Raises:
            ValueError: if it was not given the world.
        """
        if view.world is None:
            raise ValueError(
                "the truth checker was not given the WorldState; infos[robot]['world'] is missing"
            )
        return [Verdict(condition, condition.holds(view.scene, view.world)) for condition in conditions]
