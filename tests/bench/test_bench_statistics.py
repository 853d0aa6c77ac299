"""Intervals and tests against published worked examples."""

from __future__ import annotations

import math
import random
from itertools import product
from statistics import NormalDist

import pytest
from remac_bench.judging.statistics import cluster_bootstrap, holm, problems_to_separate, sign_flip, wilson


@pytest.mark.parametrize(
    ("successes", "n", "low", "high"),
    [
        (81, 263, 0.2553, 0.3662),  # Newcombe 1998, table I, method 3
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_wilson_gives_newcombes_table(successes: int, n: int, low: float, high: float) -> None:
    assert [round(bound, 4) for bound in wilson(successes, n)] == [low, high]


def alone(first: int, second: int) -> float:
    """The test where every problem has one episode: McNemar's."""
    return sign_flip([1] * first + [-1] * second)


def test_over_single_episodes_the_sign_flip_test_is_mcnemars() -> None:
    assert alone(121, 59) == pytest.approx(4.434444987810149e-06)  # statsmodels' and mlxtend's worked example
    assert alone(59, 121) == pytest.approx(alone(121, 59))
    assert alone(10, 2) == pytest.approx(2 * (1 + 12 + 66) / 4096)
    assert (alone(0, 0), alone(5, 5), alone(1, 0)) == (1.0, 1.0, 1.0)
    assert alone(6, 0) == pytest.approx(2 / 64)
    assert alone(4000, 0) == 0.0  # too small for a float


def test_the_sign_flip_test_counts_all_signs() -> None:
    differences = [7, -2, 3, 3, 0, 1]
    sums = [sum(s * d for s, d in zip(signs, differences, strict=True)) for signs in product((1, -1), repeat=6)]
    assert sign_flip(differences) == pytest.approx(sum(abs(value) >= 12 for value in sums) / len(sums))
    assert sign_flip([10] * 4) == pytest.approx(2 / 16), "forty episodes of four problems are four problems"


def test_equal_agents_are_not_told_apart_by_episodes_that_are_alike() -> None:
    """Two agents of the same strength, 12 problems with ten episodes each that all go alike: 5% at most."""
    dice, found = random.Random(7), 0
    for _ in range(400):
        found += sign_flip([10 * dice.choice((-1, 0, 1)) for _ in range(12)]) < 0.05
    assert found <= 0.05 * 400
    by_episodes = 0
    for _ in range(400):
        signs = [dice.choice((-1, 0, 1)) for _ in range(12)]
        by_episodes += sign_flip([sign for sign in signs for _ in range(10)]) < 0.05
    assert by_episodes > 0.3 * 400, "the wrong unit, episodes, would have been found out"


def test_holm_gives_published_values_in_the_order_of_the_question() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.01, 0.02, 0.03, 0.04, 0.05]) == pytest.approx([0.05, 0.08, 0.09, 0.09, 0.09])  # as R's p.adjust
    assert holm([0.9, 0.8]) == [1.0, 1.0]
    assert holm([]) == []


def test_the_bootstrap_is_the_same_each_time_and_knows_clusters() -> None:
    differences, counts = [2.0, 0.0, 1.0, 3.0, -1.0, 2.0], [4, 4, 4, 4, 4, 4]
    first = cluster_bootstrap(differences, counts, name="a against b")
    assert first == cluster_bootstrap(differences, counts, name="a against b")
    assert first is not None
    # The means of clusters are 0.5, 0, 0.25, 0.75, -0.25, 0.5: mean 0.292, standard error 0.143 (population).
    assert first[0] == pytest.approx(0.292 - 1.96 * 0.143, abs=0.06)
    assert first[1] == pytest.approx(0.292 + 1.96 * 0.143, abs=0.06)
    alike = cluster_bootstrap([1.0] * 24, [1] * 24, name="x")
    assert alike == (1.0, 1.0)
    assert cluster_bootstrap([3.0], [4], name="one problem") is None


def test_problems_that_are_enough_have_the_power_that_is_said() -> None:
    """The number for pairs seen as often as (12, 4) of 40, checked by the power of the exact test itself."""
    n = problems_to_separate(12, 4, 40)
    assert n == 77
    assert 0.70 < exact_power(n, 12 / 40, 4 / 40) < 0.85
    assert exact_power(n // 2, 12 / 40, 4 / 40) < 0.55
    assert problems_to_separate(4, 12, 40) == n
    assert (problems_to_separate(3, 3, 40), problems_to_separate(0, 0, 0)) == (None, None)
    stricter = problems_to_separate(12, 4, 40, alpha=0.05 / 6)
    assert stricter is not None and stricter > n
    fewest = problems_to_separate(10, 0, 10)
    assert fewest == 6 and alone(fewest, 0) < 0.05 < alone(fewest - 1, 0), "no exact test finds anything in fewer"
    assert problems_to_separate(5, 0, 10) == 14


def exact_power(n: int, first: float, second: float) -> float:
    """The chance that the exact test finds a difference at 5%, for these rates of discordant pairs."""
    power, together = 0.0, first + second
    for discordant in range(n + 1):
        weight = math.comb(n, discordant) * together**discordant * (1 - together) ** (n - discordant)
        if weight < 1e-9:
            continue
        share = first / together
        power += weight * sum(
            math.comb(discordant, k) * share**k * (1 - share) ** (discordant - k)
            for k in range(discordant + 1)
            if alone(k, discordant - k) < 0.05
        )
    return power


def test_the_quantile_of_the_intervals() -> None:
    from remac_bench.judging.statistics import Z_95

    assert pytest.approx(NormalDist().inv_cdf(0.975), abs=1e-6) == Z_95
