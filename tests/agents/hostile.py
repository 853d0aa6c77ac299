"""Values that no caller should give, and a check that doors refuse them in words of ours."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from remac_env.errors import RemacError


class Mute:
    """Says nothing of itself."""

    def __repr__(self) -> str:
        raise RuntimeError("no words")


class Endless:
    """Has no end."""

    def __iter__(self) -> Iterator[int]:
        while True:
            yield 1


HUGE = 10**5000
NEVER: list[Any] = [b"x", object(), Mute(), float("nan"), 1j, int, len, memoryview(b"a"), np.datetime64("2026-01-01")]
"""No door takes any of these, whatever it is for."""

ODD: list[Any] = [
    *NEVER, None, True, -1, 0.5, "", " ", "x" * 100_000,
    "\ud800", "a\nb", "\x00", HUGE, -HUGE, -float("inf"), Endless(),
    [], [[]], (), {}, {1: 2}, {"a"}, np.array([1, 2]), np.array([]), np.array(None, dtype=object), np.float32(1.5), ...,
]  # fmt: skip
"""Some doors take some of these."""

LONGEST = 4_000
"""Characters of an error: some list all of their valid values."""


def meet(door: Callable[[Any], Any], *, about: str = "", values: list[Any] = ODD) -> None:
    """Each value is taken, or refused by a RemacError that names the field and says in few words what is valid."""
    for value in values:
        try:
            door(value)
        except RemacError as error:
            told = str(error)
            assert about in told and len(told) < LONGEST and told.replace("\n", "").isprintable(), told[:300]
        else:
            assert not any(value is each for each in NEVER), f"{about}: {type(value).__name__} was taken"
