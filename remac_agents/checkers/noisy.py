"""A checker that errs by chance, as vision models do: it flips true verdicts, seeded per episode."""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.checkers.truth import TruthChecker
from remac_agents.roles import Verdict, View
from remac_env.errors import real_number
from remac_env.rules.conditions import Condition
from remac_env.seeding import generator


class NoisyChecker:
    """Flips the truth.

    Args:
        false_alarm: probability that a true condition is called false.
        miss: probability that a false condition is called true.
    """

    needs_truth = needs_rules = True

    def __init__(self, *, false_alarm: float = 0.1, miss: float = 0.1) -> None:
        self.false_alarm = real_number("false_alarm", false_alarm, 0.0, 1.0)
        self.miss = real_number("miss", miss, 0.0, 1.0)
        self._truth = TruthChecker()
        self._chance = generator(0, "noisy checker")

    def begin_episode(self, seed: int, iteration: int) -> None:
        """Draw from here on what this seed and iteration hold."""
        self._chance = generator(seed, "noisy checker", iteration)

    def check(self, conditions: Sequence[Condition], view: View) -> list[Verdict]:
        """One verdict a condition, some of them wrong."""
        return [self._flip(verdict) for verdict in self._truth.check(conditions, view)]

    def _flip(self, verdict: Verdict) -> Verdict:
        if verdict.value is None:
            return verdict
        rate = self.false_alarm if verdict.value else self.miss
        wrong = self._chance.random() < rate
        return Verdict(verdict.condition, verdict.value != wrong, "a flipped verdict" if wrong else "")
