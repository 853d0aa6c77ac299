"""The tasks that are certified beforehand: a thousand, with all that everybody may know and no quirks, in index.csv.

Each is made again from its grade and seed; the index says what it will be, so that nobody need make it to choose.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cache
from importlib import resources


@dataclass(frozen=True, slots=True)
class Entry:
    """A task of the index, in the words of `remac_env.generator.Certified`."""

    grade: int
    seed: int
    template: str
    lower: int
    upper: int
    proof: str
    hidden: int
    untold: int
    problem: str


@cache
def load() -> tuple[Entry, ...]:
    """Every task of the index, by grade and seed."""
    text = resources.files("remac_env.generator").joinpath("index.csv").read_text("utf-8")
    return tuple(
        Entry(
            int(row["grade"]), int(row["seed"]), row["template"], int(row["lower"]), int(row["upper"]), row["proof"],
            int(row["hidden"]), int(row["untold"]), row["problem"],
        )
        for row in csv.DictReader(text.splitlines())
    )  # fmt: skip
