"""Very many random calls by the event clock: the contract holds at each, and each key of infos keeps its type."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import pytest

import remac_env
from remac_env.generator import make, templates
from remac_env.testing import check_events

CALLS = int(os.environ.get("REMAC_EVENT_CALLS", "100000"))
"""Steps in all."""

BACKEND = os.environ.get("REMAC_EVENT_BACKEND", "symbolic")

LONGEST = 150
"""Steps of an episode at most."""


class Counted:
    """A kitchen whose steps are counted, and in whose infos each key keeps its type."""

    types: dict[str, type] = {}

    def __init__(self, env: Any) -> None:
        self.env, self.calls = env, 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self.env, name)

    def step(self, actions: Any) -> Any:
        """One more."""
        self.calls += 1
        answer = self.env.step(actions)
        for info in answer[4].values():
            for key, value in info.items():
                assert self.types.setdefault(key, type(value)) is type(value), key
        return answer


def kinds() -> Iterator[tuple[Any, int]]:
    """Every task with one to four robots, and a kitchen of every template."""
    for task in remac_env.tasks("events"):
        yield from ((task, robots) for robots in (1, 2, 3, 4))
    for number, (name, row) in enumerate(templates.load().items()):
        robots = 2 if row.team else 1 + number % 4
        yield make(grade=min(row.sizes), seed=241_000, template=name, robots=robots).spec, robots


@pytest.mark.long
def test_random_calls_keep_the_contract() -> None:
    """Every task and template; in half of them robots may be stopped, in half of them thinking takes its time."""
    every = list(kinds())
    made = 0
    for number, (task, robots) in enumerate(every):
        env = Counted(remac_env.parallel_env(
            task, robots=robots, backend=BACKEND, clock="events", interrupts=number % 2 == 0,
            think=("off", "fixed:3")[number // 2 % 2], max_seconds=900.0, failure_rate=0.1 * (BACKEND == "symbolic"),
        ))  # fmt: skip
        share = (CALLS - made) / (len(every) - number)
        seeds = (seed for seed in range(241_000, 242_000) if env.calls < share)
        check_events(lambda env=env: env, seeds=seeds, steps=LONGEST)
        made += env.calls
    assert made >= CALLS
