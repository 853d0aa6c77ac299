"""What the tests of the benchmark share."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from remac_bench.playing.agents import Access
from remac_bench.playing.job_lists import make_jobs
from remac_bench.playing.jobs import Job
from remac_bench.records import Record
from remac_bench.store import Store

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
TASKS = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove")


def jobs(
    methods: str = "BASE",
    tasks: str = "HeatOnStove",
    seeds: range = range(2),
    *,
    isolated: bool = False,
    **agent: Any,
) -> list[Job]:
    """Symbolic jobs; names with commas between them. Planners of the tests run in the worker unless `isolated`."""
    return make_jobs(
        tasks=tasks.split(","),
        methods=methods.split(","),
        seeds=seeds,
        kitchen={"backend": "symbolic"},
        agent=agent,
        access=Access(isolated=isolated),
    )


def odd_scene(seed: int = 1, task: str = "HeatOnStove") -> str:
    """What the kitchen of a seed says of itself: planners of the tests know it by that, they are told no seed."""
    import remac_env

    env = remac_env.parallel_env(task, robots=1, backend="symbolic")
    _, infos = env.reset(seed=seed)
    return str(infos["robot_0"]["text"])


def record(**changes: Any) -> Record:
    """A scored record of a success, but for the changes."""
    facts: dict[str, Any] = {
        "job": "j0",
        "agent": "CC",
        "method": "CC",
        "task": "HeatOnStove",
        "starts": "paper",
        "seed": 0,
        "robots": 1,
        "backend": "symbolic",
        "iteration": 0,
        "scored": True,
        "success": True,
    }
    return Record(**{**facts, **changes})


def timeless(records: list[Record]) -> list[dict[str, Any]]:
    """Records as data without what clocks say, in the order of job and iteration."""
    dumped = [entry.model_dump(exclude={"wall_seconds", "started"}) for entry in records]
    return sorted(dumped, key=lambda entry: (entry["job"], entry["iteration"]))


def read(folder: Path) -> list[Record]:
    """The records that count in a folder."""
    return Store(folder).read()


def start(*arguments: str, **options: Any) -> subprocess.Popen[str]:
    """The command `remac` in a process of its own, in the folder of the test planners."""
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'benchmarks'}"}
    environment.update(options.pop("env", {}))
    return subprocess.Popen(
        [sys.executable, "-m", "remac_bench", *arguments],
        cwd=HERE,
        env=environment,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        **options,
    )


def wait_for(happened: Callable[[], bool], *, seconds: float = 60.0) -> None:
    """Wait until something is true; fail when it does not become so."""
    end = time.monotonic() + seconds
    while not happened():
        if time.monotonic() > end:
            raise AssertionError(f"nothing happened within {seconds} s")
        time.sleep(0.005)
