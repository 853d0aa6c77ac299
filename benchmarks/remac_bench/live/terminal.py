"""`remac play --terminal`: the same episode typed, with what became of each round after it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from remac_agents.planners.human import HumanPlanner
from remac_bench.console import plain
from remac_bench.live.episode import Tell, told


def planner() -> HumanPlanner:
    """Who types: Tab completes, and the kitchen is described once."""
    return HumanPlanner(brief=True)


def teller(say: Callable[[str], None]) -> Tell:
    """Says what became of each round, as planners hear it."""
    count = 0

    def tell(env: Any, infos: Mapping[str, Any], sent: Mapping[str, str]) -> None:
        nonlocal count
        if sent:
            count += 1
            say(plain(f"{count}. " + "; ".join(f"{robot}: {words}" for robot, words, _ in told(infos, sent))))

    return tell
