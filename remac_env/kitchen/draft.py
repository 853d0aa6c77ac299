"""A start while it is drawn."""

from __future__ import annotations

from dataclasses import dataclass, field

from remac_env.rules.facts import Rules
from remac_env.state import WorldState


@dataclass
class Draft:
    """A start being drawn: changed by `mixed.vary`, frozen by `sample`."""

    scene: Rules
    world: WorldState
    doors: dict[str, float] = field(default_factory=dict)
