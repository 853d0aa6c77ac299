"""What anybody knows who was never in this kitchen, from common_sense.toml: kinds of objects, what is done where."""

from __future__ import annotations

import re
import tomllib
from functools import lru_cache
from importlib import resources
from typing import Any

from remac_env.rules.scene import PublicScene

_NUMBERS = ("one", "two", "three", "four", "five", "six", "seven", "eight")
_SOME = re.compile(rf"^(?P<which>every|all|any|a|an|some|{'|'.join(_NUMBERS)})(?: of the)? (?P<kind>.+)$")


def vessels() -> tuple[tuple[str, str, str], ...]:
    """(verb, place, vessel): what is done so there is done in such a vessel."""
    return tuple((row["verb"], row["place"], row["vessel"]) for row in _data()["vessel"])


@lru_cache(maxsize=1)
def _data() -> dict[str, Any]:
    text = resources.files("remac_agents").joinpath("planners", "common_sense.toml").read_text("utf-8")
    return tomllib.loads(text)


def places() -> dict[str, tuple[str, tuple[str, ...]]]:
    """Verb -> where it is done to what is put there, and the commands that are needed after that."""
    return {row["verb"]: (row["place"], tuple(row.get("after", ()))) for row in _data()["place"]}


def members(words: str, facts: PublicScene) -> tuple[str, ...]:
    """The objects of this kitchen that words such as "every spoon" or "two of the forks" mean; of "two" the first two.

    Empty for any other words, and where the kitchen has none.
    """
    match = _SOME.match(words)
    if match is None:
        return ()
    which, kind = match["which"], match["kind"]
    if which == "any" and (number := kind.partition(" ")[0]) in _NUMBERS:
        which, kind = number, kind.partition(" ")[2]
    forms = (kind, kind.removesuffix("s"), kind.removesuffix("es"))
    found = [name for name in facts.objects if any(_is_a(name, word) for word in forms)]
    if which in ("every", "all"):
        return tuple(found)
    return tuple(found[: _NUMBERS.index(which) + 1 if which in _NUMBERS else 1])


def _is_a(name: str, kind: str) -> bool:
    return name == kind or name.endswith(f" {kind}") or name in _data()["kinds"].get(kind, ())
