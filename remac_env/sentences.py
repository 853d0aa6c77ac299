"""Sentences read back as conditions: whatever PREDICATES and SENTENCES can say of one kitchen, word for word."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import lru_cache

from remac_env.conditions import SENTENCES, Condition
from remac_env.marks import WASHED
from remac_env.state import Scene
from remac_env.subtasks import SKILLS
from remac_env.vocabulary import normalise

ARGUMENTS: dict[str, tuple[str, ...]] = {
    "at": ("robot", "thing"),
    "aside": ("robot",),
    "station_free": ("robot", "thing"),
    "hand_empty": ("robot",),
    "holding": ("robot", "object"),
    "hand_full": ("robot",),
    "holds_shaker": ("robot",),
    "placed": ("thing",),
    "accessible": ("thing",),
    "unloaded": ("object",),
    "room": ("robot", "thing"),
    "no_vessel_needed": ("robot", "thing"),
    "inside": ("object", "thing"),
    "directly_on": ("object", "vessel"),
    "door_open": ("door",),
    "door_not_open": ("door",),
    "door_closed": ("door",),
    "door_not_closed": ("door",),
    "switched_on": ("switch",),
    "switched_off": ("switch",),
    "some_on": ("switch",),
    "all_off": ("switch",),
    "may_run": ("fixture",),
    "marked": ("object", "mark"),
}
"""Predicate -> what kinds of names it is about."""


def sentence_forms(*, leave_out: tuple[str, ...] = ()) -> tuple[str, ...]:
    """The sentence of every predicate but those left out, with the kinds of names in capitals."""
    return tuple(
        SENTENCES[name].format(*(kind.upper() for kind in kinds))
        for name, kinds in ARGUMENTS.items()
        if name not in leave_out
    )


def read_condition(text: str, scene: Scene) -> Condition | None:
    """The condition that a sentence states about this kitchen; None for any other words.

    Case, spaces, quotes, a stop at the end, underscores and the word "the" do not matter. Letters that only look like
    those of a sentence do not count as them.
    """
    return _by_sentence(scene).get(_plain(text)) if text.isascii() else None


def _plain(text: str) -> str:
    return " ".join(word for word in normalise(text).split() if word != "the")


@lru_cache(maxsize=64)
def _by_sentence(scene: Scene) -> dict[str, Condition]:
    said = (Condition(name, args) for name, kinds in ARGUMENTS.items() for args in _names(scene, kinds))
    return {_plain(condition.sentence): condition for condition in said}


def _names(scene: Scene, kinds: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    fixtures, objects = scene.fixtures, scene.objects
    valid = {
        "robot": scene.robots,
        "thing": (*fixtures, *objects),
        "object": tuple(objects),
        "vessel": tuple(name for name, facts in objects.items() if facts.holds),
        "fixture": tuple(fixtures),
        "door": tuple(name for name, facts in fixtures.items() if facts.door),
        "switch": tuple(name for name, facts in fixtures.items() if facts.switches),
        "mark": _marks(),
    }
    return itertools.product(*(valid[kind] for kind in kinds))


@lru_cache(maxsize=1)
def _marks() -> tuple[str, ...]:
    """What water leaves, and every mark that a skill of the table does."""
    achieved = (c for skill in SKILLS.values() for c in skill.achieves("", "", ""))
    return tuple(dict.fromkeys((WASHED, *(c.args[1] for c in achieved if c.predicate == "marked"))))
