"""`remac experiment headroom`: generated tasks of every grade are played; tables say which ones each agent solves."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from remac_bench.columns import show
from remac_bench.errors import UsageError
from remac_bench.experiments.headroom import AGENTS, FIRST_SEED, jobs_of, tables
from remac_bench.playing.runner import run_jobs
from remac_bench.playing.settings import Settings
from remac_bench.store import Store
from remac_env.errors import check_choice

FOLDER = Path("results/headroom")
NOT_ASKED = ("tasks", "robots", "starts", "file")


def headroom_command(given: Mapping[str, Any]) -> None:
    """Play what the folder does not hold yet, and print the tables of all that it holds.

    Raises:
        UsageError, UnknownNameError, OptionError: for flags that are not valid.
    """
    strange = [name for name in NOT_ASKED if given.get(name)]
    if strange:
        raise UsageError(f"headroom takes no {', '.join(strange)}; valid: --planner, --n, --out")
    chosen = list(given["planner"] or AGENTS)
    for name in chosen:
        check_choice("agent of headroom", name, AGENTS)
    folder = Path(given["out"] or FOLDER)
    seeds = range(FIRST_SEED, FIRST_SEED + given["count"])
    jobs = [job for name in chosen for job in jobs_of(name, seeds)]
    run_jobs(jobs, folder, Settings(workers=1))
    show(*tables(list(Store(folder).read())))
