"""Demonstrations that nobody had to record."""

from __future__ import annotations

from typing import Any

import numpy as np
from remac_bench.learning.demos import Demo

from remac_env.backends.physics.controllers.learned.seen import entries
from remac_env.rules.skills import SKILLS


def made(length: int = 30, *, seed: int = 0, size: int = 0, **told: Any) -> Demo:
    """A demonstration of nothing, with pictures where they have a size: a square that wanders."""
    rng, state = np.random.default_rng(seed), len(entries(SKILLS["turn on"]))

    def numbers(*shape: int) -> Any:
        return rng.normal(size=shape).astype(np.float32)

    shown = np.full((length + 1, size, size, 3), 90, np.uint8)
    for index in range(length + 1 if size else 0):
        shown[index, : size // 2, : size // 2] = 4 * index
    whole = {
        "skill": "turn on", "target": "faucet", "task": "WashPnP", "seed": seed, "style": "modern_1",
        "layout": "galley", "before": ("navigate to faucet",),
    } | told  # fmt: skip
    return Demo(
        observations=numbers(length + 1, state), actions=numbers(length, 12), commands=numbers(length, 12),
        measured=numbers(length, 11), states=numbers(length, 5), pictures={"front": shown} if size else {},
        rewards=(np.arange(length) >= length // 2).astype(np.float32), **whole,
    )  # fmt: skip
