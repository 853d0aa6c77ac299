"""The checker that knows: every verdict is the truth."""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.roles import Verdict, View
from remac_agents.roles.free_text import truth_of
from remac_env.rules.conditions import Condition

UNSEEN = "nobody has seen it yet"
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
        return [_verdict(condition, view) for condition in conditions]


def _verdict(condition: Condition, view: View) -> Verdict:
    """The truth, but of what nobody has seen: it is not seen in its place, and more cannot be told."""
    if condition.kind != "felt" and set(condition.args) & set(view.unseen):
        return Verdict(condition, False if condition.predicate == "placed" else None, UNSEEN)
    truth = truth_of(condition, view.rules, view.world)
    return Verdict(condition, truth, UNMATCHED if truth is None else "")
