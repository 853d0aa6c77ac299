"""The methods: how roles are combined. Each is a generator that yields what its robots do next.

A method yields `{robot: Subtask}` and is sent the next View, which the episode has taken in by then. When it
returns, every robot says `done`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from remac_agents.episode import Episode, Turns
from remac_agents.methods.base import base
from remac_agents.methods.cc import cc
from remac_agents.methods.re import re
from remac_agents.methods.remac import remac


@dataclass(frozen=True)
class Method:
    """A method by name. `remembers`: its runs go into the memory."""

    name: str
    run: Callable[[Episode], Turns]
    remembers: bool = False


METHODS: dict[str, Method] = {
    method.name: method
    for method in (
        Method("BASE", base),
        Method("CC", cc),
        Method("RE", re, remembers=True),
        Method("REMAC", remac, remembers=True),
    )
}
"""Every method by its name."""
