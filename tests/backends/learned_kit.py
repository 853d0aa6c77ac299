"""A small network for a skill, as weights: for tests of what plays them and what reads them."""

from __future__ import annotations

from typing import Any

import numpy as np

from remac_env.backends.physics.controllers.learned.network import Network, commanded
from remac_env.backends.physics.controllers.learned.seen import entries
from remac_env.backends.physics.controllers.learned.weights import About, Weights
from remac_env.robots import bodies
from remac_env.rules.skills import SKILLS

SKILL = "turn on"
CHUNK = 4
COMMANDED = commanded(bodies.get())
"""Numbers of a command of the standard body."""


def network(skill: str = SKILL, *, seed: int = 0, travel: float = 0.0) -> Network:
    """A small network; `travel`: m or rad by which it wants every joint moved, whatever it sees."""
    rng, inputs = np.random.default_rng(seed), len(entries(SKILLS[skill]))

    def numbers(*shape: int) -> Any:
        return rng.normal(0.0, 0.1, shape).astype(np.float32)

    zeros = travel != 0.0
    last = (np.zeros((CHUNK * COMMANDED, 8), np.float32) if zeros else numbers(CHUNK * COMMANDED, 8))
    return Network(
        numbers(inputs), np.ones(inputs, np.float32), ((numbers(8, inputs), numbers(8), numbers(8), numbers(8)),),
        (last, np.full(CHUNK * COMMANDED, travel, np.float32)), np.zeros((CHUNK, COMMANDED), np.float32),
        np.full((CHUNK, COMMANDED), 1.0 if zeros else 1e-4, np.float32),
    )  # fmt: skip


def weights(skill: str = SKILL, **more: Any) -> Weights:
    rng = np.random.default_rng(1)
    sample = rng.normal(size=(2, len(entries(SKILLS[skill])))).astype(np.float32)
    about = About(skill=skill, targets=("faucet",), execute=CHUNK)
    return Weights(about=about, network=network(skill, **more), sample=sample)
