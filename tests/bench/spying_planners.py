"""Planners that try to learn what nobody tells them. Each writes what it found into the folder SPY_FOLDER."""

from __future__ import annotations

import gc
import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from remac_agents.planners.literal import LiteralPlanner


def note(found: object) -> None:
    """Write down what was found, a line each time."""
    with (Path(os.environ["SPY_FOLDER"]) / "found.jsonl").open("a") as file:
        file.write(json.dumps(found) + "\n")


def is_kitchen(value: object) -> bool:
    """Whether something is an environment, or the truth about one."""
    ours = ("KitchenParallelEnv", "WorldState", "Rules", "Episode", "MethodRun", "Bookkeeper", "Agent")
    return type(value).__name__ in ours


class Spy(LiteralPlanner):
    """Notes what it found, and plans word by word."""

    seeds: list[int] = []
    jobs = 0

    def begin_episode(self, seed: int, iteration: int) -> None:
        """Keeps what it is given."""
        self.seed = seed

    def plan(self, request: Any) -> Any:
        """A literal plan."""
        note(sorted(set(self.look(request))))
        return super().plan(request)

    def look(self, request: Any) -> Iterator[str]:
        """What there is to be found."""
        yield from ()


class WalksFrames(Spy):
    """Looks through everything that its callers have."""

    def look(self, request: Any) -> Iterator[str]:
        """Names of classes."""
        frame = sys._getframe()
        while frame is not None:
            for value in frame.f_locals.values():
                for part in (value, *getattr(value, "__dict__", {}).values()):
                    if is_kitchen(part):
                        yield type(part).__name__
            frame = frame.f_back  # type: ignore[assignment]


class CollectsGarbage(Spy):
    """Looks through everything that lives in its process."""

    def look(self, request: Any) -> Iterator[str]:
        """Names of classes."""
        yield from (type(value).__name__ for value in gc.get_objects() if is_kitchen(value))


class ReadsModules(Spy):
    """Looks for environments that modules keep."""

    def look(self, request: Any) -> Iterator[str]:
        """Names of classes."""
        for module in list(sys.modules.values()):
            yield from (type(value).__name__ for value in vars(module).values() if is_kitchen(value))


class ReadsRequests(Spy):
    """Looks for whatever leads to the start."""

    def look(self, request: Any) -> Iterator[str]:
        """Names of what is there and should not be."""
        yield from (key for key in request.episode if key != "task")
        yield from (name for name in ("rules", "world", "goal_test") if getattr(request, name) is not None)
        for obj in (*request.facts.fixtures.values(), *request.facts.objects.values()):
            yield from (word for word in ("needs_vessel_in", "shut_to_run", "too_big_for") if hasattr(obj, word))
        if self.seed < 1_000:
            yield "seed"


class Remembers(Spy):
    """Keeps in its class how many jobs it has seen, and in its module too."""

    def look(self, request: Any) -> Iterator[str]:
        """A number, but for the first job."""
        Spy.jobs += 1
        sys.remac_jobs = getattr(sys, "remac_jobs", 0) + 1  # type: ignore[attr-defined]
        if Spy.jobs > 1 or sys.remac_jobs > 1:  # type: ignore[attr-defined]
            yield "an earlier job"


class Told(LiteralPlanner):
    """Declares that it needs rules and truth, and notes that it has them."""

    needs_truth = needs_rules = True  # type: ignore[assignment]

    def __init__(self) -> None:
        """Nothing of its own."""

    def plan(self, request: Any) -> Any:
        """A literal plan."""
        whole = type(request.rules).__name__, type(request.world).__name__, type(request.goal_test).__name__
        note([*whole, request.goal_test.holds(request.rules, request.world)])
        return super().plan(request)
