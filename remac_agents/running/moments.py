"""A round that was played, and what a role may see of a moment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from remac_agents.roles import View
from remac_agents.roles.grants import reads_rules, reads_truth
from remac_env.rules.facts import Rules
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState


@dataclass(frozen=True)
class Moment:
    """A round that was played, with what was seen and what was true before and after it."""

    round: int
    played: Mapping[str, Subtask]
    before: View
    after: View
    world_before: WorldState | None
    world_after: WorldState | None


def shown(view: View, rules: Rules, world: WorldState | None, role: object) -> View:
    """A moment as a role may see it: with the rules and the truth only if it needs them."""
    given, true = reads_rules(role), reads_truth(role)
    return replace(view, rules=rules if given else None, world=world if true else None) if given else view
