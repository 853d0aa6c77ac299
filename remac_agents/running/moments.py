"""Rounds that were played, and what a role may see of a moment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from remac_agents.roles import Ran, View
from remac_agents.roles.grants import reads_rules, reads_truth
from remac_env.rules.facts import Rules
from remac_env.rules.subtasks import WAIT, Subtask
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
    """A moment as a role may see it: with the rules and the truth only if it needs them, quirks being of the truth."""
    given, true = reads_rules(role), reads_truth(role)
    told = rules if true else rules.without_quirks
    return replace(view, rules=told if given else None, world=world if true else None) if given else view


def ran_so_far(moments: Sequence[Moment]) -> tuple[Ran, ...]:
    """The commands of an episode's rounds in order, waits left out, and how each was reported to end."""
    found = []
    for moment in moments:
        for robot, subtask in moment.played.items():
            if subtask == WAIT:
                continue
            report = moment.after.reports.get(robot)
            ended = None if report is None else report.status == "success"
            found.append(Ran(moment.round + 1, robot, subtask.text, ended, None if report is None else report.reason))
    return tuple(found)
