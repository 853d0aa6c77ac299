"""Intervals and tests, each short enough to be read: no number here needs more than NumPy."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from statistics import NormalDist

import numpy as np

from remac_env.seeding import generator

Z_95 = 1.959964
"""Two-sided 95% quantile of the standard normal distribution."""

ALPHA = 0.05
"""Two-sided level of every test; after Holm's correction it bounds the chance of any false finding in a family."""

POWER = 0.8
"""Chance of finding a difference at which the number of episodes is said to be enough (the usual convention)."""

RESAMPLES = 4000
"""Of the bootstrap; the ends of a 95% interval then vary by about 1% of its width."""


def wilson(successes: int, n: int) -> tuple[float, float]:
    """Wilson's 95% interval of a rate (Wilson 1927; Newcombe 1998, method 3).

    Raises:
        ValueError: if n is not positive, or successes are not in 0..n.
    """
    if n <= 0 or not 0 <= successes <= n:
        raise ValueError(f"{successes} successes of {n} are not valid; valid: 0..n of n > 0")
    rate, squared = successes / n, Z_95**2
    middle = (rate + squared / (2 * n)) / (1 + squared / n)
    half = Z_95 / (1 + squared / n) * math.sqrt(rate * (1 - rate) / n + squared / (4 * n * n))
    # At the ends the exact bound is 0 or 1; rounding must not put it a hair inside or outside.
    return (0.0 if successes == 0 else middle - half), (1.0 if successes == n else middle + half)


def mean(values: Iterable[float | None]) -> float | None:
    """The mean of what is there; the sum is exact, so that the order of the records does not matter."""
    known = [value for value in values if value is not None]
    return math.fsum(known) / len(known) if known else None


def sign_flip(differences: Sequence[int]) -> float:
    """Exact two-sided p of the sign-flip test: under the null, each difference is as likely with the other sign.

    Where every difference is 1, 0 or -1 it is McNemar's exact test (McNemar 1947; Fisher 1935 for the test as such).

    Args:
        differences: for each problem, the episodes that the first entry solved less those that the second did.
    """
    sizes = [abs(value) for value in differences if value]
    span = sum(sizes)
    chances = np.zeros(2 * span + 1)
    chances[span] = 1.0
    for size in sizes:
        chances = 0.5 * (np.roll(chances, size) + np.roll(chances, -size))
    far = abs(sum(differences))
    return min(1.0, float(math.fsum(chances[: span - far + 1]) + math.fsum(chances[span + far :])))


def holm(values: Sequence[float]) -> list[float]:
    """Holm's adjusted p, in the order of the values (Holm 1979)."""
    adjusted, worst = [1.0] * len(values), 0.0
    for rank, index in enumerate(sorted(range(len(values)), key=lambda i: values[i])):
        worst = max(worst, min(1.0, (len(values) - rank) * values[index]))
        adjusted[index] = worst
    return adjusted


def cluster_bootstrap(differences: Sequence[float], counts: Sequence[int], *, name: str) -> tuple[float, float] | None:
    """95% percentile interval of a mean difference whose episodes come in clusters.

    Whole clusters are drawn with replacement (Field and Welsh 2007): episodes of one problem are alike.

    Args:
        differences: for each problem the sum of the differences.
        counts: for each problem the number of episodes.
        name: names the generator, so that the same records give the same interval.

    Returns:
        (low, high), or None for fewer than two problems, of which nothing can be said.
    """
    clusters = len(counts)
    if clusters < 2:
        return None
    chance = generator(0, "cluster bootstrap", name)
    drawn = chance.multinomial(clusters, [1 / clusters] * clusters, size=RESAMPLES)
    rates = drawn @ np.asarray(differences, float) / (drawn @ np.asarray(counts, float))
    low, high = np.percentile(rates, [2.5, 97.5])
    return round(float(low), 12), round(float(high), 12)


def problems_to_separate(better: int, worse: int, n: int, *, alpha: float = ALPHA) -> int | None:
    """Problems at which the sign-flip test finds the difference seen, with a power of 80%.

    Connor (1987), eq. 4: ((z_a sqrt(p) + z_b sqrt(p - d^2)) / d)^2 with p = (b + c) / n and d = (b - c) / n; and never
    fewer than an exact test needs at all: with k problems that differ, no p falls below 2 / 2^k.

    Args:
        better: problems, of `n`, on which the first entry solved more episodes.
        worse: those on which the second did.

    Returns:
        the number in all, or None where no difference was seen.
    """
    if n <= 0 or better == worse:
        return None
    discordant, difference = (better + worse) / n, abs(better - worse) / n
    normal = NormalDist()
    reach = normal.inv_cdf(1 - alpha / 2) * math.sqrt(discordant)
    reach += normal.inv_cdf(POWER) * math.sqrt(max(0.0, discordant - difference**2))
    fewest = math.floor(math.log2(2 / alpha)) + 1
    return max(math.ceil((reach / difference) ** 2), math.ceil(fewest / discordant))
