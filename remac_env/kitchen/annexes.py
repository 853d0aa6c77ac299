"""Fixtures that a task adds to a floor plan, read from annexes.toml: they exist for the skill table alone."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources

from remac_env.errors import check_choice
from remac_env.rules.facts import FixtureFacts, SlotFacts
from remac_env.rules.skills import SKILLS
from remac_env.state import FrozenMap
from remac_env.vocabulary import Noun

FILE = "annexes.toml"


@cache
def load() -> Mapping[str, FixtureFacts]:
    """Every annex by its name, in the order of the file."""
    text = resources.files("remac_env.kitchen").joinpath(FILE).read_text("utf-8")
    return FrozenMap({name: _facts(name, **row) for name, row in tomllib.loads(text).items()})


def get(name: str) -> FixtureFacts:
    """An annex by its name; raises UnknownNameError."""
    check_choice("annex", name, load())
    return load()[name]


def _facts(
    name: str,
    *,
    slots: int = 0,
    door: bool = False,
    switch: bool = False,
    gives: str = "",
    shut_to_run: bool = False,
) -> FixtureFacts:
    places = tuple(f"{name}.{index}" for index in range(slots))
    return FixtureFacts(
        name=name, kind=name, station=name, door=door, switches=(name,) if switch else (), slots=places,
        shut_to_run=shut_to_run, gives=gives,
    )  # fmt: skip


def slots_of(facts: FixtureFacts) -> dict[str, SlotFacts]:
    """The slots of an annex, all used from its one station."""
    return {slot: SlotFacts(slot, facts.name, facts.station) for slot in facts.slots}


@cache
def nouns() -> tuple[Noun, ...]:
    """The words for all annexes, with the commands that each takes."""
    return tuple(Noun(name, "fixture", _uses(facts)) for name, facts in load().items())


def _uses(facts: FixtureFacts) -> tuple[str, ...]:
    has = {"surface": bool(facts.slots), "door": facts.door, "switch": bool(facts.switches)}
    return tuple(name for name, skill in SKILLS.items() if has.get(skill.target, False))
