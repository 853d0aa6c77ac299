"""The checker that knows: every verdict is the truth."""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.roles import Verdict, View
from remac_agents.roles.free_text import truth_of
from remac_env.rules.conditions import Condition

UNMATCHED = "no sentence of the skill table says the same, and only a model can judge these words"


class TruthChecker:
    """Reads the WorldState. Of what a model put into words of its own it cannot tell."""

    needs_truth = needs_rules = True

    def check(self, conditions: Sequence[Condition], view: View) -> list[Verdict]:
        """One true verdict a condition, None on words that match none.

        Raises:
            ValueError: if it was not given the world.
        """
        if view.world is None:
            raise ValueError(
                "the truth checker was not given the WorldState; infos[robot]['world'] is missing"
            )
        found = [(condition, truth_of(condition, view.rules, view.world)) for condition in conditions]
        return [Verdict(c, truth, UNMATCHED if truth is None else "") for c, truth in found]
