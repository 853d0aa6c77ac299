"""The objects that generated tasks speak of, read from pools.toml, and the words that the built-in vocabulary lacks."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources

from remac_env.kitchen import annexes
from remac_env.vocabulary import Noun, built_in

FILE = "pools.toml"


@cache
def load() -> Mapping[str, Mapping[str, str]]:
    """Kind -> noun -> category."""
    return tomllib.loads(resources.files("remac_env.generator").joinpath(FILE).read_text("utf-8"))


@cache
def nouns() -> tuple[Noun, ...]:
    """The words of annexes and objects that have no built-in tokens; those of objects as their categories are used."""
    known = {noun.name: noun for noun in built_in().nouns}
    words = [annex for annex in annexes.nouns() if annex.name not in known]
    for pool in load().values():
        words += [
            Noun(noun, "object", tuple(dict.fromkeys((*known[category].uses, "season"))))
            for noun, category in pool.items()
            if noun not in known
        ]
    return tuple(words)
