"""One start of a task, stated instead of drawn: what is in the kitchen, and where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from remac_env.state import Door, Place


@dataclass(frozen=True)
class Setup:
    """The world at the start of every episode of a task. Looks, poses within slots and parking places are still drawn.

    Attributes:
        objects: noun -> category of the catalogue.
        places: noun -> place.
        doors: fixture -> its door, where it is not closed.
        on: fixture -> its switches that are on.
    """

    objects: Mapping[str, str]
    places: Mapping[str, Place]
    doors: Mapping[str, Door] = field(default_factory=dict)
    on: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
