"""Named random generators: every draw of an episode comes from one of these, and from nothing else."""

from __future__ import annotations

import hashlib
import json

import numpy as np

from remac_env.errors import OptionError
from remac_env.quoting import quoted
from remac_env.values import python_value

SEED_MAX = 2**63 - 1

KEPT_SEEDS = 900_000
"""Seeds from here on are kept for judging: no suite plays them, and nothing draws them by itself."""


def generator(seed: int, *names: object) -> np.random.Generator:
    """A generator that depends on the seed and on the names alone, on every platform.

    Args:
        seed: whole number in 0..2**63-1.
        names: what the draws are for ("start", "perception", robot name, ...).

    Raises:
        OptionError: if the seed is not a whole number in range.
    """
    seed = python_value(seed)
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed <= SEED_MAX:
        raise OptionError(f"seed {quoted(seed)} is not valid; valid: a whole number in 0..2**63-1")
    label = json.dumps([str(name) for name in names]).encode()
    words = np.frombuffer(hashlib.sha256(label).digest(), dtype=np.uint32)
    return np.random.default_rng(np.random.SeedSequence([seed, *words.tolist()]))


def digest(value: object) -> str:
    """Twelve hexadecimal digits that name a JSON-able value; floats are to be rounded by the caller."""
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()[:12]
