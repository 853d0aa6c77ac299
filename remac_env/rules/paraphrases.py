"""Other words for sentences about a kitchen: one plain form for the ways in which people and models put the same."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from remac_env.words import normalise

FILE = Path(__file__).with_name("paraphrases.toml")

_ARTICLES = re.compile(r"\b(the|an?)\b")

Words = tuple[tuple[re.Pattern[str], str], ...]


@dataclass(frozen=True)
class Paraphrases:
    """The table: `words` and `denials` are replaced in order; `also` has further sentences of a predicate."""

    words: Words
    denials: Words
    also: Mapping[str, tuple[str, ...]]


@lru_cache(maxsize=1)
def table() -> Paraphrases:
    """What paraphrases.toml holds."""
    data = tomllib.loads(FILE.read_text("utf-8"))
    also = {predicate: tuple(sentences) for predicate, sentences in data["also"].items()}
    return Paraphrases(_words(data["words"]), _words(data["denials"]), also)


@lru_cache(maxsize=65536)
def plain_form(text: str) -> str:
    """The text in lower case, without articles, quotes, fillers and a stop at the end, and with one word for many."""
    return _replaced(_ARTICLES.sub("", normalise(text)), table().words)


def undenied(text: str) -> str | None:
    """The plain form of what a text denies; None for a text that denies nothing, or denies twice."""
    left, found = plain_form(text), 0
    for pattern, by in table().denials:
        left, count = pattern.subn(by, left)
        found += count
    return _replaced(left, table().words) if found == 1 else None


def _replaced(text: str, words: Words) -> str:
    for pattern, by in words:
        text = " ".join(pattern.sub(by, text).split())
    return text


def _words(rows: list[list[str]]) -> Words:
    return tuple((re.compile(pattern), by) for pattern, by in rows)
