"""What stays the same during an episode: what the kitchen told, and where a method stops trying."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from remac_agents.roles.requests import ANSWERS
from remac_env.tasks.goals import Goal


@dataclass(frozen=True, kw_only=True)
class Bounds:
    """Where a method stops trying. `rounds`: in all; `retries`: of one subtask; `adjustments`: questions to
    the adjuster; `replies`: of the planner, for one plan."""

    rounds: int = 60
    retries: int = 2
    adjustments: int = 20
    replies: int = ANSWERS


@dataclass(frozen=True, kw_only=True)
class Briefing:
    """What stays the same during an episode.

    `helper` is the second robot, None where there is none; `helpers` are those beyond. `last`: no other iteration on
    this start is known to follow.
    `skills`: robot -> the names of the skills that its commands need.
    """

    goal: str
    text: str
    commands: tuple[str, ...]
    robots: tuple[str, ...]
    lead: str
    helper: str | None
    task: str
    helpers: tuple[str, ...] = ()
    episode: Mapping[str, Any] = field(default_factory=dict)
    verbs: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    goal_test: Goal | None = None
    last: bool = False
    skills: Mapping[str, frozenset[str]] = field(default_factory=dict)
