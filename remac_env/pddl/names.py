"""Names of a kitchen as names of PDDL."""

from __future__ import annotations

import re

from remac_env.rules.facts import ASIDE, Rules


def name_of(name: str) -> str:
    """A name of letters, digits, - and _: "pepper mill" -> "pepper-mill", "counter.1" -> "counter_1"."""
    return re.sub(r"[^a-z0-9_-]", "_", name.lower().replace(" ", "-"))


def station_name(name: str) -> str:
    """A station, which may be called as a fixture is."""
    return f"by-{name_of(name)}"


def slot_name(name: str) -> str:
    """A slot, likewise."""
    return f"slot-{name_of(name)}"


def stations(rules: Rules) -> dict[str, str]:
    """PDDL name -> station, `aside` among them."""
    return {station_name(name): name for name in (*rules.stations, ASIDE)}


def nouns(rules: Rules) -> dict[str, str]:
    """PDDL name -> object or fixture."""
    return {name_of(name): name for name in (*rules.objects, *rules.fixtures)}
