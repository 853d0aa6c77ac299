"""Refuses starts from which no plan reaches the goal, before anything is played."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from remac_bench.errors import UsageError

if TYPE_CHECKING:
    from remac_bench.playing.jobs import Job

SHOWN = 3
"""Starts that are named; all are counted."""

_DECIDES = ("style", "layout", "starts", "naming")
"""Options of the kitchen on which its starts hang."""


def refuse_unsolvable(jobs: Sequence[Job]) -> None:
    """Look for any plan from each distinct start, by the skill table.

    Raises:
        UsageError: naming the starts that have none. One about which the search gives up is played.
    """
    import remac_env
    from remac_env.errors import SamplingError
    from remac_env.oracle import solvable
    from remac_env.tasks import get

    starts: dict[tuple[str, tuple[Any, ...]], dict[int, None]] = {}
    for job in jobs:
        if get(job.task).timed:
            continue  # no plan in rounds says whether there is one by the clock
        key = (job.task, tuple(getattr(job.options, name) for name in _DECIDES))
        starts.setdefault(key, {})[job.seed] = None
    refused = []
    for (task, values), seeds in starts.items():
        options: dict[str, Any] = dict(zip(_DECIDES, values, strict=True))
        env = remac_env.parallel_env(task, backend="symbolic", **options)
        for seed in seeds:
            try:
                env.reset(seed=seed)
            except SamplingError:
                continue  # its job says so when it is played
            if solvable(env.start.scene, env.world, env.goal) is False:
                refused.append(f"{task}, seed {seed}: {env.goal.text}")
        env.close()
    if refused:
        more = f" and {len(refused) - SHOWN} more" if len(refused) > SHOWN else ""
        raise UsageError(f"no plan reaches the goal from these starts: {'; '.join(refused[:SHOWN])}{more}")
